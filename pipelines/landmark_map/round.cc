#include "pipelines/landmark_map/round.h"

#include <algorithm>
#include <cmath>

namespace cairn::landmark_map {
namespace {

constexpr std::int64_t kNone = -1;

class RoundPlanner {
 public:
  RoundPlanner(const Options& options, const Schedule& schedule, const Carried& carried, proto::Step* plan)
      : options_(options), schedule_(schedule), carried_(carried), plan_(plan) {}

  void AddRobot(std::size_t robot, const std::string& name) {
    const auto steps = static_cast<int>(carried_.step_counts[robot]);
    const double part = schedule_.summarise ? 1.0 : schedule_.prefix;
    const int count = std::clamp(static_cast<int>(std::ceil(part * steps)), 1, steps);
    const int slices = static_cast<int>((count + options_.slice_steps - 1) / options_.slice_steps);
    const auto begin = [&](int slice) { return static_cast<int>(std::int64_t{count} * slice / slices); };
    std::vector<std::int64_t> forward{kNone};  // [s]: the task that ends where slice s begins
    for (int s = 0; s + 1 < slices; ++s) {
      forward.push_back(AddTask("forward", robot, name, begin(s), begin(s + 1), forward.back(), kNone));
    }
    std::int64_t beta = kNone;
    for (int s = slices - 1; s >= 0; --s) {
      const std::int64_t before = forward[static_cast<std::size_t>(s)];
      beta = AddTask("backward", robot, name, begin(s), begin(s + 1), before, beta);
    }
  }

 private:
  std::int64_t AddTask(const char* kind, std::size_t robot, const std::string& name, int first, int end,
                       std::int64_t before, std::int64_t beta) {
    const std::int64_t index = plan_->tasks_size();
    Task& task = *plan_->add_tasks();
    task.set_index(static_cast<std::uint32_t>(index));
    task.set_kind(kind);
    task.set_cost(static_cast<std::uint64_t>(end - first));
    auto& params = *task.mutable_params();
    params["robot"].set_i(static_cast<std::int64_t>(robot));
    params["name"].set_s(name);
    params["first"].set_i(first);
    params["end"].set_i(end);
    params["drift_rad_per_m"].set_d(carried_.drift_rad_per_m[robot]);
    params["summarise"].set_b(schedule_.summarise);
    AddBlob("settings", "settings", &task);
    AddBlob("steps", "steps/" + std::to_string(robot), &task);
    if (plan_->state().blobs().contains("perception")) AddBlob("perception", "perception", &task);
    if (schedule_.summarise) AddBlob("landmarks", "landmarks", &task);
    if (before != kNone) AddPartial("before", before, &task);
    if (beta != kNone) AddPartial("beta", beta, &task);
    return index;
  }

  void AddBlob(const char* name, const std::string& key, Task* task) {
    proto::InputRef& input = *task->add_inputs();
    input.set_name(name);
    input.set_blob(plan_->state().blobs().at(key));
  }

  static void AddPartial(const char* name, std::int64_t index, Task* task) {
    proto::InputRef& input = *task->add_inputs();
    input.set_name(name);
    input.set_task(static_cast<std::uint32_t>(index));
  }

  const Options& options_;
  const Schedule& schedule_;
  const Carried& carried_;
  proto::Step* plan_;
};

}  // namespace

void Carried::Store(State* state) const {
  for (const auto& [name, hash] : blobs) (*state->mutable_blobs())[name] = hash;
  for (std::size_t r = 0; r < step_counts.size(); ++r) {
    const std::string number = std::to_string(r);
    (*state->mutable_scalars())["steps/" + number].set_i(step_counts[r]);
    (*state->mutable_scalars())["drift_rad_per_m/" + number].set_d(drift_rad_per_m[r]);
  }
}

Carried Carried::Load(const State& state, std::size_t robots) {
  Carried carried;
  carried.blobs["settings"] = state.blobs().at("settings");
  for (std::size_t r = 0; r < robots; ++r) {
    const std::string number = std::to_string(r);
    carried.blobs["steps/" + number] = state.blobs().at("steps/" + number);
    carried.step_counts.push_back(state.scalars().at("steps/" + number).i());
    carried.drift_rad_per_m.push_back(state.scalars().at("drift_rad_per_m/" + number).d());
  }
  return carried;
}

void PlanRound(const Options& options, const std::vector<std::string>& robots, const Schedule& schedule,
               const Carried& carried, const std::map<std::string, Blob>& fresh, cairn::Step* step) {
  State& state = *step->plan.mutable_state();
  schedule.Store(&state);
  carried.Store(&state);
  for (const auto& [name, blob] : fresh) (*state.mutable_blobs())[name] = step->Share(blob);
  RoundPlanner planner(options, schedule, carried, &step->plan);
  for (std::int64_t r = 0; r < schedule.robots; ++r) {
    planner.AddRobot(static_cast<std::size_t>(r), robots[static_cast<std::size_t>(r)]);
  }
  step->plan.set_rounds_left(
      static_cast<std::uint32_t>(schedule.RoundsLeft(options, static_cast<std::int64_t>(robots.size()))));
}

}  // namespace cairn::landmark_map
