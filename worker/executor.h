// Computes tasks, one at a time: makes the pipeline, calls Start, Run or Advance, and puts what came of it,
// good or bad, into an answer.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "pipelines/pipeline.h"
#include "worker/task_memory.h"
#include "worker/task_queue.h"

namespace cairn::worker {

// pipelines/registry.h's MakePipeline, or a test's.
using PipelineFactory =
    std::function<std::unique_ptr<const Pipeline>(const proto::Stage& stage, std::uint64_t seed)>;

class Executor {
 public:
  // `memory_mb`: no task may take more, whatever its job says; 0: the job's limit alone.
  Executor(TaskQueue& queue, PipelineFactory factory, std::uint64_t memory_mb = 0)
      : queue_(queue), factory_(std::move(factory)), memory_mb_(memory_mb) {}
  // Until the task queue is closed.
  void Loop();

 private:
  wire::Message Answer(AssignedTask& task, TaskMemory& memory);
  wire::Message AnswerOrFailure(AssignedTask& task);
  wire::Message Compute(AssignedTask& task);
  const Pipeline& PipelineOf(const wire::Assign& assign);

  TaskQueue& queue_;
  const PipelineFactory factory_;
  const std::uint64_t memory_mb_;
  // The pipeline of the task before: tasks of one stage follow each other.
  std::string made_for_;
  std::unique_ptr<const Pipeline> pipeline_;
};

}  // namespace cairn::worker
