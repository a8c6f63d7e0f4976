// A command of `cairn`, or the program `cairn-worker`, and its arguments: what they need of CLI11, whose
// headers a compiler takes seconds for.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace cairn::cli {

// An option, a flag or a positional argument. What says more of it returns it again.
class Argument {
 public:
  explicit Argument(CLI::Option* option) : option_(option) {}

  Argument Required() const;
  Argument ShowDefault() const;  // in --help
  // T: int, double, std::uint64_t.
  template <class T>
  Argument Within(T least, T most) const;
  Argument Positive() const;
  Argument NotNegative() const;
  Argument OneOf(std::vector<std::string> words) const;
  Argument ExistingFolder() const;
  // `wrong` says what is wrong with what was given; nothing: it is right.
  Argument Check(std::function<std::string(const std::string&)> wrong) const;
  Argument Words(int least, int most) const;  // how many it takes
  // One each time it is given; what follows is another argument.
  Argument OneEachTime() const;
  Argument Needs(Argument other) const;
  Argument Excludes(Argument other) const;
  Argument Heading(const std::string& heading) const;  // in --help, over its like

 private:
  CLI::Option* option_;
};

// A handle: copies are of the same command, which lives as long as the parser.
class Command {
 public:
  Command() = default;
  explicit Command(CLI::App* app) : app_(app) {}

  Command AddCommand(const std::string& name, const std::string& summary) const;
  void NeedsCommand() const;  // one of those that were added
  // What a positional argument takes is what its checks let pass; the rest is the next one's.
  void PlaceByChecks() const;
  void Footer(const std::string& text) const;
  void WhenGiven(std::function<void()> call) const;

  // `names`: `--long`, `-s,--long`, or that of a positional argument. `value` lives until all is parsed. An
  // empty word is refused where text is taken.
  template <class T>
  Argument Add(const std::string& names, T& value, const std::string& meaning) const;
  template <class T>
  Argument AddTaking(const std::string& names, std::function<void(const T&)> take,
                     const std::string& meaning) const;
  Argument AddFlag(const std::string& names, bool& value, const std::string& meaning) const;

 private:
  CLI::App* app_ = nullptr;
};

// Of CLI11's parse(), which throws what this throws, `--out=` and `--out --force` take the next word for the
// value, whatever it is. Here both are refused, and `--out=--force` alone means it.
void Parse(CLI::App& app, int argc, const char* const* argv);

}  // namespace cairn::cli
