#include "coordinator/cli/output/plan_text.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "schema/kinds/learning.h"
#include "schema/kinds/log.h"

namespace cairn::cli {
namespace {

// The shortest that reads as the same number, with an exponent where that is shorter.
std::string Decimal(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

std::string Megabytes(std::size_t bytes) {
  return Decimal(std::round(static_cast<double>(bytes) / 1e4) / 100) + " MB";
}

std::string StageText(const proto::Stage& stage, const PipelineSpec& pipeline) {
  std::string text = "stage " + stage.name() + ": " + stage.pipeline() + "\n";
  for (const InputSpec& input : pipeline.inputs) {
    const auto source = stage.inputs().find(input.name);
    if (source != stage.inputs().end()) text += "  " + input.name + ": " + source->second + "\n";
  }
  for (const OptionSpec& option : pipeline.options) {
    const auto given = stage.options().find(option.name);
    const bool is_default = given == stage.options().end();
    text += fmt::format("  {} = {}{}{}\n", option.name,
                        is_default ? option.default_text + " (default)" : ValueText(given->second),
                        option.help.empty() ? "" : "   # ", option.help);
  }
  return text;
}

// Of a log, or of a table of poses.
std::string LogText(const kinds::Log& log) {
  std::size_t controls = 0, observations = 0, scans = 0, poses = 0;
  for (const kinds::Log::Robot& robot : log.robot) {
    controls += robot.odometry.time_s.OrNone().size();
    observations += robot.observations.time_s.OrNone().size();
    for (const kinds::Log::RangeSensor& sensor : robot.sensors) scans += sensor.time_s.OrNone().size();
    poses += robot.poses.time_s.OrNone().size();
  }
  const std::size_t robots = log.robot.size();
  std::string text = fmt::format("{} robot{}, ", robots, robots == 1 ? "" : "s");
  if (!log.robot[0].odometry.time_s) return text + fmt::format("{} poses", poses);
  text += fmt::format("{} controls, {} observations", controls, observations);
  if (scans > 0) text += fmt::format(", {} range scans", scans);
  if (poses > 0) text += fmt::format(", {} poses", poses);
  return text;
}

std::string SamplesText(const kinds::Samples& of) {
  const std::size_t runs = of.runs.size(), inputs = of.input_name.size();
  std::size_t samples = 0;
  for (const kinds::Samples::Run& run : of.run) samples += run.time_s.OrNone().size();
  return fmt::format("{} run{}, {} samples, {} input{}", runs, runs == 1 ? "" : "s", samples, inputs,
                     inputs == 1 ? "" : "s");
}

}  // namespace

std::string ValueText(const proto::Value& value) {
  switch (value.kind_case()) {
    case proto::Value::kI:
      return std::to_string(value.i());
    case proto::Value::kD:
      return Decimal(value.d());
    case proto::Value::kB:
      return value.b() ? "true" : "false";
    case proto::Value::kS:
      return value.s();
    case proto::Value::KIND_NOT_SET:
      break;
  }
  return "";
}

std::string ContentText(const Blob& blob) {
  const bool moves = blob.Has("robot/0/odometry/time_s") || blob.Has("robot/0/poses/time_s");
  if (const auto log = Read<kinds::Log>(blob); moves && !log.robot.empty()) return LogText(log);
  if (blob.Has("runs") && blob.Has("run/0/time_s") && blob.Has("input_name"))
    return SamplesText(Read<kinds::Samples>(blob));
  if (blob.Has("position/x_m") && blob.Has("error")) {
    const auto places = static_cast<std::size_t>(blob.at("position/x_m").size());
    return "what it costs to take one of " + std::to_string(places) + " places for another";
  }
  return "";
}

std::string PlanText(const Plan& plan) {
  const proto::Job& job = plan.job;
  std::string text = "job " + job.name() + ", seed " + std::to_string(job.seed()) + "\n";
  for (const auto& [name, blob] : plan.inputs) {
    const std::string content = ContentText(*blob);
    text += "input " + name + ": " + job.inputs().at(name) + " (" + (content.empty() ? "" : content + ", ") +
            Megabytes(blob->ByteCount()) + ")\n";
  }
  for (const proto::Stage& stage : job.stages()) text += StageText(stage, plan.catalog.At(stage.pipeline()));
  return text + "stage " + job.stages(0).name() + ", expected: " + plan.first_stage + "\n";
}

std::string PlanJson(const Plan& plan) {
  const proto::Job& job = plan.job;
  nlohmann::ordered_json json = {{"job", job.name()}, {"seed", job.seed()}};
  for (const auto& [name, blob] : plan.inputs) {
    json["inputs"][name] = {
        {"path", job.inputs().at(name)}, {"bytes", blob->ByteCount()}, {"what", ContentText(*blob)}};
  }
  for (const proto::Stage& stage : job.stages()) {
    nlohmann::ordered_json one = {{"name", stage.name()}, {"pipeline", stage.pipeline()}};
    for (const auto& [name, source] : stage.inputs()) one["inputs"][name] = source;
    for (const OptionSpec& option : plan.catalog.At(stage.pipeline()).options) {
      const auto given = stage.options().find(option.name);
      one["options"][option.name] =
          given == stage.options().end() ? option.default_text : ValueText(given->second);
    }
    json["stages"].push_back(one);
  }
  json["expected"] = plan.expected;
  json["note"] = plan.first_stage;
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace cairn::cli
