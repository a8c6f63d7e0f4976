#include "pipelines/landmark_map/m_step_task.h"

#include <string>

#include "pipelines/common/handed_over.h"
#include "pipelines/landmark_map/estimate.h"
#include "pipelines/landmark_map/state/settings.h"

namespace cairn::landmark_map {

std::string PartialInput(std::size_t index) { return "partial/" + std::to_string(index); }

namespace {

RoundSum SumOf(const Task& task, const Inputs& inputs, const MapRules& rules) {
  const auto robots = static_cast<std::size_t>(IntegerOf(task, "robots", 1, 1 << 24));
  RoundSum sum = inputs.Has("sum") ? RoundSum::FromBlob(inputs.Get("sum")->Sub("sum/"), robots)
                                   : RoundSum(NoCounts(rules), robots);
  RequireSize("the layers of a sum", sum.counts().layers.size(), static_cast<std::size_t>(rules.layers()));
  for (std::size_t i = 0; inputs.Has(PartialInput(i)); ++i) sum.Add(*inputs.Get(PartialInput(i)));
  return sum;
}

}  // namespace

Blob RunSum(const Task& task, const Inputs& inputs) {
  const Settings settings = Settings::FromBlob(*inputs.Get("settings"));
  Blob blob;
  blob.PutAll("sum/", SumOf(task, inputs, settings.map).ToBlob());
  return blob;
}

Blob RunMStep(const Task& task, const Inputs& inputs) {
  const Settings settings = Settings::FromBlob(*inputs.Get("settings"));
  const RoundSum sum = SumOf(task, inputs, settings.map);
  RequireMemory("the M-step", MStepBytes(sum.counts(), settings.map), settings.memory_mb);
  Blob blob;
  blob.PutAll("sum/", sum.ToBlob());
  PutFields("perception/", MakePerception(MapFromCounts(sum.counts(), settings.map), settings.map), &blob);
  PutRows("landmarks/", ExtractLandmarks(sum.counts(), settings.map), &blob);
  return blob;
}

MStep MStep::FromBlob(const Blob& blob, std::size_t robots) {
  return {RoundSum::FromBlob(blob.Sub("sum/"), robots), FieldsIn<Perception>("perception/", blob),
          RowsIn<Landmark>(blob, "landmarks/")};
}

}  // namespace cairn::landmark_map
