#include "datasets/common/localization_verdict.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>

#include "schema/kinds/learning.h"

namespace cairn::datasets {
namespace {

constexpr double kSureShare = 0.25;  // of the spread of all positions

double Sum(std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); }

// Root of the mean squared distance of the positions from their mean.
double SpreadOf(std::span<const double> x_m, std::span<const double> y_m) {
  const auto n = static_cast<double>(x_m.size());
  const double mean_x_m = Sum(x_m) / n, mean_y_m = Sum(y_m) / n;
  double squares = 0.0;
  for (std::size_t k = 0; k < x_m.size(); ++k)
    squares += std::pow(x_m[k] - mean_x_m, 2) + std::pow(y_m[k] - mean_y_m, 2);
  return std::sqrt(squares / n);
}

}  // namespace

Verdict LocalizationVerdict(const Blob& result) {
  const auto localization = Read<kinds::Localization>(result);
  const kinds::Localization::Steps& step = localization.step;
  Verdict verdict;
  if (!step.lead_nats || !step.expected_lead_nats) {
    verdict.why = "the file does not tell how well its robots foretold what they sensed";
    return verdict;
  }
  const double sure_m = kSureShare * SpreadOf(localization.position_x_m, localization.position_y_m);
  std::size_t robots = 0, sure = 0;
  for (std::size_t k = 0; k < step.traverse.size(); ++k) {
    if (k + 1 < step.traverse.size() && step.traverse[k + 1] == step.traverse[k]) continue;
    ++robots;
    sure += step.spread_m[k] <= sure_m ? 1 : 0;
  }
  const double expected = Sum(step.expected_lead_nats);
  const double foretold = expected > 0.0 ? Sum(step.lead_nats) / expected : 0.0;
  verdict.AddCount("robots", robots);
  verdict.AddCount("sure_robots", sure);
  verdict.numbers.emplace_back("sure_m", sure_m);
  verdict.numbers.emplace_back("foretold_ratio", foretold);
  verdict.trust = 2 * sure >= robots && foretold >= 1.0 ? Confidence::kFair : Confidence::kLow;
  verdict.why =
      fmt::format("{} of {} robots end sure of their place to within {:.1f} m", sure, robots, sure_m);
  if (foretold < 1.0)
    verdict.why +=
        ", but what they sensed they foretold less well than where they believe to be says: is the map "
        "that of another place, or from before things changed?";
  else if (verdict.trust == Confidence::kFair)
    verdict.why +=
        ", and they foretold what they sensed; one at a place that looks the same is not found out";
  return verdict;
}

}  // namespace cairn::datasets
