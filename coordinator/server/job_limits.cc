#include "coordinator/server/job_limits.h"

#include "schema/text.h"

namespace cairn::coordinator {
namespace {

bool IsPlain(const std::string& text, std::size_t most_bytes) {
  return WhatIsWrongWithName(text, most_bytes).empty();
}

}  // namespace

std::string CheckLimits(const proto::Job& job, const wire::JobLimits& limits) {
  const std::size_t most = limits.text_bytes;
  if (job.ByteSizeLong() > limits.job_bytes)
    return "the job is larger than " + std::to_string(limits.job_bytes) + " bytes";
  if (job.stages_size() > limits.stages)
    return "the job has more than " + std::to_string(limits.stages) + " stages";
  int values = job.inputs_size() + job.input_blobs_size();
  for (const proto::Stage& stage : job.stages()) values += stage.inputs_size() + stage.options_size();
  if (values > limits.values)
    return "the job has more than " + std::to_string(limits.values) + " inputs and options";
  bool plain = IsPlain(job.name(), most);
  for (const auto& [name, path] : job.inputs()) plain = plain && IsPlain(name, most) && IsPlain(path, most);
  for (const auto& [name, hash] : job.input_blobs()) plain = plain && IsPlain(name, most);
  for (const proto::Stage& stage : job.stages()) {
    plain = plain && IsPlain(stage.name(), most) && IsPlain(stage.pipeline(), most);
    for (const auto& [name, source] : stage.inputs())
      plain = plain && IsPlain(name, most) && IsPlain(source, most);
    for (const auto& [name, value] : stage.options())
      plain = plain && IsPlain(name, most) && IsPlain(value.s(), most);
  }
  return plain ? ""
               : "a text of the job has control characters, or more than " + std::to_string(most) + " bytes";
}

}  // namespace cairn::coordinator
