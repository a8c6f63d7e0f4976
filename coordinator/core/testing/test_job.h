// Jobs that compute nothing, for tests and benchmarks of the core.
#pragma once

#include <cstdint>
#include <string>

#include "coordinator/core/core.h"
#include "schema/hash.h"

namespace cairn::coordinator {

inline Hash H(std::uint64_t n) {
  Hasher hasher;
  hasher.Add(n);
  return hasher.Finish();
}

inline wire::Build TestBuild(const std::string& version = "1") {
  wire::Build build;
  build.set_version(version);
  return build;
}

// `log`: of its only input.
inline proto::Job TestJob(int stages = 1, const Hash& log = H(1000)) {
  proto::Job job;
  job.set_name("test");
  job.set_seed(7);
  (*job.mutable_input_blobs())["log"] = log.Binary();
  for (int i = 0; i < stages; ++i) {
    proto::Stage& stage = *job.add_stages();
    stage.set_name("stage" + std::to_string(i));
    stage.set_pipeline("toy");
    (*stage.mutable_inputs())["log"] = "log";
    if (i > 0) (*stage.mutable_inputs())["before"] = "stage" + std::to_string(i - 1);
  }
  return job;
}

// `tasks` independent tasks that read the log.
inline proto::Step TestStep(int tasks, const std::string& note = "", const Hash& log = H(1000)) {
  proto::Step step;
  step.set_note(note);
  for (int i = 0; i < tasks; ++i) {
    proto::Task& task = *step.add_tasks();
    task.set_index(static_cast<std::uint32_t>(i));
    task.set_kind("toy");
    proto::InputRef& input = *task.add_inputs();
    input.set_name("log");
    input.set_blob(log.Binary());
  }
  return step;
}

}  // namespace cairn::coordinator
