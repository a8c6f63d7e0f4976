#include "pipelines/registry.h"

namespace cairn {

std::vector<PipelineInfo> ListPipelines() { return {}; }

std::unique_ptr<const Pipeline> MakePipeline(const proto::Stage& stage, std::uint64_t) {
  throw InputError("stage " + stage.name() + ": there is no pipeline '" + stage.pipeline() + "'");
}

}  // namespace cairn
