#include "coordinator/cli/job_file/yaml_look.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <sstream>

#include "schema/error.h"

namespace cairn::cli {
namespace {

constexpr int kMostDeep = 16;  // a job file is four deep
constexpr int kMostAliases = 100;

struct Stop {};

class Handler : public YAML::EventHandler {
 public:
  explicit Handler(YamlLook* look) : look_(look) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    begin_line_ = mark.line + 1;
    met_ = false;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {
    if (depth_ > 0) Meet();
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    if (++aliases_ > kMostAliases) Refuse(mark, "more than 100 aliases");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t, const std::string&) override {
    RefuseTag(mark, tag);
    Meet();
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    RefuseTag(mark, tag);
    Descend(mark);
  }
  void OnSequenceEnd() override { --depth_; }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    RefuseTag(mark, tag);
    Descend(mark);
  }
  void OnMapEnd() override { --depth_; }

 private:
  // yaml-cpp has '?' where nothing is written and '!' where text stands in quotes.
  void RefuseTag(const YAML::Mark& mark, const std::string& tag) {
    if (!tag.empty() && tag != "?" && tag != "!") Refuse(mark, "a tag, '" + tag + "': a job file has none");
  }
  void Meet() {
    if (met_) return;
    met_ = true;
    if (++look_->documents == 2) look_->second_line = begin_line_;
  }
  void Descend(const YAML::Mark& mark) {
    Meet();
    if (++depth_ > kMostDeep) Refuse(mark, "nested too deep for a job file");
  }
  [[noreturn]] void Refuse(const YAML::Mark& mark, const std::string& problem) {
    look_->line = mark.line + 1;
    look_->problem = problem;
    throw Stop{};
  }

  YamlLook* look_;
  int begin_line_ = 1;
  int depth_ = 0;
  int aliases_ = 0;
  bool met_ = false;
};

}  // namespace

YamlLook LookThroughYaml(const std::string& text) {
  YamlLook look;
  std::istringstream in(text);
  YAML::Parser parser(in);
  Handler handler(&look);
  try {
    for (int i = 0; i < 2 && parser.HandleNextDocument(handler); ++i) {
      if (look.documents == i) break;  // an empty one is the last
    }
  } catch (const Stop&) {
    CAIRN_DEMAND(!look.problem.empty(), "it stops for a reason");
  }
  return look;
}

}  // namespace cairn::cli
