// [Thr01] eq. 1 of counts.
#pragma once

#include "pipelines/evidence_map/counts.h"
#include "pipelines/evidence_map/options.h"

namespace cairn::evidence_map {

double LogOdds(double probability);   // log p / (1 - p)
double Probability(double log_odds);  // its inverse

// What one kind of sensor counted, in units of 1 / `unit`, and its inverse model.
struct Evidence {
  const Totals* totals;
  InverseModel model;
  double unit;
};

// l = l_0 + the sum over readings of (log-odds of p(m_xy | z) - l_0), l_0 the log-odds of the prior, cut to
// +-clamp; of a cell of which no reading told, NaN. [cells], exact but for the rounding of this one sum.
std::vector<double> LogOddsOf(const std::vector<Evidence>& evidence, std::size_t cells, double prior,
                              double clamp_nats);

}  // namespace cairn::evidence_map
