#include "pipelines/evidence_map/log_odds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cairn::evidence_map {

double LogOdds(double probability) { return std::log(probability / (1 - probability)); }

double Probability(double log_odds) { return 1 / (1 + std::exp(-log_odds)); }

std::vector<double> LogOddsOf(const std::vector<Evidence>& evidence, std::size_t cells, double prior,
                              double clamp_nats) {
  const double start = LogOdds(prior);
  struct Step {
    const Totals* totals;
    double free, occupied;  // that one reading adds
  };
  std::vector<Step> steps;
  for (const Evidence& from : evidence) {
    steps.push_back({from.totals, (LogOdds(from.model.p_free) - start) / from.unit,
                     (LogOdds(from.model.p_occupied) - start) / from.unit});
  }
  std::vector<double> result(cells, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < cells; ++k) {
    double sum = start;
    bool told = false;
    for (const Step& step : steps) {
      const std::int64_t free = step.totals->free[k], occupied = step.totals->occupied[k];
      told |= free != 0 || occupied != 0;
      // [Thr01] eqs 1 to 3: given the cell alone each reading adds its share.
      sum += static_cast<double>(free) * step.free + static_cast<double>(occupied) * step.occupied;
    }
    if (told) result[k] = std::clamp(sum, -clamp_nats, clamp_nats);
  }
  return result;
}

}  // namespace cairn::evidence_map
