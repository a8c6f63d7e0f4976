#include "pipelines/localization/localization.h"

#include <algorithm>
#include <cstdio>

#include "pipelines/localization/result.h"
#include "pipelines/localization/space.h"
#include "pipelines/localization/traverse.h"
#include "schema/error.h"

namespace cairn::localization {
namespace {

constexpr std::size_t kPlacesOfTask = 500, kTraversesOfTask = 4;

struct Range {
  std::size_t first, end;
};

// A State's task of `kind` that reads the named blobs of it.
void AddTask(const char* kind, const Range& range, const std::vector<const char*>& blobs, proto::Step* plan) {
  Task& task = *plan->add_tasks();
  task.set_index(static_cast<std::uint32_t>(plan->tasks_size() - 1));
  task.set_kind(kind);
  task.set_cost(range.end - range.first);
  (*task.mutable_params())["first"].set_i(static_cast<std::int64_t>(range.first));
  (*task.mutable_params())["end"].set_i(static_cast<std::int64_t>(range.end));
  for (const char* name : blobs) {
    proto::InputRef& input = *task.add_inputs();
    input.set_name(name);
    input.set_blob(plan->state().blobs().at(name));
  }
}

void AddTasks(const char* kind, std::size_t count, std::size_t of_task, const std::vector<const char*>& blobs,
              proto::Step* plan) {
  for (std::size_t first = 0; first < count; first += of_task)
    AddTask(kind, {first, std::min(count, first + of_task)}, blobs, plan);
}

Range RangeOf(const Task& task) {
  return {static_cast<std::size_t>(task.params().at("first").i()),
          static_cast<std::size_t>(task.params().at("end").i())};
}

Step Plan(const State& state, std::uint32_t rounds_left) {
  Step step;
  *step.plan.mutable_state() = state;
  step.plan.set_rounds_left(rounds_left);
  return step;
}

std::string Counted(std::size_t count, const char* what) { return std::to_string(count) + " " + what; }

}  // namespace

Step Localization::Start(const Inputs& inputs) const {
  const Source source = Source::Of(options_, inputs);
  const Poses poses = BeliefPlaces(options_, source);
  Step step = Plan({}, 2);
  (*step.plan.mutable_state()->mutable_blobs())["source"] = step.Share(source.ToBlob());
  AddTasks("map", poses.places.size(), kPlacesOfTask, {"source"}, &step.plan);
  step.plan.set_note(Counted(source.features(), "features, ") + Counted(poses.places.size(), "places, ") +
                     Counted(source.runs.size(), "runs to localise in") +
                     (source.headings() ? ", heading " + options_.heading : ""));
  return step;
}

Blob Localization::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  progress.Tick();
  const Source source = Source::FromBlob(*inputs.Get("source"));
  const Poses poses = BeliefPlaces(options_, source);
  const Range range = RangeOf(task);
  if (task.kind() == "map") return MapOfBlock(options_, source, poses, range.first, range.end).ToBlob();
  const FeatureMap map = FeatureMap::FromBlob(*inputs.Get("map"));
  const BeliefSpace space(poses, map.room);
  const double least_sd_m = 0.5 * SpacingM(PlaceIndex(poses.places), poses);
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
  const Source source = Source::FromBlob(*inputs.Get("source"));
  const Poses poses = BeliefPlaces(options_, source);
  if (!state.blobs().contains("map")) {
    FeatureMap map;
    for (std::size_t i = 0; i < partials.size(); ++i) map.Append(FeatureMap::FromBlob(*partials.Get(i)));
    Step step = Plan(state, 1);
    (*step.plan.mutable_state()->mutable_blobs())["map"] = step.Share(map.ToBlob());
    AddTasks("localize", TraverseCount(options_, source), kTraversesOfTask, {"source", "map"}, &step.plan);
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
