#include "coordinator/eta.h"

#include <algorithm>

namespace cairn::coordinator {
namespace {

// Of what is known of a round, that of the round before counts so much: rounds change as a stage goes on.
constexpr double kForget = 0.85;
constexpr int kRoundsLookedAt = 12;

// The mean of rounds' seconds, the latest first, each of less weight than the one before.
class Recent {
 public:
  void Add(double seconds) {
    sum_s_ += weight_ * seconds;
    weights_ += weight_;
    weight_ *= kForget;
  }
  double mean_s() const { return weights_ > 0 ? sum_s_ / weights_ : 0; }

 private:
  double sum_s_ = 0, weights_ = 0, weight_ = 1;
};

// How much of the round's work is done, by what its tasks cost.
double PartDone(const Round& tasks) {
  double all = 0, done = 0;
  for (std::uint32_t i = 0; i < tasks.size(); ++i) {
    const auto cost = static_cast<double>(tasks.task(i).cost);
    all += cost;
    if (tasks.task(i).status == TaskStatus::kDone) done += cost;
  }
  return all > 0 ? done / all : 1;
}

}  // namespace

double StageLeft_s(const Job& job, double now_s) {
  if (!job.Running() || !job.step || job.step->rounds_left() == 0 || job.facts.empty()) return 0;
  const double spent_s = now_s - job.round_since_s;
  const bool runs = job.tasks.kind() == wire::TaskKey::RUN && job.tasks.size() > 0;
  const double part = runs ? PartDone(job.tasks) : 1;
  const proto::StageFacts& facts = job.facts.back();
  Recent recent;
  if (part > 0) recent.Add(spent_s / part);  // the round under way, as it looks so far
  const int over = std::min(facts.rounds_size() - 1, kRoundsLookedAt);  // the first of the facts is START
  for (int i = 1; i <= over; ++i) recent.Add(facts.rounds(facts.rounds_size() - i).seconds());
  const double round_s = recent.mean_s();
  const double this_round_s = part > 0 ? spent_s * (1 - part) / part : std::max(0.0, round_s - spent_s);
  return round_s * (job.step->rounds_left() - 1) + this_round_s;
}

}  // namespace cairn::coordinator
