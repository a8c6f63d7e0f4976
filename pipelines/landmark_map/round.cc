#include "pipelines/landmark_map/round.h"

#include <algorithm>
#include <cmath>

#include "pipelines/landmark_map/work.h"

namespace cairn::landmark_map {
namespace {

constexpr std::int64_t kNone = -1;

// Calls f(name, field) for every figure of a robot's odometry.
template <class S, class F>
void VisitOdometry(S& fit, const F& f) {
  f("drift_rad_per_m", fit.drift_rad_per_m);
  f("heading_walk_rad_per_sqrt_m", fit.heading_walk_rad_per_sqrt_m);
  f("turn_ratio", fit.turn_ratio);
}

class RoundPlanner {
 public:
  RoundPlanner(const Options& options, const Schedule& schedule, const Carried& carried, proto::Step* plan)
      : options_(options), schedule_(schedule), carried_(carried), plan_(plan) {}

  void AddRobot(std::size_t robot, const std::string& name) {
    const int count = StepsInUse(schedule_, carried_.step_counts[robot]);
    const int slices = SlicesFor(carried_.work[robot], 1e6 * options_.slice_mcells, count);
    std::vector<std::int64_t> forward{kNone};  // [s]: the task that ends where slice s begins
    for (int s = 0; s + 1 < slices; ++s) {
      forward.push_back(AddTask("forward", robot, name, count, forward.back(), kNone));
    }
    std::int64_t beta = kNone;
    for (int s = slices - 1; s >= 0; --s) {
      beta = AddTask("backward", robot, name, count, forward[static_cast<std::size_t>(s)], beta);
    }
  }

 private:
  std::int64_t AddTask(const char* kind, std::size_t robot, const std::string& name, int count,
                       std::int64_t before, std::int64_t beta) {
    const std::int64_t index = plan_->tasks_size();
    Task& task = *plan_->add_tasks();
    task.set_index(static_cast<std::uint32_t>(index));
    task.set_kind(kind);
    task.set_cost(static_cast<std::uint64_t>(carried_.work[robot] / kStepCells));
    auto& params = *task.mutable_params();
    params["robot"].set_i(static_cast<std::int64_t>(robot));
    params["name"].set_s(name);
    params["count"].set_i(count);
    params["work"].set_d(1e6 * options_.slice_mcells);
    VisitOdometry(carried_.odometry[robot],
                  [&](const char* figure, double value) { params[figure].set_d(value); });
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

Blob StoredCounts(const LayeredGrid& counts) {
  Blob blob;
  counts.Store("counts/", &blob);
  return blob;
}

int StepsInUse(const Schedule& schedule, std::int64_t steps) {
  const double part = schedule.summarise ? 1.0 : schedule.prefix;
  return std::clamp(static_cast<int>(std::ceil(part * static_cast<double>(steps))), 1,
                    static_cast<int>(steps));
}

void Carried::Store(State* state) const {
  for (const auto& [name, hash] : blobs) (*state->mutable_blobs())[name] = hash;
  for (std::size_t r = 0; r < step_counts.size(); ++r) {
    const std::string number = std::to_string(r);
    (*state->mutable_scalars())["steps/" + number].set_i(step_counts[r]);
    (*state->mutable_scalars())["work/" + number].set_d(work[r]);
    VisitOdometry(odometry[r], [&](const char* name, double value) {
      (*state->mutable_scalars())[name + ("/" + number)].set_d(value);
    });
  }
}

Carried Carried::Load(const State& state, std::size_t robots) {
  Carried carried;
  carried.blobs["settings"] = state.blobs().at("settings");
  for (std::size_t r = 0; r < robots; ++r) {
    const std::string number = std::to_string(r);
    carried.blobs["steps/" + number] = state.blobs().at("steps/" + number);
    carried.step_counts.push_back(state.scalars().at("steps/" + number).i());
    carried.work.push_back(state.scalars().at("work/" + number).d());
    VisitOdometry(carried.odometry.emplace_back(), [&](const char* name, double& value) {
      value = state.scalars().at(name + ("/" + number)).d();
    });
  }
  return carried;
}

OdometryFit OdometryOf(const Task& task) {
  OdometryFit fit;
  VisitOdometry(fit, [&](const char* name, double& value) { value = task.params().at(name).d(); });
  return fit;
}

void PlanRound(const Options& options, const std::vector<std::string>& robots, const Schedule& schedule,
               const Carried& carried, const std::map<std::string, Blob>& fresh, cairn::Step* step) {
  State& state = *step->plan.mutable_state();
  schedule.Store(&state);
  carried.Store(&state);
  for (const auto& [name, blob] : fresh) (*state.mutable_blobs())[name] = step->Share(blob);
  PlanTasks(options, robots, &step->plan);
}

void PlanTasks(const Options& options, const std::vector<std::string>& robots, proto::Step* plan) {
  const Schedule schedule = Schedule::Load(plan->state());
  const Carried carried = Carried::Load(plan->state(), robots.size());
  RoundPlanner planner(options, schedule, carried, plan);
  for (std::int64_t r = 0; r < schedule.robots; ++r) {
    planner.AddRobot(static_cast<std::size_t>(r), robots[static_cast<std::size_t>(r)]);
  }
  plan->set_rounds_left(
      static_cast<std::uint32_t>(schedule.RoundsLeft(options, static_cast<std::int64_t>(robots.size()))));
}

}  // namespace cairn::landmark_map
