// The in-process runner: a loop over a pipeline's three functions. What a fleet computes must equal it bit
// for bit.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "pipelines/pipeline.h"

namespace cairn {

// Runs a stage to its end and returns its result. `on_step` sees each step's plan (Start's first).
BlobPtr RunInProcess(const Pipeline& pipeline, const std::map<std::string, BlobPtr>& inputs,
                     const std::function<void(const proto::Step&)>& on_step = {});

}  // namespace cairn
