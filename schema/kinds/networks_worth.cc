#include "schema/kinds/networks_worth.h"

#include <cmath>
#include <cstddef>
#include <span>

namespace cairn {

kinds::NetworksWorth WorthOf(const kinds::Networks& networks) {
  kinds::NetworksWorth worth;
  worth.held_out = networks.held_out;
  worth.input_doubts = networks.input_doubts;
  const std::span<const double> held_out = networks.history.validation_error_m.OrNone(),
                                training = networks.history.training_error_m.OrNone();
  std::size_t best = held_out.size();
  for (std::size_t step = 0; step < held_out.size() && step < training.size(); ++step)
    if (std::isfinite(held_out[step]) && (best == held_out.size() || held_out[step] < held_out[best]))
      best = step;
  const double prior = networks.prior_error_m.Or(NAN),
               held_out_prior = networks.validation_prior_error_m.Or(NAN);
  if (best == held_out.size() || !(held_out_prior > 0) || !(prior > 0)) return worth;
  worth.held_out_reduction = 1 - held_out[best] / held_out_prior;
  worth.training_reduction = 1 - training[best] / prior;
  return worth;
}

}  // namespace cairn
