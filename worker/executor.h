// Computes tasks, one at a time: makes the pipeline, calls Start, Run or Advance, and puts what came of it,
// good or bad, into an answer.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "pipelines/pipeline.h"
#include "worker/desk.h"

namespace cairn::worker {

// pipelines/registry.h's MakePipeline, or a test's.
using PipelineFactory =
    std::function<std::unique_ptr<const Pipeline>(const proto::Stage& stage, std::uint64_t seed)>;

class Executor {
 public:
  Executor(Desk& desk, PipelineFactory factory) : desk_(desk), factory_(std::move(factory)) {}
  // Until the desk is closed.
  void Loop();

 private:
  wire::Message Answer(TaskInHand& task);
  wire::Message Compute(TaskInHand& task);
  const Pipeline& PipelineOf(const wire::Assign& assign);

  Desk& desk_;
  const PipelineFactory factory_;
  // The pipeline of the task before: tasks of one stage follow each other.
  std::string made_for_;
  std::unique_ptr<const Pipeline> pipeline_;
};

}  // namespace cairn::worker
