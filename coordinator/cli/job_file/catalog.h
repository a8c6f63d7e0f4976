// What `cairn-worker --describe` says: the pipelines, their inputs and options. By it options are checked
// before a job is submitted, with the line of the job file.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schema/job.pb.h"

namespace cairn::cli {

struct InputSpec {
  std::string name;
  bool optional = false;
};

struct OptionSpec {
  std::string name, type, unit, help;  // type: real, integer, boolean, text
  double low = 0, high = 0;            // inclusive; of numbers only
  std::vector<std::string> choices;    // of texts; empty: anything
  std::string default_text;            // for people

  // "a number from 0.01 to 10 m", "true or false", "one of a, b".
  std::string Allowed() const;
};

struct PipelineSpec {
  std::string name, summary;
  std::vector<InputSpec> inputs;
  std::vector<OptionSpec> options;

  const InputSpec* FindInput(const std::string& input) const;
  // By its name, or by the one that it had before (command_line/renamed.h), with a warning.
  const OptionSpec* FindOption(const std::string& option) const;
  std::vector<std::string> InputNames() const;
  std::vector<std::string> OptionNames() const;
};

class Catalog {
 public:
  // Throws InputError where the text is not what `cairn-worker --describe` prints.
  static Catalog FromJson(std::string_view json);

  const std::vector<PipelineSpec>& pipelines() const { return pipelines_; }
  // Throws InputError "there is no pipeline 'x'; did you mean …".
  const PipelineSpec& At(const std::string& pipeline) const;

 private:
  std::vector<PipelineSpec> pipelines_;
};

// Asks cairn-worker which pipelines there are.
Catalog LoadCatalog();

// How a value was written: in a YAML file `5` and `"5"` are not the same; on the command line all is plain.
enum class Quoting { kPlain, kQuoted, kCommandLine };

// Throws InputError that says what is allowed; the caller puts file and line before it.
proto::Value ParseOption(const OptionSpec& spec, const std::string& text, Quoting quoting);

}  // namespace cairn::cli
