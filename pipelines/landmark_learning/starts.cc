#include "pipelines/landmark_learning/starts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "pipelines/common/fan_out.h"
#include "pipelines/landmark_learning/advance.h"
#include "pipelines/landmark_learning/state/state.h"

namespace cairn::landmark_learning {
namespace {

constexpr std::size_t kLast = 20;  // steps over which a score is taken

Step Choose(const Options& options, const std::vector<double>& scores, std::vector<Step> steps) {
  const auto best = std::ranges::min_element(scores) - scores.begin();
  Step chosen = std::move(steps[static_cast<std::size_t>(best)]);
  chosen.plan.mutable_state()->mutable_scalars()->erase(kTrialScore);
  Blob starts;
  starts.PutVector("starts/error_m", scores);
  starts.PutScalar<std::int64_t>("starts/chosen", best);
  (*chosen.plan.mutable_state()->mutable_blobs())["starts"] = chosen.Share(std::move(starts));
  chosen.plan.set_note(fmt::format(
      "step {}: of {} starts, of errors from {:.3f} to {:.3f}, start {} goes on", StartStepsOf(options),
      scores.size(), scores[static_cast<std::size_t>(best)], *std::ranges::max_element(scores), best));
  return chosen;
}

}  // namespace

void ExpectTrials(const Options& options, std::int64_t steps_done, int starts, proto::Step* plan) {
  const double rounds = RoundsLater(*plan), cost = CostLater(*plan) / starts;
  const double width = plan->later_size() > 0 ? plan->later(0).width() : 0.0;
  const auto left = static_cast<double>(std::max<std::int64_t>(1, options.steps - steps_done)),
             trials = static_cast<double>(std::max<std::int64_t>(0, StartStepsOf(options) - steps_done));
  const double part = std::min(1.0, trials / left);
  plan->clear_later();
  ExpectRounds(part * rounds, part * cost * starts, width, plan);
  ExpectRounds((1.0 - part) * rounds, (1.0 - part) * cost, width / starts, plan);
}

double ScoreOf(const std::vector<double>& errors, double best_validation) {
  if (std::isfinite(best_validation)) return best_validation;
  const auto count = static_cast<std::ptrdiff_t>(std::min(kLast, errors.size()));
  return std::accumulate(errors.end() - count, errors.end(), 0.0) / static_cast<double>(count);
}

Step AdvanceStarts(const Options& options, std::uint64_t seed, const State& state, Partials& partials,
                   const Inputs& inputs) {
  std::vector<Step> steps;
  std::vector<double> scores;
  const std::int64_t done = Read<Training>(*OneStart(state, 0, partials, inputs).Get("training")).steps + 1;
  for (int start = 0; start < StartsIn(state); ++start) {
    OneStart one(state, start, partials, inputs);
    steps.push_back(AdvanceRound(options, seed, one.state(), one, one, true));
    const auto& scalars = steps.back().plan.state().scalars();
    if (const auto score = scalars.find(kTrialScore); score != scalars.end())
      scores.push_back(score->second.d());
  }
  CAIRN_DEMAND(scores.empty() || scores.size() == steps.size(), "starts advance in step");
  if (!scores.empty()) return Choose(options, scores, std::move(steps));
  const std::string note = steps.front().plan.note();
  const std::size_t count = steps.size();
  Step merged = FanOut(std::move(steps));
  ExpectTrials(options, done, static_cast<int>(count), &merged.plan);
  merged.plan.set_note("start 0 of " + std::to_string(count) + ", " + note);
  return merged;
}

}  // namespace cairn::landmark_learning
