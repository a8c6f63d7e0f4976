#include "coordinator/eta.h"

#include <algorithm>

namespace cairn::coordinator {
namespace {

constexpr int kRoundsLookedAt = 10;  // the last: later rounds are often unlike early ones

// The mean of the stage's last rounds; 0 where none is over. (The first of the facts is START.)
double RoundSeconds(const proto::StageFacts& facts) {
  const int rounds = std::min(facts.rounds_size() - 1, kRoundsLookedAt);
  double sum_s = 0;
  for (int i = 1; i <= rounds; ++i) sum_s += facts.rounds(facts.rounds_size() - i).seconds();
  return rounds > 0 ? sum_s / rounds : 0;
}

}  // namespace

double StageLeft_s(const Job& job, double now_s) {
  if (!job.Running() || !job.step || job.step->rounds_left() == 0 || job.facts.empty()) return 0;
  const double spent_s = now_s - job.round_since_s;
  const bool runs = job.tasks.kind() == wire::TaskKey::RUN && job.tasks.size() > 0;
  const double part = runs ? static_cast<double>(job.tasks.done_count()) / job.tasks.size() : 1;
  double round_s = RoundSeconds(job.facts.back());
  if (round_s == 0 && part > 0) round_s = spent_s / part;
  const double this_round_s =
      runs && part > 0 ? spent_s * (1 - part) / part : std::max(0.0, round_s - spent_s);
  return round_s * (job.step->rounds_left() - 1) + this_round_s;
}

}  // namespace cairn::coordinator
