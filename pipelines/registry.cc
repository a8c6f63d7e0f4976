#include "pipelines/registry.h"

#include <span>

#include "pipelines/all.h"

namespace cairn {
namespace {

struct Entry {
  PipelineInfo info;
  std::unique_ptr<const Pipeline> (*make)(const proto::Stage& stage, std::uint64_t seed);
};

// A method's folder says what it is: `PipelineType`, `Options`, `kSummary`, `kInputRoles` in its namespace.
template <class Method, class Options>
Entry Register(const char* name, const char* summary, std::span<const char* const> inputs) {
  return {{name, summary, {inputs.begin(), inputs.end()}, DescribeOptions<Options>()},
          [](const proto::Stage& stage, std::uint64_t seed) -> std::unique_ptr<const Pipeline> {
            return std::make_unique<Method>(ParseOptions<Options>(stage.options()), seed);
          }};
}

#define CAIRN_REGISTER(name) \
  Register<name::PipelineType, name::Options>(#name, name::kSummary, name::kInputRoles),

const std::vector<Entry>& Entries() {
  static const std::vector<Entry> entries = {CAIRN_PIPELINES(CAIRN_REGISTER)};
  return entries;
}

}  // namespace

std::vector<PipelineInfo> ListPipelines() {
  std::vector<PipelineInfo> infos;
  for (const Entry& entry : Entries()) infos.push_back(entry.info);
  return infos;
}

std::unique_ptr<const Pipeline> MakePipeline(const proto::Stage& stage, std::uint64_t seed) {
  for (const Entry& entry : Entries()) {
    if (entry.info.name != stage.pipeline()) continue;
    try {
      return entry.make(stage, seed);
    } catch (const InputError& error) {
      throw InputError("stage '" + stage.name() + "': " + error.what());
    }
  }
  throw InputError("stage '" + stage.name() + "': there is no pipeline '" + stage.pipeline() + "'");
}

}  // namespace cairn
