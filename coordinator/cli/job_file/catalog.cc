#include "coordinator/cli/job_file/catalog.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "coordinator/cli/common/programs.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/common/suggest.h"
#include "schema/command_line/renamed.h"
#include "schema/error.h"

namespace cairn::cli {
namespace {

using nlohmann::json;

std::string Number(double value) { return fmt::format("{:g}", value); }

OptionSpec ToOption(const json& j) {
  OptionSpec option;
  option.name = j.at("name").get<std::string>();
  option.type = j.at("type").get<std::string>();
  option.unit = j.value("unit", "");
  option.help = j.value("help", "");
  option.low = j.value("low", 0.0);
  option.high = j.value("high", 0.0);
  option.choices = j.value("choices", std::vector<std::string>{});
  if (j.contains("default")) {
    option.default_text = j["default"].is_string() ? j["default"].get<std::string>() : j["default"].dump();
  }
  return option;
}

PipelineSpec ToPipeline(const json& j) {
  PipelineSpec pipeline;
  pipeline.name = j.at("name").get<std::string>();
  pipeline.summary = j.value("summary", "");
  for (const json& input : j.at("inputs")) {
    std::string name = input.get<std::string>();
    const bool optional = name.ends_with('?');
    if (optional) name.pop_back();
    pipeline.inputs.push_back({name, optional});
  }
  for (const json& option : j.at("options")) pipeline.options.push_back(ToOption(option));
  return pipeline;
}

template <class Specs>
auto FindByName(const Specs& specs, const std::string& name) -> decltype(specs.data()) {
  const auto it = std::ranges::find_if(specs, [&](const auto& spec) { return spec.name == name; });
  return it == specs.end() ? nullptr : &*it;
}

template <class Specs>
std::vector<std::string> Names(const Specs& specs) {
  std::vector<std::string> names;
  names.reserve(specs.size());
  for (const auto& spec : specs) names.push_back(spec.name);
  return names;
}

[[noreturn]] void Refuse(const OptionSpec& spec, const std::string& text) {
  throw InputError("'" + text + "' is not allowed; allowed: " + spec.Allowed());
}

}  // namespace

std::string OptionSpec::Allowed() const {
  if (type == "boolean") return "true or false";
  if (type == "text") return choices.empty() ? "a text" : "one of " + Join(choices);
  const std::string kind = type == "integer" ? "a whole number" : "a number";
  return kind + " from " + Number(low) + " to " + Number(high) + (unit.empty() ? "" : " " + unit);
}

const InputSpec* PipelineSpec::FindInput(const std::string& input) const { return FindByName(inputs, input); }
const OptionSpec* PipelineSpec::FindOption(const std::string& option) const {
  if (const OptionSpec* found = FindByName(options, option)) return found;
  const OptionSpec* renamed = FindByName(options, NameNow(name, option));
  if (renamed != nullptr) WarnOfOldName(option, renamed->name);
  return renamed;
}
std::vector<std::string> PipelineSpec::InputNames() const { return Names(inputs); }
std::vector<std::string> PipelineSpec::OptionNames() const { return Names(options); }

Catalog Catalog::FromJson(std::string_view text) {
  Catalog catalog;
  try {
    const json document = json::parse(text);
    for (const json& pipeline : document.at("pipelines")) catalog.pipelines_.push_back(ToPipeline(pipeline));
  } catch (const json::exception& error) {
    throw InputError(std::string("cairn-worker describes its pipelines in another way than expected: ") +
                     error.what());
  }
  return catalog;
}

const PipelineSpec& Catalog::At(const std::string& pipeline) const {
  const PipelineSpec* found = FindByName(pipelines_, pipeline);
  if (found == nullptr) {
    const std::string hint = pipeline.find('.') != std::string::npos
                                 ? "; `cairn map " + pipeline + "` chooses one"
                                 : Suggest(pipeline, Names(pipelines_));
    throw InputError("there is no pipeline '" + pipeline + "'" + hint);
  }
  return *found;
}

Catalog LoadCatalog() { return Catalog::FromJson(OutputOf(WorkerProgram(), {"--describe"})); }

proto::Value ParseOption(const OptionSpec& spec, const std::string& text, Quoting quoting) {
  proto::Value value;
  if (spec.type == "text") {
    const bool looks_typed = ToReal(text) || ToBoolean(text);
    if (quoting == Quoting::kPlain && looks_typed) Refuse(spec, text);
    const bool known = spec.choices.empty() || std::ranges::find(spec.choices, text) != spec.choices.end();
    if (!known) Refuse(spec, text);
    value.set_s(text);
    return value;
  }
  if (quoting == Quoting::kQuoted) Refuse(spec, "\"" + text + "\"");
  if (spec.type == "boolean") {
    const std::optional<bool> boolean = ToBoolean(text);
    if (!boolean) Refuse(spec, text);
    value.set_b(*boolean);
    return value;
  }
  const std::optional<double> number = ToReal(text);
  if (!number || !(*number >= spec.low && *number <= spec.high)) Refuse(spec, text);
  if (spec.type == "integer") {
    const std::optional<std::int64_t> integer = ToInteger(text);
    if (!integer) Refuse(spec, text);
    value.set_i(*integer);
  } else {
    value.set_d(*number);
  }
  return value;
}

}  // namespace cairn::cli
