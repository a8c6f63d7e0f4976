#include "pipelines/landmark_map/m_step_task.h"

#include <string>

#include "pipelines/common/handed_over.h"
#include "pipelines/landmark_map/estimate.h"
#include "pipelines/landmark_map/state/settings.h"

namespace cairn::landmark_map {

std::string PartialInput(std::size_t index) { return "partial/" + std::to_string(index); }

namespace {

RoundSum SumOf(const Settings& settings, const Task& task, const Inputs& inputs) {
  const auto robots = static_cast<std::size_t>(IntegerOf(task, "robots", 1, 1 << 24));
  RoundSum sum = inputs.Has("sum") ? RoundSum::FromBlob(settings, inputs.Get("sum")->Sub("sum/"), robots)
                                   : RoundSum(settings, robots);
  for (std::size_t i = 0; inputs.Has(PartialInput(i)); ++i) sum.Add(*inputs.Get(PartialInput(i)));
  return sum;
}

}  // namespace

Blob RunSum(const Options& options, const Task& task, const Inputs& inputs) {
  const Settings settings = Settings::In(*inputs.Get("settings"), options);
  Blob blob;
  blob.PutAll("sum/", SumOf(settings, task, inputs).ToBlob());
  return blob;
}

Blob RunMStep(const Options& options, const Task& task, const Inputs& inputs) {
  const Settings settings = Settings::In(*inputs.Get("settings"), options);
  const RoundSum sum = SumOf(settings, task, inputs);
  RequireMemory("the M-step", MStepBytes(sum.counts(), settings.map), settings.memory_mb);
  Blob blob;
  blob.PutAll("sum/", sum.ToBlob());
  PutFields("perception/", MakePerception(MapFromCounts(sum.counts(), settings.map), settings.map), &blob);
  PutRows("landmarks/", ExtractLandmarks(sum.counts(), settings.map), &blob);
  return blob;
}

MStep MStep::FromBlob(const Settings& settings, const Blob& blob, std::size_t robots) {
  MStep made{RoundSum::FromBlob(settings, blob.Sub("sum/"), robots),
             FieldsIn<Perception>("perception/", blob), LandmarksIn(blob.Sub("landmarks/"), settings.map)};
  made.perception.Check(settings.map.layers());
  return made;
}

}  // namespace cairn::landmark_map
