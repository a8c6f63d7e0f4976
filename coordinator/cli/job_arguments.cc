#include "coordinator/cli/job_arguments.h"

#include <filesystem>

#include "coordinator/cli/suggest.h"
#include "schema/error.h"

namespace cairn::cli {
namespace {

void Set(const std::string& setting, const PipelineSpec& pipeline, proto::Stage& stage) {
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos) throw InputError("--set " + setting + ": write key=value");
  const std::string key = setting.substr(0, equals);
  const OptionSpec* spec = pipeline.FindOption(key);
  if (spec == nullptr) {
    throw InputError("--set " + setting + ": unknown option" + Suggest(key, pipeline.OptionNames()));
  }
  if (stage.options().contains(key))
    throw InputError("--set " + setting + ": '" + key + "' was given already");
  try {
    (*stage.mutable_options())[key] = ParseOption(*spec, setting.substr(equals + 1), Quoting::kCommandLine);
  } catch (const InputError& error) {
    throw InputError("--set " + setting + ": " + error.what());
  }
}

}  // namespace

ParsedJob MakeJob(const std::string& pipeline_name, const std::string& log,
                  const std::vector<std::string>& settings, std::uint64_t seed, const Catalog& catalog) {
  const PipelineSpec& pipeline = catalog.At(pipeline_name);
  if (!std::filesystem::is_regular_file(log)) throw InputError("there is no file '" + log + "'");
  ParsedJob parsed;
  parsed.job.set_name(pipeline_name);
  parsed.job.set_seed(seed);
  (*parsed.job.mutable_inputs())["log"] = log;
  parsed.inputs["log"] = {log, log};
  proto::Stage& stage = *parsed.job.add_stages();
  stage.set_name(pipeline_name);
  stage.set_pipeline(pipeline_name);
  for (const InputSpec& input : pipeline.inputs) {
    if (input.name == "log")
      (*stage.mutable_inputs())["log"] = "log";
    else if (!input.optional)
      throw InputError(pipeline_name + " also needs '" + input.name + "': write a job file");
  }
  for (const std::string& setting : settings) Set(setting, pipeline, stage);
  return parsed;
}

}  // namespace cairn::cli
