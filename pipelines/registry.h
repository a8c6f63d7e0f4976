// Which pipelines there are: those that pipelines/CMakeLists.txt lists.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pipelines/common/options.h"
#include "pipelines/pipeline.h"

namespace cairn {

struct PipelineInfo {
  std::string name;
  std::string summary;              // one line
  std::vector<std::string> inputs;  // "log", "poses?" (optional)
  std::vector<OptionInfo> options;
};

std::vector<PipelineInfo> ListPipelines();

// Throws InputError that names the pipeline, or the option and what is allowed.
std::unique_ptr<const Pipeline> MakePipeline(const proto::Stage& stage, std::uint64_t seed);

}  // namespace cairn
