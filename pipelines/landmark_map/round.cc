#include "pipelines/landmark_map/round.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/state_scalars.h"
#include "pipelines/common/task_builder.h"
#include "pipelines/landmark_map/m_step_task.h"
#include "pipelines/landmark_map/model/work.h"
#include "pipelines/landmark_map/outlook.h"
#include "pipelines/landmark_map/state/speculation.h"

namespace cairn::landmark_map {
namespace {

constexpr std::int64_t kNone = -1;

// State scalar, text: a letter a slice of a robot, g where it is guessed; none where all are in order and end
// where their work does.
constexpr const char* kGuessed = "guessed/";
constexpr char kIsGuessed = 'g';

std::string SlicesGuessed(const State& state, std::size_t robot) {
  const auto slices = state.scalars().find(kGuessed + std::to_string(robot));
  return slices == state.scalars().end() ? "" : slices->second.s();
}

class RoundPlanner {
 public:
  RoundPlanner(const Options& options, const Schedule& schedule, const RobotStates& robot_states,
               proto::Step* plan)
      : options_(options), schedule_(schedule), robot_states_(robot_states), plan_(plan) {}

  void AddRobot(std::size_t robot, const std::string& name) {
    const int count = StepsInUse(schedule_, robot_states_.step_counts[robot]);
    const RobotChain chain{robot, name, count, SlicesGuessed(plan_->state(), robot)};
    if (options_.incremental) {
      AddTask("incremental", chain, 0, kNone, kNone, kNone);
      return;
    }
    const int slices = chain.guessed.empty()
                           ? SlicesFor(robot_states_.work[robot], 1e6 * options_.slice_mcells, count)
                           : static_cast<int>(chain.guessed.size());
    RequireWithin("the slices of a robot", std::int64_t{slices}, 1, kMostTasks);
    std::vector<std::int64_t> guess(static_cast<std::size_t>(slices), kNone);
    for (std::size_t s = 0; s < chain.guessed.size(); ++s) {
      if (chain.guessed[s] == kIsGuessed)
        guess[s] = AddTask("guess", chain, static_cast<int>(s), kNone, kNone, kNone);
    }
    std::vector<std::int64_t> forward{kNone};  // [s]: the task that ends where slice s begins
    for (int s = 0; s + 1 < slices; ++s) {
      forward.push_back(
          AddTask("forward", chain, s, forward.back(), kNone, guess[static_cast<std::size_t>(s)]));
    }
    std::int64_t beta = kNone;
    for (int s = slices - 1; s >= 0; --s) {
      const auto at = static_cast<std::size_t>(s);
      beta = AddTask("backward", chain, s, forward[at], beta, guess[at]);
      backward_.push_back(beta);
      robot_of_.push_back(robot);
      bytes_.push_back(sizeof(double) * robot_states_.work[robot] / count);
    }
  }

  // From the partials of all robots' `backward` tasks, in their order.
  void AddMStep(std::size_t robots) { AddMapOf(backward_, bytes_, robots); }

  // The maps that follow without one robot each, of all but the first, whose place is the frame's.
  void AddMapsWithout(std::size_t robots) {
    for (std::size_t without = 1; without < robots; ++without) {
      std::vector<std::int64_t> backward;
      std::vector<double> bytes;
      for (std::size_t i = 0; i < backward_.size(); ++i) {
        if (robot_of_[i] == without) continue;
        backward.push_back(backward_[i]);
        bytes.push_back(bytes_[i]);
      }
      (*plan_->mutable_state()->mutable_scalars())[TaskWithout(without)].set_i(
          AddMapOf(backward, bytes, robots));
    }
  }

 private:
  struct RobotChain {
    std::size_t robot;
    const std::string& name;
    int count;
    std::string guessed;
  };

  // Where the partials are large tasks `sum` add them up as they come, each a few more to what the one before
  // it has.
  std::int64_t AddMapOf(const std::vector<std::int64_t>& backward, const std::vector<double>& of_bytes,
                        std::size_t robots) {
    std::int64_t sum = kNone;
    std::size_t begin = 0;
    double bytes = 0.0;
    for (std::size_t i = 0; i < backward.size(); ++i) {
      if (i > begin && bytes + of_bytes[i] > kSumBytes) {
        sum = AddSum("sum", kSumUs, robots, sum, std::span(backward).subspan(begin, i - begin));
        begin = i;
        bytes = 0.0;
      }
      bytes += of_bytes[i];
    }
    return AddSum("m_step", kMStepUs, robots, sum, std::span(backward).subspan(begin));
  }

  std::int64_t AddTask(const char* kind, const RobotChain& chain, int slice, std::int64_t before,
                       std::int64_t beta, std::int64_t guess) {
    TaskBuilder task(kind, UsOf(kind, chain, slice), plan_);
    task.Set("robot", chain.robot).Set("name", chain.name).Set("count", chain.count);
    task.Set("work", 1e6 * options_.slice_mcells)
        .Set("overlap", robot_states_.overlap[chain.robot])
        .Set("slice", slice);
    OdometryFit::Fields([&](const Field& figure, const auto& member) {
      task.Set(std::string(figure.name), robot_states_.odometry[chain.robot].*member);
    });
    task.Set("summarise", schedule_.summarises()).Set("joint", schedule_.robots > 1);
    task.Set("warm", LeavesTables(options_, schedule_));
    task.Read("settings").Read("steps", "steps/" + std::to_string(chain.robot));
    const std::string own = PerceptionFor(chain.robot);
    if (plan_->state().blobs().contains(own))
      task.Read("perception", own);
    else if (plan_->state().blobs().contains("perception"))
      task.Read("perception");
    if (schedule_.summarises()) task.Read("landmarks");
    if (!chain.guessed.empty()) task.Read("guesses", kGuesses + std::to_string(chain.robot));
    const std::string start = StartNear(chain.robot);
    if (before == kNone && plan_->state().blobs().contains(start)) task.Read("start", start);
    if (before != kNone) task.ReadPartial("before", before);
    if (beta != kNone) task.ReadPartial("beta", beta);
    if (guess != kNone) task.ReadPartial("guess", guess);
    return task.index();
  }

  std::int64_t AddSum(const char* kind, double cost_us, std::size_t robots, std::int64_t before,
                      std::span<const std::int64_t> partials) {
    TaskBuilder task(kind, cost_us, plan_);
    task.Set("robots", robots).Read("settings");
    if (before != kNone) task.ReadPartial("sum", before);
    for (std::size_t i = 0; i < partials.size(); ++i) task.ReadPartial(PartialInput(i), partials[i]);
    return task.index();
  }

  // Slices are filled one after the other: of those in reserve nothing is expected.
  double UsOf(const std::string& kind, const RobotChain& chain, int slice) const {
    const double slice_cells = 1e6 * options_.slice_mcells, cells = robot_states_.work[chain.robot];
    const double here =
        kind == "incremental" ? cells : std::clamp(cells - slice * slice_cells, 0.0, slice_cells);
    const bool map = plan_->state().blobs().contains("perception");
    return here * (kind == "backward" ? kBackwardUs : kForwardUs) * (map ? 1.0 : kWithoutMap);
  }

  const Options& options_;
  const Schedule& schedule_;
  const RobotStates& robot_states_;
  proto::Step* plan_;
  std::vector<std::int64_t> backward_;  // tasks
  std::vector<std::size_t> robot_of_;   // theirs
  std::vector<double> bytes_;           // of their partials, some: a belief's of the robot
};

}  // namespace

std::string TaskWithout(std::size_t robot) { return "task_without/" + std::to_string(robot); }
std::string StartNear(std::size_t robot) { return "near/" + std::to_string(robot); }
std::string PerceptionFor(std::size_t robot) { return "perception_for/" + std::to_string(robot); }

Blob StoredCounts(const LayeredGrid& counts) {
  Blob blob;
  counts.Store("counts/", &blob);
  return blob;
}

int StepsInUse(const Schedule& schedule, std::int64_t steps) {
  const double part = schedule.summarises() ? 1.0 : schedule.prefix;
  return std::clamp(static_cast<int>(std::ceil(part * static_cast<double>(steps))), 1,
                    static_cast<int>(steps));
}

void RobotStates::Store(State* state) const {
  for (const auto& [name, hash] : blobs) (*state->mutable_blobs())[name] = hash;
  for (std::size_t r = 0; r < step_counts.size(); ++r) {
    const std::string number = std::to_string(r);
    (*state->mutable_scalars())["steps/" + number].set_i(step_counts[r]);
    (*state->mutable_scalars())["work/" + number].set_d(work[r]);
    (*state->mutable_scalars())["sharp/" + number].set_d(sharp[r]);
    (*state->mutable_scalars())["overlap/" + number].set_i(overlap[r]);
    (*state->mutable_scalars())["refined_rows/" + number].set_d(refined_rows[r]);
    PutScalars(odometry[r], "/" + number, state);
  }
  (*state->mutable_scalars())["landmarks"].set_i(landmarks);
}

RobotStates RobotStates::Load(const State& state, std::size_t robots) {
  RobotStates robot_states;
  robot_states.blobs["settings"] = state.blobs().at("settings");
  for (std::size_t r = 0; r < robots; ++r) {
    const std::string number = std::to_string(r);
    robot_states.blobs["steps/" + number] = state.blobs().at("steps/" + number);
    robot_states.step_counts.push_back(state.scalars().at("steps/" + number).i());
    robot_states.work.push_back(state.scalars().at("work/" + number).d());
    robot_states.sharp.push_back(state.scalars().at("sharp/" + number).d());
    robot_states.overlap.push_back(state.scalars().at("overlap/" + number).i());
    robot_states.refined_rows.push_back(state.scalars().at("refined_rows/" + number).d());
    robot_states.odometry.push_back(ScalarsIn<OdometryFit>(state, "/" + number));
    robot_states.odometry.back().Check();
  }
  robot_states.landmarks = state.scalars().at("landmarks").i();
  RequireWithin("the number of landmarks", robot_states.landmarks, 0, kMostSteps);
  RequireAllWithin("the steps of a robot", robot_states.step_counts, std::int64_t{1}, kMostSteps);
  RequireAllWithin("the overlap of guesses", robot_states.overlap, std::int64_t{0}, kMostSteps);
  for (const std::vector<double>* work :
       {&robot_states.work, &robot_states.sharp, &robot_states.refined_rows})
    RequireAllWithin("the work of a robot", *work, 0.0, kMostWork);
  return robot_states;
}

bool LeavesTables(const Options& options, const Schedule& schedule) {
  const bool last =
      schedule.is_refined() || (schedule.summarises() && (!options.refine || options.iterations == 0));
  return options.speculate && !last && schedule.prefix >= 1.0 && schedule.settled + 1 >= kSharpAfter;
}

OdometryFit OdometryOf(const Task& task) {
  OdometryFit fit;
  OdometryFit::Fields([&](const Field& figure, const auto& member) {
    fit.*member = task.params().at(std::string(figure.name)).d();
  });
  fit.Check();
  return fit;
}

void PlanRound(const Options& options, const std::vector<std::string>& robots, const Schedule& schedule,
               const RobotStates& robot_states, const std::map<std::string, Blob>& fresh, cairn::Step* step) {
  State& state = *step->plan.mutable_state();
  schedule.Store(&state);
  robot_states.Store(&state);
  for (const auto& [name, blob] : fresh) (*state.mutable_blobs())[name] = step->Share(blob);
  PlanTasks(options, robots, &step->plan);
}

void GuessSlices(std::size_t robot, const std::vector<bool>& which, State* state) {
  std::string letters;
  for (const bool guessed : which) letters += guessed ? kIsGuessed : '-';
  (*state->mutable_scalars())[kGuessed + std::to_string(robot)].set_s(letters);
}

void GuessNothing(State* state) {
  for (std::size_t r = 0; state->scalars().contains("steps/" + std::to_string(r)); ++r) {
    state->mutable_scalars()->erase(kGuessed + std::to_string(r));
    state->mutable_blobs()->erase(kGuesses + std::to_string(r));
  }
}

void PlanTasks(const Options& options, const std::vector<std::string>& robots, proto::Step* plan) {
  const Schedule schedule = Schedule::Load(plan->state(), robots.size());
  const RobotStates robot_states = RobotStates::Load(plan->state(), robots.size());
  RoundPlanner planner(options, schedule, robot_states, plan);
  for (std::int64_t r = 0; r < schedule.robots; ++r) {
    planner.AddRobot(static_cast<std::size_t>(r), robots[static_cast<std::size_t>(r)]);
  }
  if (schedule.comes_before_apart()) planner.AddMapsWithout(robots.size());
  if (!schedule.summarises()) planner.AddMStep(robots.size());
  ExpectEm(options, schedule, robot_states, plan);
}

}  // namespace cairn::landmark_map
