#include "coordinator/cli/job_file/arguments.h"

#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/common/suggest.h"
#include "schema/error.h"
#include "schema/text.h"

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
  if (stage.options().contains(spec->name))
    throw InputError("--set " + setting + ": '" + spec->name + "' was given already");
  try {
    (*stage.mutable_options())[spec->name] =
        ParseOption(*spec, setting.substr(equals + 1), Quoting::kCommandLine);
  } catch (const InputError& error) {
    throw InputError("--set " + setting + ": " + error.what());
  }
}

void RequireFile(const std::string& path) {
  if (const std::string why = WhyNoFile(path); !why.empty()) throw InputError(why);
}

// NAME=FILE.
void AddInput(const std::string& input, const PipelineSpec& pipeline, ParsedJob& parsed) {
  const std::size_t equals = input.find('=');
  if (equals == std::string::npos) throw InputError("--input " + input + ": write name=FILE");
  const std::string name = input.substr(0, equals), file = input.substr(equals + 1);
  if (pipeline.FindInput(name) == nullptr) {
    throw InputError("--input " + input + ": " + pipeline.name + " has no such input" +
                     Suggest(name, pipeline.InputNames()));
  }
  if (parsed.inputs.contains(name))
    throw InputError("--input " + input + ": '" + name + "' was given already");
  RequireFile(file);
  (*parsed.job.mutable_inputs())[name] = file;
  (*parsed.job.mutable_stages(0)->mutable_inputs())[name] = name;
  parsed.inputs[name] = {file, "--input " + name};
}

ParsedJob MakeJob(const JobArguments& arguments, const Catalog& catalog) {
  const PipelineSpec& pipeline = catalog.At(arguments.what);
  const std::string& main = MainInput(pipeline);
  if (arguments.file.empty()) {
    throw InputError("which " + main + "? The file comes after the pipeline: " + arguments.what + " FILE.h5");
  }
  RequireFile(arguments.file);
  ParsedJob parsed;
  parsed.job.set_name(arguments.name.empty() ? pipeline.name : arguments.name);
  parsed.job.set_seed(arguments.seed);
  (*parsed.job.mutable_inputs())[main] = arguments.file;
  parsed.inputs[main] = {arguments.file, "the " + main};
  proto::Stage& stage = *parsed.job.add_stages();
  stage.set_name(pipeline.name);
  stage.set_pipeline(pipeline.name);
  (*stage.mutable_inputs())[main] = main;
  for (const std::string& input : arguments.inputs) AddInput(input, pipeline, parsed);
  for (const InputSpec& input : pipeline.inputs) {
    if (!input.optional && !stage.inputs().contains(input.name))
      throw InputError(pipeline.name + " also needs '" + input.name + "': --input " + input.name + "=FILE");
  }
  for (const std::string& setting : arguments.settings) Set(setting, pipeline, stage);
  return parsed;
}

}  // namespace

const std::string& MainInput(const PipelineSpec& pipeline) {
  CAIRN_DEMAND(!pipeline.inputs.empty(), "a pipeline without inputs");
  return pipeline.inputs.front().name;
}

bool IsJobFile(const std::string& what) { return what.ends_with(".yaml") || what.ends_with(".yml"); }

void AddJobArguments(Command command, JobArguments& arguments) {
  command.Add("JOB.yaml|PIPELINE", arguments.what, "A job file, or the name of a pipeline").Required();
  command.Add("FILE.h5", arguments.file,
              "What the pipeline reads (a log, samples), where a pipeline is named");
  command.Add("--set", arguments.settings, "An option of the pipeline, key=value; again for another")
      .OneEachTime();
  command
      .Add("--input", arguments.inputs,
           "Another input of the pipeline, name=FILE (map=first/landmark_map.h5); again for another")
      .OneEachTime();
  command.Add("--name", arguments.name,
              "What the job is called, where a pipeline is named (as the pipeline)");
  command.AddFlag("--units-are-right", arguments.units_are_right,
                  "Take a log of what no robot does, instead of asking for its units");
  command.Add("--seed", arguments.seed, "Seed, where a pipeline is named").Check(CheckSeed).ShowDefault();
}

namespace {

// Here once, for all that takes a job.
ParsedJob WithPlainTexts(ParsedJob parsed) {
  const auto check = [](const std::string& what, const std::string& text, std::size_t most) {
    if (const std::string wrong = WhatIsWrongWithName(text, most); !wrong.empty())
      throw InputError(what + " '" + EscapedName(text.substr(0, kMostNameBytes)) + "' " + wrong);
  };
  check("the job's name", parsed.job.name(), kMostNameBytes);
  for (auto& [name, path] : *parsed.job.mutable_inputs()) {
    check("the name of the input", name, kMostNameBytes);
    path = Escaped(path);  // for people; a file's name may be of any bytes
  }
  for (const proto::Stage& stage : parsed.job.stages()) {
    check("the name of the stage", stage.name(), kMostNameBytes);
    for (const auto& [name, value] : stage.options())
      check("stage '" + stage.name() + "': the value of " + name, value.s(), kMostTextBytes);
  }
  return parsed;
}

}  // namespace

ParsedJob ResolveJob(const JobArguments& arguments, const Catalog& catalog) {
  if (!IsJobFile(arguments.what)) return WithPlainTexts(MakeJob(arguments, catalog));
  if (!arguments.file.empty()) {
    throw InputError("a job file names its own inputs; '" + arguments.file + "' is one too many");
  }
  if (!arguments.settings.empty() || !arguments.inputs.empty() || arguments.seed != 0 ||
      !arguments.name.empty()) {
    throw InputError(
        "--set, --input, --seed and --name are for a pipeline without a job file; write them into " +
        arguments.what);
  }
  return WithPlainTexts(ReadJobFile(arguments.what, catalog));
}

}  // namespace cairn::cli
