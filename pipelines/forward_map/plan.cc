#include "pipelines/forward_map/plan.h"

#include <algorithm>

namespace cairn::forward_map {
namespace {

std::int64_t SensorsIn(const State& state) { return state.scalars().at(kSensors).i(); }

Task& AddTask(const char* kind, proto::Step* plan) {
  Task& task = *plan->add_tasks();
  task.set_index(static_cast<std::uint32_t>(plan->tasks_size() - 1));
  task.set_kind(kind);
  task.set_cost(1);
  return task;
}

void SetParam(Task& task, const char* name, std::int64_t value) {
  (*task.mutable_params())[name].set_i(value);
}

proto::InputRef& AddInput(const std::string& name, const std::string& as, const State& state, Task& task) {
  proto::InputRef& input = *task.add_inputs();
  input.set_name(as);
  input.set_blob(state.blobs().at(name));
  return input;
}

void AddAllScans(std::int64_t sensors, const State& state, Task& task) {
  SetParam(task, kSensors, sensors);
  AddInput(kLogBlob, kLogBlob, state, task);
  for (std::int64_t k = 0; k < sensors; ++k) {
    AddInput(SensorBlobName(k), SensorBlobName(k), state, task);
    AddInput(ScansBlobName(k), ScansBlobName(k), state, task);
  }
}

// Each tile of a split, with all scans.
void PlanTiles(const char* kind, const Schedule& schedule, std::int64_t split, proto::Step* plan) {
  for (std::int64_t tile = 0; tile < plan->state().scalars().at(TilesKey(split)).i(); ++tile) {
    Task& task = AddTask(kind, plan);
    SetParam(task, "tile", tile);
    SetParam(task, "searches", schedule.searches);
    AddInput(kMapBlob, kMapBlob, plan->state(), task);
    AddInput(TilesBlob(split), "tiles", plan->state(), task);
    AddAllScans(SensorsIn(plan->state()), plan->state(), task);
  }
}

void PlanWeighing(const Schedule& schedule, proto::Step* plan) {
  const State& state = plan->state();
  for (std::int64_t k = 0; k < SensorsIn(plan->state()); ++k) {
    const std::int64_t scans = state.scalars().at(ScansKey(k)).i();
    const std::int64_t of_slice = state.scalars().at(SliceKey(k)).i();
    for (std::int64_t first = 0; first < scans; first += of_slice) {
      Task& task = AddTask("weigh", plan);
      SetParam(task, "sensor", k);
      SetParam(task, "taken", schedule.taken);
      AddInput(kMapBlob, kMapBlob, state, task);
      if (schedule.taken > 0) AddInput(kProposalsBlob, kProposalsBlob, state, task);
      AddInput(kLogBlob, kLogBlob, state, task);
      AddInput(SensorBlobName(k), "sensor", state, task);
      proto::InputRef& rows = AddInput(ScansBlobName(k), "scans", state, task);
      rows.set_first_row(first);
      rows.set_row_count(std::min(of_slice, scans - first));
    }
  }
}

void PlanExplaining(proto::Step* plan) {
  for (std::int64_t k = 0; k < SensorsIn(plan->state()); ++k) {
    Task& task = AddTask("explain", plan);
    SetParam(task, "sensor", k);
    AddInput(kMapBlob, kMapBlob, plan->state(), task);
    AddInput(kLogBlob, kLogBlob, plan->state(), task);
    AddInput(SensorBlobName(k), "sensor", plan->state(), task);
    AddInput(ScansBlobName(k), "scans", plan->state(), task);
  }
}

}  // namespace

std::string TilesKey(std::int64_t split) { return "tiles/" + std::to_string(split); }
std::string ScansKey(std::int64_t sensor) { return "scans/" + std::to_string(sensor); }
std::string SliceKey(std::int64_t sensor) { return "slice/" + std::to_string(sensor); }
std::string TilesBlob(std::int64_t split) { return "tiles/" + std::to_string(split); }
std::string SensorBlobName(std::int64_t sensor) { return "sensor/" + std::to_string(sensor); }
std::string ScansBlobName(std::int64_t sensor) { return "scans/" + std::to_string(sensor); }

void Schedule::Store(State* state) const {
  auto& scalars = *state->mutable_scalars();
  scalars["phase"].set_i(static_cast<std::int64_t>(phase));
  scalars["searches"].set_i(searches);
  scalars["split"].set_i(split);
  scalars["quiet"].set_i(quiet);
  scalars["taken"].set_i(taken);
  scalars["steps"].set_i(steps);
  scalars["target_nats"].set_d(target_nats);
  scalars["begun_nats"].set_d(begun_nats);
  scalars["settled"].set_b(settled);
  scalars["cut_short"].set_b(cut_short);
}

Schedule Schedule::Load(const State& state) {
  const auto& scalars = state.scalars();
  return {.phase = static_cast<Phase>(scalars.at("phase").i()),
          .searches = scalars.at("searches").i(),
          .split = scalars.at("split").i(),
          .quiet = scalars.at("quiet").i(),
          .taken = scalars.at("taken").i(),
          .steps = scalars.at("steps").i(),
          .settled = scalars.at("settled").b(),
          .cut_short = scalars.at("cut_short").b(),
          .target_nats = scalars.at("target_nats").d(),
          .begun_nats = scalars.at("begun_nats").d()};
}

void PlanTasks(proto::Step* plan) {
  plan->clear_tasks();
  const Schedule schedule = Schedule::Load(plan->state());
  switch (schedule.phase) {
    case Phase::kSearch:
      return PlanTiles("search", schedule, schedule.split, plan);
    case Phase::kCertainty:
      PlanTiles("certainty", schedule, 0, plan);
      return PlanExplaining(plan);
    case Phase::kBegin:
    case Phase::kWeigh:
    case Phase::kParameters:
      return PlanWeighing(schedule, plan);
  }
}

}  // namespace cairn::forward_map
