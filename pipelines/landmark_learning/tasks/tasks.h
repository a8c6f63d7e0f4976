// What the tasks of plan.h compute.
#pragma once

#include <cstdint>

#include "pipelines/landmark_learning/state/options.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_learning {

Blob RunTask(const Options& options, std::uint64_t seed, const Task& task, const Inputs& inputs,
             Progress& progress);

}  // namespace cairn::landmark_learning
