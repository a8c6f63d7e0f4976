#include "datasets/verdicts/networks_verdict.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "schema/kinds/networks_worth.h"

namespace cairn::datasets {
namespace {

// Of five or more samples at random places noise was never of use; of two or three in 6 of 16 trials.
constexpr std::int64_t kFewSamples = 10;

// Why what was held out is too little to tell; empty: it is enough.
std::string TooFew(const kinds::Networks::HeldOut& held_out) {
  const std::int64_t samples = held_out.samples.Or(kFewSamples), in_reach = held_out.in_reach.Or(samples);
  if (samples < kFewSamples)
    return fmt::format(
        "{} samples were held out of their training, which is too few to tell what they are worth; ten are "
        "the least",
        samples);
  if (in_reach < kFewSamples)
    return fmt::format(
        "of the {} samples that were held out of their training {} were taken within reach of one that was "
        "trained on, which is too few to tell what they are worth; ten are the least",
        samples, in_reach);
  return "";
}

void AddDoubts(const kinds::NetworksWorth& worth, Verdict* verdict) {
  const kinds::Networks::HeldOut& held_out = worth.held_out;
  // By chance one in forty.
  constexpr double kLeastSigmas = 2;
  if (const double sigmas = held_out.agreement_sigmas.Or(kLeastSigmas); sigmas < kLeastSigmas)
    verdict->Add(
        {Confidence::kLow,
         fmt::format(
             "what they make of that run agrees with what they made of the same places before by {:.1f} "
             "standard deviations of chance, two are the least: do the inputs drift, and tell when "
             "rather than where?",
             sigmas)});
  constexpr double kMuchTheSame = 0.2;
  if (const double same = held_out.same_share.Or(0); same >= kMuchTheSame)
    verdict->Add(
        {Confidence::kLow,
         fmt::format("{:.0f}% of the samples that were held out are, but for rounding, ones that were "
                     "trained on: hold out a run that was recorded by itself",
                     100 * same)});
  if (const double known = held_out.known_share.Or(0); known > 0)
    verdict->Add(
        {Confidence::kLow,
         fmt::format("{:.0f}% of the samples that were held out had been trained on before, in a run that "
                     "this one went on from ('weights'): hold out a run that none of them has seen",
                     100 * known)});
  for (const std::string& doubt : worth.input_doubts.OrNone()) verdict->Add({Confidence::kLow, doubt});
}

}  // namespace

Verdict NetworksVerdict(const Blob& result) {
  return NetworksVerdict(WorthOf(Read<kinds::Networks>(result)));
}

Verdict NetworksVerdict(const kinds::NetworksWorth& worth) {
  Verdict verdict;
  if (!worth.held_out_reduction || !worth.training_reduction) {
    verdict.why =
        "no run was held out of their training ('holdout'), and nothing else tells what they are worth on "
        "another";
    return verdict;
  }
  verdict.why = TooFew(worth.held_out);
  if (!verdict.why.empty()) return verdict;
  // Less than one in a hundred is nothing that a robot would notice.
  constexpr double kUseful = 0.01;
  const double reduced = worth.held_out_reduction.Scalar(),
               reduced_in_training = worth.training_reduction.Scalar();
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
  AddDoubts(worth, &verdict);
  return verdict;
}

}  // namespace cairn::datasets
