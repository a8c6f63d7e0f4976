#include "pipelines/landmark_map/outlook.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "pipelines/common/handed_over.h"
#include "pipelines/landmark_map/initial_state.h"

namespace cairn::landmark_map {
namespace {

// What is usual: iterations on all data of the first robot and of all, of a refit; maps that are refined.
constexpr std::int64_t kIterationsToCome = 5, kJoinedToCome = 5, kAfterApart = 3;
constexpr double kRefitIterations = 4.0, kFinerIterations = 4.0, kRefined = 0.7;
constexpr const char* kCost = "cost";

// How much of what is usual there may be, at least and at most: of a search's iterations, of those on all
// data that follow it, of all robots' once the first one's map is known.
struct Spread {
  double least = 1.0, most = 1.0;
};
constexpr Spread kOfIterations{0.5, 3.0}, kOfLast{0.5, 5.0}, kOfRobots{0.5, 4.0};
// The same of a least squares over observations at a distance: nobody knows its steps before.
constexpr Spread kOfRefinement{0.5, 1.7};

// What a step of a robot takes in E-steps to come: beliefs get narrower from one to the next while the map
// gets sharper, down to what they are in a sharp one. But a robot that may start anywhere looks for itself in
// the whole map each time.
class StepCost {
 public:
  StepCost(const Options& options, const RobotStates& robot_states, const Schedule& now) {
    for (std::size_t r = 0; r < robot_states.work.size(); ++r) {
      const bool joined = r < static_cast<std::size_t>(now.robots);
      const auto steps = static_cast<double>(joined ? StepsInUse(now, robot_states.step_counts[r])
                                                    : robot_states.step_counts[r]);
      us_.push_back(kBackwardUs * robot_states.work[r] / steps);
      nearby_us_.push_back(kBackwardUs * robot_states.sharp[r]);
      sharp_us_.push_back(StartsAnywhere(options, r) ? us_[r]
                                                     : std::min(us_[r], kBackwardUs * robot_states.sharp[r]));
    }
  }
  // In an E-step of such a schedule.
  double Of(const Schedule& schedule, std::size_t robot) const {
    return schedule.StartsNearby(robot) ? std::min(us_[robot], nearby_us_[robot]) : us_[robot];
  }
  void Next(bool all_sharp) {
    constexpr double kNarrower = 0.5;
    for (std::size_t r = 0; r < us_.size(); ++r)
      us_[r] = all_sharp ? sharp_us_[r] : std::max(sharp_us_[r], kNarrower * us_[r]);
  }

 private:
  std::vector<double> us_, sharp_us_, nearby_us_;
};

double CostOf(const Schedule& schedule, const StepCost& step_us, const RobotStates& robot_states) {
  double cost = schedule.summarises() ? 0.0 : kMStepUs;
  for (std::size_t r = 0; r < static_cast<std::size_t>(schedule.robots); ++r)
    cost += step_us.Of(schedule, r) * StepsInUse(schedule, robot_states.step_counts[r]);
  return cost;
}

double SumOf(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

// Of observations at a distance the least squares ends the job, of contact detections an E-step follows it.
bool RefinesAtADistance(const RobotStates& robot_states) { return SumOf(robot_states.refined_rows) > 0.0; }

double RefinementCost(const RobotStates& robot_states) {
  const auto landmarks = static_cast<double>(robot_states.landmarks);
  if (RefinesAtADistance(robot_states))
    return SumOf(robot_states.refined_rows) * (kRefinedRowUs + kRefinedRowAndLandmarkUs * landmarks);
  const auto& counts = robot_states.step_counts;
  return kRefinementUs * static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}));
}

struct Sum {
  double rounds = 0.0, cost = 0.0;
  double refinement = 0.0;  // at a distance: it takes one worker, however many robots there are
  void Add(double more_rounds, double more_cost) {
    rounds += more_rounds;
    cost += more_cost;
  }
};

std::int64_t ScalarOf(const State& state, const char* name) {
  const auto value = state.scalars().find(name);
  return value == state.scalars().end() ? 0 : value->second.i();
}

// What an EM says of the rounds after the first robot's.
Sum LastOf(const google::protobuf::RepeatedPtrField<proto::Phase>& later) {
  Sum last;
  for (const proto::Phase& phase : later) {
    if (phase.rounds() > 0.0)
      last = {phase.rounds(), phase.cost()};
    else
      last.refinement = phase.cost();
  }
  return last;
}

// From the first robot's last iteration on, that E-step included.
Sum AfterSearch(const Options& options, const Schedule& now, const State& state) {
  std::size_t robots = 0;
  while (state.scalars().contains("work/" + std::to_string(robots))) ++robots;
  RequireWithin("the number of robots", now.robots, 1, static_cast<std::int64_t>(robots));
  const RobotStates robot_states = RobotStates::Load(state, robots);
  proto::Step rest;
  ExpectEm(options, now, robot_states, &rest);
  const Sum later = LastOf(rest.later());
  return {1.0 + later.rounds, CostOf(now, StepCost(options, robot_states, now), robot_states) + later.cost,
          rest.advance_cost() + later.refinement};
}

// In the ADVANCE of the summary, whose cost is the least of it: what more it may take, and before the summary
// all of it, is a phase without a round of its own.
void ExpectRefinement(double cost, bool is_due, proto::Step* plan) {
  if (!(cost > 0.0)) return;
  const double least = is_due ? kOfRefinement.least * cost : 0.0, rest = cost - least;
  if (is_due) plan->set_advance_cost(least);
  proto::Phase& phase = *plan->add_later();
  phase.set_cost(rest);
  phase.set_width(1.0);
  phase.set_least((kOfRefinement.least * cost - least) / rest);
  phase.set_most((kOfRefinement.most * cost - least) / rest);
}

double RefinedBy(const State& state) {
  const auto finer = state.scalars().find(kFiner);
  return finer == state.scalars().end() ? 0.0 : finer->second.d();
}

// Candidates that the search is expected to begin after those that there are: starts near the best one,
// starts further out, refits.
struct NewCandidates {
  double waves = 0.0, near = 0.0, beyond = 0.0, refits = 0.0;
  Spread range;
};

// The first wave comes always; how often others do is what simulated loops show. At most it is a wave and a
// half more.
NewCandidates Usual(const Options& options, const std::vector<cairn::Step>& steps) {
  std::int64_t waves = 0, beyond = 0;
  for (const cairn::Step& step : steps) {
    const State& state = step.plan.state();
    if (ScalarOf(state, kWave) < waves) continue;
    if (ScalarOf(state, kWave) > waves) beyond = 0;
    waves = ScalarOf(state, kWave);
    beyond = std::max(beyond, ScalarOf(state, kBeyond));
  }
  if (waves >= options.waves) return {};
  if (waves == 0) return {1.1, 3.0, 0.0, 8.0, {0.5, 3.0}};
  if (beyond > 0) return {0.1, 0.0, 0.1 * static_cast<double>(beyond), 0.0, {0.0, 15.0}};
  return {0.05, 0.15, 0.0, 0.4, {0.0, 30.0}};
}

// Starts near the best map lose the robot less than the others do.
double CostNear(std::vector<double> costs) {
  std::ranges::sort(costs);
  const std::size_t half = (costs.size() + 1) / 2;
  return half == 0 ? 0.0
                   : std::accumulate(costs.begin(), costs.begin() + static_cast<std::ptrdiff_t>(half), 0.0) /
                         static_cast<double>(half);
}

double Mean(const std::vector<double>& costs) {
  return costs.empty() ? 0.0
                       : std::accumulate(costs.begin(), costs.end(), 0.0) / static_cast<double>(costs.size());
}

}  // namespace

double RefinedRows(const kinds::Log::Observations& seen) {
  const auto range_m = seen.range_m.OrNone();
  const auto landmark = seen.landmark.OrNone();
  double rows = 0.0;
  for (std::size_t i = 0; i < range_m.size(); ++i) {
    if (std::isnan(range_m[i])) continue;
    rows += landmark[i] >= 0 ? 1.0 : 2.0;
  }
  return rows;
}

double CostSoFar(const State& state) {
  const auto cost = state.scalars().find(kCost);
  return cost == state.scalars().end() ? 0.0 : cost->second.d();
}

void ExpectEm(const Options& options, const Schedule& now, const RobotStates& robot_states,
              proto::Step* plan) {
  const auto robots = static_cast<std::int64_t>(robot_states.step_counts.size());
  StepCost step_us(options, robot_states, now);
  Sum alone, all;
  for (Schedule s = now; !s.summarises();) {
    Options usual = options;
    const std::int64_t joined_to_come = s.apart > 0 ? s.apart + kAfterApart : kJoinedToCome;
    const std::int64_t iterations = s.robots < robots || robots == 1 ? kIterationsToCome : joined_to_come;
    usual.iterations = std::min(options.iterations, std::max(iterations, s.settled + 1));
    const bool joined = s.robots > now.robots;  // the others have found themselves
    s = s.Next(usual, robots, 0.0, 0.0);
    step_us.Next(joined);
    const bool first = s.robots == 1 && !s.summarises();
    (first ? alone : all).Add(1.0, CostOf(s, step_us, robot_states));
  }
  const bool refines = options.refine && !now.is_refined(), at_a_distance = RefinesAtADistance(robot_states);
  const double refinement = refines ? RefinementCost(robot_states) : 0.0;
  plan->clear_advance_cost();
  if (refines && !at_a_distance) {
    if (now.summarises())
      plan->set_advance_cost(refinement);
    else
      all.cost += refinement;
    Schedule last = now;
    last.robots = robots;
    last.phase = Phase::kSummary;
    step_us.Next(true);
    all.Add(kRefined, kRefined * CostOf(last, step_us, robot_states));
  }
  plan->clear_later();
  if (options.incremental) return;
  ExpectRounds(alone.rounds, alone.cost, 1.0, plan);
  const Spread range = robots > 1 ? kOfRobots : Spread{};
  ExpectRounds(all.rounds, all.cost, static_cast<double>(robots), plan, range.least, range.most);
  if (at_a_distance) ExpectRefinement(refinement, now.summarises(), plan);
}

SearchOutlook::SearchOutlook(const Options& options, const std::vector<cairn::Step>& steps) {
  const NewCandidates to_come = Usual(options, steps);
  std::vector<double> started;  // costs of candidates that started from odometry
  double e_step = 0.0, finer = 0.0;
  for (const cairn::Step& step : steps) {
    const State& state = step.plan.state();
    const auto& later = step.plan.later();
    const Schedule now = Schedule::Load(state);
    const bool runs = step.plan.tasks_size() > 0, over = now.summarises() || now.robots > 1;
    const bool alone = runs && !over && later.size() > 1;
    const double rounds = alone ? later[0].rounds() : 0.0, cost = alone ? later[0].cost() : 0.0;
    rounds_ = std::max(rounds_, rounds + (runs && !over ? 1.0 : 0.0));  // and one for the associations
    cost_ += cost;
    width_ += runs ? 1.0 : 0.0;
    const Sum last = over ? AfterSearch(options, now, state) : LastOf(later);
    last_rounds_ = std::max(last_rounds_, last.rounds);
    last_cost_ = std::max(last_cost_, last.cost);
    refinement_ = std::max(refinement_, last.refinement);
    if (last.rounds > 0.0) e_step = std::max(e_step, last.cost / last.rounds);
    finer = std::max(finer, RefinedBy(state));
    if (ScalarOf(state, "refit_of") >= 0) continue;
    started.push_back(CostSoFar(state) + cost);
    new_rounds_ = std::max(new_rounds_, static_cast<double>(now.iteration) + rounds + 1.0);
  }
  new_cost_ = to_come.near * CostNear(started) + to_come.beyond * Mean(started) +
              to_come.refits * kRefitIterations * e_step;
  new_rounds_ *= to_come.waves;
  new_least_ = to_come.range.least;
  new_most_ = to_come.range.most;
  new_width_ = to_come.waves > 0.0 ? (to_come.near + to_come.beyond + to_come.refits) / to_come.waves : 0.0;
  if (finer <= 0.0) return;
  last_rounds_ += kFinerIterations;
  last_cost_ = finer * (last_cost_ + kFinerIterations * e_step);
}

void SearchOutlook::Announce(proto::Step* plan) const {
  plan->clear_later();
  ExpectRounds(rounds_, cost_, width_, plan, kOfIterations.least, kOfIterations.most);
  ExpectRounds(new_rounds_, new_cost_, new_width_, plan, new_least_, new_most_);
  ExpectRounds(last_rounds_, last_cost_, 1.0, plan, kOfLast.least, kOfLast.most);
  ExpectRefinement(refinement_, false, plan);
}

void CountCost(const State& before, cairn::Step* step) {
  double cost = CostSoFar(before);
  for (const Task& task : step->plan.tasks()) cost += static_cast<double>(task.cost());
  (*step->plan.mutable_state()->mutable_scalars())[kCost].set_d(cost);
}

}  // namespace cairn::landmark_map
