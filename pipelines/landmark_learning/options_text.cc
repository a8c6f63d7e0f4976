#include "pipelines/landmark_learning/options_text.h"

#include <array>
#include <charconv>

namespace cairn::landmark_learning {
namespace {

struct Texts {
  std::vector<std::string> all;

  void Add(const Option& option, const std::string& value) { all.push_back(option.name + ("=" + value)); }
  void operator()(const Option& option, const std::string& value) { Add(option, value); }
  void operator()(const Option& option, const std::int64_t& value) { Add(option, std::to_string(value)); }
  void operator()(const Option& option, const bool& value) { Add(option, value ? "true" : "false"); }
  void operator()(const Option& option, const double& value) {
    std::array<char, 32> text{};  // the shortest that reads back as the same number
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    Add(option, std::string(text.data(), end));
  }
};

}  // namespace

std::vector<std::string> OptionTexts(const Options& options) {
  Texts texts;
  Options copy = options;
  VisitOptions(texts, copy);
  return texts.all;
}

}  // namespace cairn::landmark_learning
