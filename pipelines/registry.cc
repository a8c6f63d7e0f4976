#include "pipelines/registry.h"

#include "pipelines/evidence_map/evidence_map.h"
#include "pipelines/forward_map/forward_map.h"
#include "pipelines/image_features/image_features.h"
#include "pipelines/landmark_learning/landmark_learning.h"
#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/local_map/local_map.h"
#include "pipelines/localization/localization.h"

namespace cairn {
namespace {

struct Entry {
  PipelineInfo info;
  std::unique_ptr<const Pipeline> (*make)(const proto::Stage& stage, std::uint64_t seed);
};

template <class Method, class Options>
Entry Register(const char* name, const char* summary, std::vector<std::string> inputs) {
  return {{name, summary, std::move(inputs), DescribeOptions<Options>()},
          [](const proto::Stage& stage, std::uint64_t seed) -> std::unique_ptr<const Pipeline> {
            return std::make_unique<Method>(ParseOptions<Options>(stage.options()), seed);
          }};
}

const std::vector<Entry>& Entries() {
  static const std::vector<Entry> entries = {
      Register<evidence_map::EvidenceMap, evidence_map::Options>(
          "evidence_map", "occupancy of each cell by itself: log-odds and inverse sensor models",
          {"log", "poses?"}),
      Register<forward_map::ForwardMap, forward_map::Options>(
          "forward_map", "occupancy maps by EM over forward sensor models, with uncertainty",
          {"log", "poses?"}),
      Register<image_features::ImageFeatures, image_features::Options>(
          "image_features", "what networks see of images: brightness, colour, texture of bands", {"samples"}),
      Register<landmark_map::LandmarkMap, landmark_map::Options>(
          "landmark_map", "landmark maps and trajectories by EM over alpha-beta", {"log", "map?"}),
      Register<landmark_learning::LandmarkLearning, landmark_learning::Options>(
          "landmark_learning", "networks that extract the features which localise best (BaLL)",
          {"samples", "weights?", "map?", "errors?"}),
      Register<local_map::LocalMap, local_map::Options>(
          "local_map", "local grids, edge traces, and a path put together from their graph", {"log"}),
      Register<localization::Localization, localization::Options>(
          "localization", "where robots are, by learned or hand-made features",
          {"samples", "networks?", "networks_2?", "networks_3?"}),
  };
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
