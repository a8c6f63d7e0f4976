#include "coordinator/cli/output/pipeline_text.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/output/text_table.h"

namespace cairn::cli {
namespace {

constexpr std::size_t kWidth = 100;

// `text` in lines of at most kWidth, each after `indent` blanks.
std::string Wrapped(std::string_view text, std::size_t indent) {
  std::string lines, line;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (!line.empty() && indent + line.size() + 1 + end > kWidth) {
      lines += std::string(indent, ' ') + line + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + std::string(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return line.empty() ? lines : lines + std::string(indent, ' ') + line + "\n";
}

std::string InputText(const PipelineSpec& pipeline) {
  std::string text;
  for (const InputSpec& input : pipeline.inputs) {
    const bool main = &input == &pipeline.inputs.front();
    text += "  " + input.name + (main ? ": FILE.h5" : ": --input " + input.name + "=FILE.h5") +
            (input.optional ? ", may be left out" : "") + "\n";
  }
  return text;
}

std::string OptionText(const OptionSpec& option) {
  const std::string unit = option.unit.empty() || option.default_text.empty() ? "" : " " + option.unit;
  const std::string value = option.default_text.empty() ? "\"\"" : option.default_text;
  return "  " + option.name + "=" + value + unit + "\n" +
         Wrapped(option.help.empty() ? option.Allowed() : option.help + "; " + option.Allowed(), 6);
}

nlohmann::ordered_json ToJson(const OptionSpec& option) {
  nlohmann::ordered_json json = {{"name", option.name},
                                 {"type", option.type},
                                 {"unit", option.unit},
                                 {"default", option.default_text},
                                 {"help", option.help}};
  if (option.type == "real" || option.type == "integer") {
    json["low"] = option.low;
    json["high"] = option.high;
  }
  if (!option.choices.empty()) json["choices"] = option.choices;
  return json;
}

// A value for the example: what is taken anyway. A 0 is none: it mostly lets the pipeline choose, and tells
// nobody what may be said.
bool IsForExample(const OptionSpec& option) {
  const bool number = option.type == "real" || option.type == "integer";
  return !option.default_text.empty() && !(number && ToReal(option.default_text).value_or(0) == 0);
}

// One that runs where the files that it names are there. An option that is empty unless somebody says
// otherwise may be one that has to be said, unless another input says it: which runs to localise in networks
// know.
std::string ExampleOf(const PipelineSpec& pipeline) {
  std::string example = "cairn run " + pipeline.name + " " +
                        (pipeline.inputs.empty() ? "FILE" : pipeline.inputs.front().name) + ".h5";
  const auto& options = pipeline.options;
  const auto beside = std::ranges::find_if(pipeline.inputs, &InputSpec::optional);
  if (!options.empty() && options.front().default_text.empty() && beside != pipeline.inputs.end())
    example += " --input " + beside->name + "=" + beside->name + ".h5";
  if (const auto option = std::ranges::find_if(options, IsForExample); option != options.end())
    example += " --set " + option->name + "=" + option->default_text;
  return example + " --out result";
}

}  // namespace

std::string PipelineList(const std::vector<PipelineSpec>& pipelines) {
  std::vector<std::vector<std::string>> rows = {{"pipeline", "reads", "what it does"}};
  for (const PipelineSpec& pipeline : pipelines) {
    std::string inputs;
    for (const InputSpec& input : pipeline.inputs)
      inputs += (inputs.empty() ? "" : ", ") + (input.optional ? "[" + input.name + "]" : input.name);
    rows.push_back({pipeline.name, inputs, pipeline.summary});
  }
  return TextTable(rows) + "\ncairn pipelines NAME (or cairn run NAME --help) lists the options of one\n";
}

std::string PipelineText(const PipelineSpec& pipeline) {
  std::string text = pipeline.name + "\n" + Wrapped(pipeline.summary, 2) + "\nIt reads:\n" +
                     InputText(pipeline) + "\nOptions, with what they are where nobody says otherwise (" +
                     "--set NAME=VALUE, or `options:` of a job file):\n";
  for (const OptionSpec& option : pipeline.options) text += OptionText(option);
  return text + "\nExample:\n  " + ExampleOf(pipeline) +
         "\n\ncairn run --help says what `cairn run` itself takes\n";
}

std::string PipelinesJson(const std::vector<PipelineSpec>& pipelines) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PipelineSpec& pipeline : pipelines) {
    nlohmann::ordered_json one = {{"name", pipeline.name}, {"summary", pipeline.summary}};
    one["inputs"] = nlohmann::ordered_json::array();
    for (const InputSpec& input : pipeline.inputs)
      one["inputs"].push_back({{"name", input.name}, {"optional", input.optional}});
    one["options"] = nlohmann::ordered_json::array();
    for (const OptionSpec& option : pipeline.options) one["options"].push_back(ToJson(option));
    list.push_back(std::move(one));
  }
  return list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace cairn::cli
