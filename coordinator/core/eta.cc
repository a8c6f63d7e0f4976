#include "coordinator/core/eta.h"

#include <algorithm>
#include <cmath>

namespace cairn::coordinator {
namespace {

// What is told before anything is measured: a unit of cost is a microsecond.
constexpr double kPriorPace = 1e-6, kPriorSeconds = 0.05;
// Of what is known, an answer leaves so much, or a round.
constexpr double kAnswerKeeps = 0.99, kRoundKeeps = 0.85;
// Rounds that took next to nothing say nothing of slowness.
constexpr double kPriorRounds_s = 0.2, kLeastSlowness = 0.5, kMostSlowness = 100;
// A task that runs for longer than its cost says has so much of it left.
constexpr double kNeverDone = 0.05;
// By what factor the cost of a step and of all that follows may differ from what was said before.
constexpr double kSamePlan = 1.25;
constexpr double kLeastShown_s = 0.1;  // is told, as 0 says that nothing is known

double CostLater(const proto::Step& step) {
  double cost = 0;
  for (const proto::Phase& phase : step.later()) cost += phase.cost();
  return cost;
}

bool Alike(double a, double b) { return a <= kSamePlan * b && b <= kSamePlan * a; }

}  // namespace

void Eta::BeginStage() {
  const Eta before = *this;
  *this = Eta();
  advance_s_ = before.advance_s_;
  advances_ = before.advances_;
}

void Eta::BeginRound(const proto::Step& step, const Round& tasks, double now_s) {
  const double cost = tasks.cost() + CostLater(step);
  if (!begun_) began_s_ = now_s;
  if (!begun_ || !Alike(cost, expected_cost_)) jumps_ = true;
  begun_ = true;
  expected_cost_ = CostLater(step);
  noted_s_ = 0;
  chain_part_ = tasks.cost() > 0 ? tasks.chain() / tasks.cost() : 0;
  tasks_ended_s_ = now_s;
}

void Eta::NoteTask(double cost, double seconds) {
  cost_ = kAnswerKeeps * cost_ + cost;
  seconds_ = kAnswerKeeps * seconds_ + seconds;
  noted_s_ += seconds;
}

void Eta::EndTasks(double since_s, double now_s) {
  tasks_ended_s_ = now_s;
  if (noted_s_ <= 0) return;
  alone_s_ = kRoundKeeps * alone_s_ + noted_s_ * std::max(1 / std::max(1.0, workers_), chain_part_);
  rounds_s_ = kRoundKeeps * rounds_s_ + (now_s - since_s);
}

void Eta::EndRound(double now_s) {
  advance_s_ = kRoundKeeps * advance_s_ + (now_s - tasks_ended_s_);
  advances_ = kRoundKeeps * advances_ + 1;
}

// Tasks that run for longer than was expected count as far as they are known.
double Eta::Pace(const Round& tasks, const Effort& effort) const {
  double cost = cost_ + kPriorSeconds / kPriorPace, seconds = seconds_ + kPriorSeconds;
  const double pace = seconds / cost;
  for (const auto& [task, running_s] : effort.running_s) {
    const auto of_task = static_cast<double>(tasks.task(task).cost);
    if (running_s <= pace * of_task) continue;
    cost += of_task;
    seconds += running_s;
  }
  return seconds / cost;
}

double Eta::Slowness() const {
  return std::clamp((rounds_s_ + kPriorRounds_s) / (alone_s_ + kPriorRounds_s), kLeastSlowness,
                    kMostSlowness);
}

double Eta::Run_s(double cost, double chain, const Effort& effort, double pace) const {
  return Slowness() * pace * std::max(cost / std::max(1.0, effort.workers), chain);
}

TimeLeft Eta::Expected(const proto::Step& step, const Round& tasks, const Effort& effort,
                       double now_s) const {
  const bool runs = tasks.kind() == wire::TaskKey::RUN;
  const double pace = Pace(tasks, runs ? effort : Effort{});
  const double usual_s = advances_ > 0 ? advance_s_ / advances_ : 0;
  const double advance_s = step.advance_cost() > 0 ? pace * step.advance_cost() : usual_s;
  const double over_s = runs ? 0 : std::max(0.0, now_s - tasks_ended_s_ - advance_s);
  double left_s = 0;
  if (runs) {
    double cost = 0, chain = 0;
    auto running = effort.running_s.begin();
    for (std::uint32_t i = 0; i < tasks.size(); ++i) {
      const TaskRecord& task = tasks.task(i);
      if (task.status == TaskStatus::kDone) continue;
      const auto all = static_cast<double>(task.cost);
      while (running != effort.running_s.end() && running->first < i) ++running;
      const bool runs_now =
          task.status == TaskStatus::kRunning && running != effort.running_s.end() && running->first == i;
      const double done = runs_now ? running->second / pace : 0;
      const double left = std::max(all - done, kNeverDone * all);
      cost += left;
      chain = std::max(chain, task.chain - (all - left));
    }
    left_s = Run_s(cost, chain, effort, pace) + advance_s;
  } else {
    left_s = std::max(advance_s - (now_s - tasks_ended_s_), kNeverDone * advance_s);
  }
  TimeLeft left{left_s, left_s, left_s};
  for (const proto::Phase& phase : step.later()) {
    const double chain = phase.width() > 0 ? phase.cost() / phase.width() : 0;
    const double phase_s = Run_s(phase.cost(), chain, effort, pace) + phase.rounds() * usual_s;
    const double gone_s = phase.rounds() > 0 ? 0 : over_s;
    const auto rest_s = [&](double times) {
      return std::max(times * phase_s - gone_s, kNeverDone * times * phase_s);
    };
    const double most_s = rest_s(phase.most() > 0 ? phase.most() : 1);
    left.least_s += rest_s(phase.most() > 0 ? phase.least() : 1);
    left.expected_s += gone_s > 0 ? std::min(phase_s, most_s / 2) : phase_s;  // any rest is as likely
    left.most_s += most_s;
  }
  return left;
}

double Eta::Work_s(const proto::Step& step, const Round& tasks) const {
  double cost = CostLater(step) + step.advance_cost();
  if (tasks.kind() == wire::TaskKey::RUN)
    for (std::uint32_t i = 0; i < tasks.size(); ++i)
      if (tasks.task(i).status != TaskStatus::kDone) cost += static_cast<double>(tasks.task(i).cost);
  return Pace(tasks, {}) * cost;
}

void Eta::Look(const proto::Step& step, const Round& tasks, const Effort& effort, double now_s) {
  const TimeLeft expected = Expected(step, tasks, effort, now_s);
  const bool jumps = jumps_ || !shows_ || !Alike(effort.workers, workers_);
  const double since_s = now_s - looked_s_, down_s = std::max(0.0, shown_s_ - since_s);
  const double share = since_s * (kShare + kYoung / std::max(now_s - began_s_, 1e-3)),
               slack_s = kSlack * since_s;
  shown_s_ = jumps ? expected.expected_s
                   : std::clamp(expected.expected_s, down_s * std::exp(-share) - slack_s,
                                down_s * std::exp(share) + slack_s);
  jumps_ = false;
  if (expected.expected_s > 0) {
    least_ = expected.least_s / expected.expected_s;
    most_ = expected.most_s / expected.expected_s;
  }
  workers_ = effort.workers;
  looked_s_ = now_s;
  shows_ = true;
}

TimeLeft Eta::Shown(double now_s) const {
  if (!shows_) return {};
  const double shown_s = std::max(kLeastShown_s, shown_s_ - (now_s - looked_s_));
  return {std::max(kLeastShown_s, least_ * shown_s), shown_s, most_ * shown_s};
}

}  // namespace cairn::coordinator
