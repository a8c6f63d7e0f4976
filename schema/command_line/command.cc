#include "schema/command_line/command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace cairn::cli {
namespace {

constexpr const char* kNothingGiven = "nothing is given (an empty word)";

// What a shell makes of a variable that is not set: no file, no folder and no name of anything is meant.
void RefuseEmpty(CLI::Option* option) {
  option->check([](const std::string& text) { return text.empty() ? kNothingGiven : ""; });
}

// What CLI::Range checks and --help says of it; but CLI::Range lets "nan" pass, and writes a bound out in all
// its digits: where there is none, in 309 of them.
CLI::Validator Allowed(const CLI::Range& range, const std::string& allowed) {
  return {[range, allowed](std::string& text) {
            const bool number = !std::isnan(std::strtod(text.c_str(), nullptr));
            const bool right = number && range(text).empty();
            return right ? "" : "'" + text + "' is not allowed; allowed: " + allowed;
          },
          range.get_description()};
}

// The command that is meant, and those above it, whose options it takes too.
using CommandPath = std::vector<const CLI::App*>;

bool Descend(CommandPath& path, const std::string& word) {
  const auto named =
      path.back()->get_subcommands([&word](const CLI::App* command) { return command->get_name() == word; });
  if (!named.empty()) path.push_back(named.front());
  return !named.empty();
}

const CLI::Option* OptionOf(const CommandPath& path, const std::string& word) {
  if (!word.starts_with('-')) return nullptr;
  const std::string name = word.substr(0, word.find('='));
  for (const CLI::App* command : path)
    if (const CLI::Option* option = command->get_option_no_throw(name)) return option;
  return nullptr;
}

}  // namespace

Argument Argument::Required() const { return Argument(option_->required()); }
Argument Argument::ShowDefault() const { return Argument(option_->capture_default_str()); }
Argument Argument::Positive() const {
  return Argument(option_->check(Allowed(CLI::PositiveNumber, "a number above 0")));
}
Argument Argument::NotNegative() const {
  return Argument(option_->check(Allowed(CLI::NonNegativeNumber, "a number of at least 0")));
}
Argument Argument::ExistingFolder() const { return Argument(option_->check(CLI::ExistingDirectory)); }
Argument Argument::OneEachTime() const { return Argument(option_->type_size(1)->allow_extra_args(false)); }
Argument Argument::Needs(Argument other) const { return Argument(option_->needs(other.option_)); }
Argument Argument::Excludes(Argument other) const { return Argument(option_->excludes(other.option_)); }
Argument Argument::Heading(const std::string& heading) const { return Argument(option_->group(heading)); }
Argument Argument::Words(int least, int most) const { return Argument(option_->expected(least, most)); }

Argument Argument::OneOf(std::vector<std::string> words) const {
  return Argument(option_->check(CLI::IsMember(std::move(words))));
}

Argument Argument::Check(std::function<std::string(const std::string&)> wrong) const {
  return Argument(option_->check(std::move(wrong)));
}

template <class T>
Argument Argument::Within(T least, T most) const {
  std::string allowed;
  if constexpr (std::is_integral_v<T>)
    allowed = fmt::format("a whole number from {} to {}", least, most);
  else
    allowed = fmt::format("a number from {:g} to {:g}", least, most);
  return Argument(option_->check(Allowed(CLI::Range(least, most), allowed)));
}
template Argument Argument::Within(int, int) const;
template Argument Argument::Within(double, double) const;
template Argument Argument::Within(std::uint64_t, std::uint64_t) const;

Command Command::AddCommand(const std::string& name, const std::string& summary) const {
  return Command(app_->add_subcommand(name, summary));
}

void Command::NeedsCommand() const { app_->require_subcommand(1); }
void Command::PlaceByChecks() const { app_->validate_positionals(); }
void Command::Footer(const std::string& text) const { app_->footer(text); }
void Command::WhenGiven(std::function<void()> call) const { app_->callback(std::move(call)); }

template <class T>
Argument Command::Add(const std::string& names, T& value, const std::string& meaning) const {
  CLI::Option* option = app_->add_option(names, value, meaning);
  if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, std::vector<std::string>>)
    RefuseEmpty(option);
  return Argument(option);
}

template <class T>
Argument Command::AddTaking(const std::string& names, std::function<void(const T&)> take,
                            const std::string& meaning) const {
  CLI::Option* option = app_->add_option_function<T>(names, std::move(take), meaning);
  if constexpr (std::is_same_v<T, std::string>) RefuseEmpty(option);
  return Argument(option);
}

Argument Command::AddFlag(const std::string& names, bool& value, const std::string& meaning) const {
  return Argument(app_->add_flag(names, value, meaning));
}

void Parse(CLI::App& app, int argc, const char* const* argv) {
  CommandPath path = {&app};
  for (int i = 1; i < argc && std::string_view(argv[i]) != "--"; ++i) {
    const std::string word = argv[i];
    if (Descend(path, word)) continue;
    const CLI::Option* option = OptionOf(path, word);
    if (option == nullptr) continue;
    if (const std::size_t equals = word.find('='); equals != std::string::npos) {
      if (equals + 1 == word.size()) throw CLI::ValidationError(word.substr(0, equals), kNothingGiven);
    } else if (option->get_items_expected_min() > 0 && i + 1 < argc) {
      const std::string next = argv[++i];  // no command, whatever it is called
      if (next == "--" || OptionOf(path, next) != nullptr)
        throw CLI::ValidationError(word, "nothing is given, '" + next + "' comes next");
    }
  }
  app.parse(argc, argv);
}

#define CAIRN_ARGUMENT(...) \
  template Argument Command::Add(const std::string&, __VA_ARGS__&, const std::string&) const
CAIRN_ARGUMENT(std::string);
CAIRN_ARGUMENT(std::vector<std::string>);
CAIRN_ARGUMENT(int);
CAIRN_ARGUMENT(double);
CAIRN_ARGUMENT(std::uint64_t);
CAIRN_ARGUMENT(std::vector<std::uint64_t>);
CAIRN_ARGUMENT(std::optional<int>);
CAIRN_ARGUMENT(std::optional<double>);
CAIRN_ARGUMENT(std::optional<std::uint64_t>);
#undef CAIRN_ARGUMENT

template Argument Command::AddTaking(const std::string&, std::function<void(const std::string&)>,
                                     const std::string&) const;
template Argument Command::AddTaking(const std::string&, std::function<void(const double&)>,
                                     const std::string&) const;
template Argument Command::AddTaking(const std::string&, std::function<void(const std::uint64_t&)>,
                                     const std::string&) const;

}  // namespace cairn::cli
