// The command line of a worker program, whatever pipelines it has.
#pragma once

#include <vector>

#include "pipelines/registry.h"
#include "worker/executor.h"

namespace cairn::worker {

// Parses the command line, connects and works; returns the exit code. `pipelines` is what --describe prints.
int WorkerProgram(int argc, char** argv, const std::vector<PipelineInfo>& pipelines,
                  const PipelineFactory& factory);

}  // namespace cairn::worker
