#include "datasets/verdicts/networks_verdict.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <span>

#include "schema/kinds/learning.h"

namespace cairn::datasets {

Verdict NetworksVerdict(const Blob& result) {
  const auto networks = Read<kinds::Networks>(result);
  const std::span<const double> held_out = networks.history.validation_error_m.OrNone();
  std::size_t best = held_out.size();
  for (std::size_t step = 0; step < held_out.size(); ++step)
    if (std::isfinite(held_out[step]) && (best == held_out.size() || held_out[step] < held_out[best]))
      best = step;
  Verdict verdict;
  const double prior = networks.prior_error_m.Or(NAN),
               held_out_prior = networks.validation_prior_error_m.Or(NAN);
  if (best == held_out.size() || !(held_out_prior > 0) || !(prior > 0)) {
    verdict.why =
        "no run was held out of their training ('holdout'), and nothing else tells what they are worth on "
        "another";
    return verdict;
  }
  // Of five or more at random places noise was never of use; of two or three in 6 of 16 trials.
  constexpr std::int64_t kFewSamples = 10;
  if (const std::int64_t samples = networks.held_out.samples.Or(kFewSamples); samples < kFewSamples) {
    verdict.why = fmt::format(
        "{} samples were held out of their training, which is too few to tell what they are worth; ten are "
        "the "
        "least",
        samples);
    return verdict;
  }
  // Less than one in a hundred is nothing that a robot would notice.
  constexpr double kUseful = 0.01;
  const double reduced = 1 - held_out[best] / held_out_prior;
  const double reduced_in_training = 1 - networks.history.training_error_m[best] / prior;
  verdict.numbers = {{"held_out_reduction", reduced}, {"training_reduction", reduced_in_training}};
  verdict.trust =
      reduced >= kUseful && 2 * reduced >= reduced_in_training ? Confidence::kFair : Confidence::kLow;
  if (reduced < kUseful) {
    verdict.why =
        "on the run that was held out they are of no more use than a detector that always says the same";
    return verdict;
  }
  verdict.why = fmt::format(
      "on the run that was held out they take {:.1f}% off the error of a robot that senses nothing, on those "
      "that they "
      "were trained on {:.1f}%",
      100 * reduced, 100 * reduced_in_training);
  verdict.why += verdict.trust == Confidence::kLow
                     ? ": most of what they have learned is of no use elsewhere"
                     : "; which step's weights are kept was chosen by the former, so it is a little too good";
  if (const double known = networks.held_out.known_share.Or(0); known > 0)
    verdict.Add(
        {Confidence::kLow,
         fmt::format("{:.0f}% of the samples that were held out had been trained on before, in a run that "
                     "this one went on from ('weights'): hold out a run that none of them has seen",
                     100 * known)});
  for (const std::string& doubt : networks.input_doubts.OrNone()) verdict.Add({Confidence::kLow, doubt});
  return verdict;
}

}  // namespace cairn::datasets
