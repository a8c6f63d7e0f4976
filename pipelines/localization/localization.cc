#include "pipelines/localization/localization.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/task_builder.h"
#include "pipelines/localization/result.h"
#include "pipelines/localization/space.h"
#include "pipelines/localization/traverse.h"
#include "schema/error.h"

namespace cairn::localization {
namespace {

constexpr std::size_t kPositionsOfTask = 500, kTraversesOfTask = 4;

struct RowRange {
  std::size_t first, end;
};

// Microseconds of a core: a position of the map and a feature of it; a position of the belief at a stop of a
// traverse, a feature there, and to write that position down.
constexpr double kMapUs = 5, kMapFeatureUs = 0.1, kBelieveUs = 0.45, kSenseUs = 0.02, kKeptUs = 0.045;

double MapCost(const Source& source, std::size_t positions) {
  return static_cast<double>(positions) * (kMapUs + kMapFeatureUs * static_cast<double>(source.features()));
}

// Positions of the belief at all stops of a traverse.
double PositionsOfTraverse(const Options& options, const Source& source, std::size_t positions) {
  double travelled_m = options.travelled_m;
  if (travelled_m <= 0)
    for (const Run& run : source.runs)
      for (std::size_t k = 1; k < run.positions.size(); ++k)
        travelled_m +=
            DistanceM(run.positions[k - 1], run.positions[k]) / static_cast<double>(source.runs.size());
  return std::max(1.0, travelled_m / options.every_m) * static_cast<double>(positions);
}

double TraverseCost(const Options& options, const Source& source, std::size_t positions) {
  const double of_position = kBelieveUs + kSenseUs * static_cast<double>(source.features());
  return of_position * PositionsOfTraverse(options, source, positions);
}

// Of `count` things, which cost so much each.
void AddTasks(const char* kind, std::size_t count, std::size_t of_task, double each,
              const std::vector<const char*>& blobs, proto::Step* plan) {
  for (std::size_t first = 0; first < count; first += of_task) {
    const std::size_t end = std::min(count, first + of_task);
    TaskBuilder task(kind, each * static_cast<double>(end - first), plan);
    task.Set("first", first).Set("end", end);
    for (const char* name : blobs) task.Read(name);
  }
}

// Of so many that there are.
RowRange RowsOfTask(const Task& task, std::size_t count) {
  const std::int64_t end = IntegerOf(task, "end", 1, static_cast<std::int64_t>(count));
  return {static_cast<std::size_t>(IntegerOf(task, "first", 0, end - 1)), static_cast<std::size_t>(end)};
}

// Of all positions.
FeatureMap MapIn(const Inputs& inputs, std::size_t positions, std::size_t features) {
  FeatureMap map = Read<FeatureMap>(*inputs.Get("map"));
  RequireSize("probability", map.probability.size(), positions * features);
  RequireAllWithin("probability", map.probability, -1e-6, 1 + 1e-6);
  RequireSize("room", map.room.size(), positions);
  RequireAllWithin("room", map.room, 0.0, 1e300);
  return map;
}

Step Plan(const State& state) {
  Step step;
  *step.plan.mutable_state() = state;
  return step;
}

std::string Counted(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace

Step Localization::Start(const Inputs& inputs) const {
  const Source source = Source::Of(options_, inputs);
  const Poses poses = BeliefPositions(options_, source);
  Step step = Plan({});
  (*step.plan.mutable_state()->mutable_blobs())["source"] = step.Share(BlobOf(source));
  AddTasks("map", poses.positions.size(), kPositionsOfTask, MapCost(source, 1), {"source"}, &step.plan);
  const auto traverses = static_cast<double>(TraverseCount(options_, source));
  ExpectRounds(1, traverses * TraverseCost(options_, source, poses.positions.size()),
               std::ceil(traverses / kTraversesOfTask), &step.plan);
  step.plan.set_note(Counted(source.features(), "feature") + ", " +
                     Counted(poses.positions.size(), "position") + ", " + Counted(source.runs.size(), "run") +
                     " to localise in" + (source.headings() ? ", heading " + options_.heading : ""));
  return step;
}

Blob Localization::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  progress.Tick();
  RequireKind(task, {"map", "localize"});
  const Source source = Source::In(options_, inputs);
  const Poses poses = BeliefPositions(options_, source);
  if (task.kind() == "map") {
    const RowRange block = RowsOfTask(task, poses.positions.size());
    return BlobOf(MapOfBlock(options_, source, poses, block.first, block.end));
  }
  const RowRange range = RowsOfTask(task, TraverseCount(options_, source));
  const FeatureMap map = MapIn(inputs, poses.positions.size(), source.features());
  const BeliefSpace space(poses, map.room);
  const double least_sd_m = 0.5 * SpacingM(PositionIndex(poses.positions), poses);
  ResultRows rows;
  for (std::size_t number = range.first; number < range.end; ++number) {
    const Traverse traverse = MakeTraverse(options_, source, number, seed_);
    rows.Add(number, source, traverse,
             Localize(options_, source, space, map.probability, least_sd_m, traverse, Rng(seed_, number, 1),
                      progress));
  }
  return rows.ToBlob();
}

Step Localization::Advance(const State& state, Partials& partials, const Inputs& inputs) const {
  const Source source = Source::In(options_, inputs);
  const Poses poses = BeliefPositions(options_, source);
  if (!state.blobs().contains("map")) {
    FeatureMap map;
    for (std::size_t i = 0; i < partials.size(); ++i) map.Append(Read<FeatureMap>(*partials.Get(i)));
    Step step = Plan(state);
    (*step.plan.mutable_state()->mutable_blobs())["map"] = step.Share(BlobOf(map));
    AddTasks("localize", TraverseCount(options_, source), kTraversesOfTask,
             TraverseCost(options_, source, poses.positions.size()), {"source", "map"}, &step.plan);
    step.plan.set_advance_cost(kKeptUs * static_cast<double>(TraverseCount(options_, source)) *
                               PositionsOfTraverse(options_, source, poses.positions.size()));
    step.plan.set_note("the map of features is made");
    return step;
  }
  ResultRows rows;
  for (std::size_t i = 0; i < partials.size(); ++i) rows.Append(*partials.Get(i));
  Step step;
  step.plan.set_result(step.Share(ResultOf(options_, source, poses, rows)));
  step.plan.set_note(rows.Note());
  return step;
}

}  // namespace cairn::localization
