#include "pipelines/forward_map/plan.h"

#include <algorithm>
#include <limits>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/task_builder.h"

namespace cairn::forward_map {
namespace {

std::int64_t SensorsIn(const State& state) { return state.scalars().at(kSensors).i(); }

// Microseconds of a core that each of the beams' crossings of cells takes in a round of its kind; the first
// search, of the empty map, takes the most.
constexpr double kFirstSearchUs = 0.07, kSearchUs = 0.05, kWeighUs = 0.006, kCertaintyUs = 0.05,
                 kExplainUs = 0.005;
// What is usual: searches until nothing more is found, of several tiles and of one; rounds that weigh
// parameters after the first search, and after each of the others.
constexpr double kUsualSearches = 12, kUsualOfOne = 5, kUsualFirstSteps = 3, kUsualSteps = 0.3;

double CrossingsIn(const State& state) { return state.scalars().at(kCrossings).d(); }

double SearchUs(const Schedule& schedule) { return schedule.searches <= 1 ? kFirstSearchUs : kSearchUs; }

void ReadAllScans(std::int64_t sensors, TaskBuilder* task) {
  task->Set(kSensors, sensors).Read(kLogBlob);
  for (std::int64_t k = 0; k < sensors; ++k) {
    task->Read(SensorBlobName(k)).Read(ScansBlobName(k));
  }
}

// Each tile of a split, with all scans.
void PlanTiles(const char* kind, double us, const Schedule& schedule, std::int64_t split, proto::Step* plan) {
  const std::int64_t tiles = plan->state().scalars().at(TilesKey(split)).i();
  const double cost = us * CrossingsIn(plan->state()) / static_cast<double>(tiles);
  for (std::int64_t tile = 0; tile < tiles; ++tile) {
    TaskBuilder task(kind, cost, plan);
    task.Set("tile", tile).Set("searches", schedule.searches).Read(kMapBlob).Read("tiles", TilesBlob(split));
    ReadAllScans(SensorsIn(plan->state()), &task);
  }
}

void PlanWeighing(const Schedule& schedule, proto::Step* plan) {
  const State& state = plan->state();
  double all = 0;
  for (std::int64_t k = 0; k < SensorsIn(state); ++k)
    all += static_cast<double>(state.scalars().at(ScansKey(k)).i());
  for (std::int64_t k = 0; k < SensorsIn(plan->state()); ++k) {
    const std::int64_t scans = state.scalars().at(ScansKey(k)).i();
    const std::int64_t of_slice = state.scalars().at(SliceKey(k)).i();
    RequireWithin("the scans of a slice", of_slice, 1, std::numeric_limits<std::int32_t>::max());
    for (std::int64_t first = 0; first < scans; first += of_slice) {
      const double part = static_cast<double>(std::min(of_slice, scans - first)) / all;
      TaskBuilder task("weigh", kWeighUs * CrossingsIn(state) * part, plan);
      task.Set("sensor", k).Set("taken", schedule.taken).Read(kMapBlob);
      if (schedule.taken > 0) task.Read(kProposalsBlob);
      task.Read(kLogBlob)
          .Read("sensor", SensorBlobName(k))
          .Read("scans", ScansBlobName(k), {first, std::min(of_slice, scans - first)});
    }
  }
}

void PlanExplaining(proto::Step* plan) {
  for (std::int64_t k = 0; k < SensorsIn(plan->state()); ++k) {
    const double cost =
        kExplainUs * CrossingsIn(plan->state()) / static_cast<double>(SensorsIn(plan->state()));
    TaskBuilder("explain", cost, plan)
        .Set("sensor", k)
        .Read(kMapBlob)
        .Read(kLogBlob)
        .Read("sensor", SensorBlobName(k))
        .Read("scans", ScansBlobName(k));
  }
}

}  // namespace

void PlanTasks(proto::Step* plan) {
  plan->clear_tasks();
  const Schedule schedule = ScalarsIn<Schedule>(plan->state());
  switch (schedule.phase) {
    case Phase::kSearch:
      return PlanTiles("search", SearchUs(schedule), schedule, schedule.split, plan);
    case Phase::kCertainty:
      PlanTiles("certainty", kCertaintyUs, schedule, 0, plan);
      return PlanExplaining(plan);
    case Phase::kBegin:
    case Phase::kWeigh:
    case Phase::kParameters:
      return PlanWeighing(schedule, plan);
  }
}

void ExpectRest(std::int64_t rounds, bool estimate, proto::Step* plan) {
  const Schedule schedule = ScalarsIn<Schedule>(plan->state());
  if (schedule.phase == Phase::kCertainty) return;
  const double crossings = CrossingsIn(plan->state());
  const auto tiles = static_cast<double>(plan->state().scalars().at(TilesKey(0)).i());
  const auto done = static_cast<double>(schedule.searches);
  if (done < 1) {  // the first search comes next, and takes the most
    ExpectRounds(1, kFirstSearchUs * crossings, tiles, plan);
    ExpectRounds(1, kWeighUs * crossings, 0, plan);
  }
  const double usual =
      std::max(done + (schedule.settled ? 0.5 : 1.0), tiles > 1 ? kUsualSearches : kUsualOfOne);
  const double searches = std::min(usual, static_cast<double>(rounds)) - std::max(1.0, done);
  double weighings =
      searches * (1 + (estimate ? kUsualSteps : 0)) + (schedule.phase == Phase::kSearch ? 1 : 0);
  if (estimate && done <= 1) weighings += kUsualFirstSteps - static_cast<double>(schedule.steps);
  ExpectRounds(searches, searches * kSearchUs * crossings, tiles, plan);
  weighings = std::max(0.0, weighings);
  ExpectRounds(weighings, weighings * kWeighUs * crossings, 0, plan);
  ExpectRounds(1, (kCertaintyUs + kExplainUs) * crossings, tiles, plan);
}

}  // namespace cairn::forward_map
