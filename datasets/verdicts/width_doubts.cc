#include "datasets/verdicts/width_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

namespace cairn::datasets {
namespace {

// How many times as large as the log states, or as was expected, errors of ranges or bearings are, and
// whether it states them: of those that err by more than half, or by more than the other figure where nothing
// is stated. Of files that do not say so all counts as stated.
std::pair<double, bool> WidestError(const kinds::LandmarkMap::Fit& fit, double more_than_expected) {
  constexpr double kMoreThanStated = 1.5;  // a data sheet errs by half
  std::pair<double, bool> widest{0, true};
  for (std::size_t k = 0; k < fit.kind.OrNone().size(); ++k) {
    if ((fit.kind[k] != "range" && fit.kind[k] != "bearing") || !(fit.stated[k] > 0)) continue;
    const bool told = fit.told.OrNone().empty() || fit.told[k] != 0;
    const double wider = fit.found[k] / fit.stated[k];
    if (wider > (told ? kMoreThanStated : more_than_expected))
      widest = std::max(widest, std::pair(wider, told));
  }
  return widest;
}

// Whether what was left out is what the log says is false. Where less was left out false observations are in
// the map.
bool IsAsStated(const kinds::LandmarkMap::Fit& fit, double left_out) {
  constexpr double kFewer = 0.03, kMore = 0.1;
  return fit.false_ratio && left_out >= fit.false_ratio.Scalar() - kFewer &&
         left_out <= fit.false_ratio.Scalar() + kMore;
}

// What a mistake about the sensor leaves, one sighting of a landmark errs by as the next one does; a coarse
// sensor errs anew.
bool ErrAnew(const kinds::LandmarkMap::Fit& fit) {
  return fit.repeats_along && fit.repeats_along.Scalar() <= 1 && fit.repeats_across.Or(1) <= 1;
}

// The options that state what was found.
std::string OptionsOf(const kinds::LandmarkMap::Fit& fit) {
  std::string options;
  for (std::size_t k = 0; k < fit.kind.OrNone().size(); ++k) {
    if (fit.kind[k] != "range" && fit.kind[k] != "bearing") continue;
    options += fmt::format("{}--{}={:.2g}", options.empty() ? "" : " ",
                           fit.kind[k] == "range" ? "range-m" : "bearing-rad", fit.found[k]);
  }
  return options;
}

}  // namespace

Verdict::Doubt OfWidths(const kinds::LandmarkMap::Fit& fit, bool all_named, bool one_moves) {
  constexpr double kWider = 2, kMuchWider = 3;
  const auto [wider, told] = WidestError(fit, kWider);
  if (wider == 0) return {Confidence::kHigh};
  const std::string text = fmt::format("ranges or bearings err by {:.1f} times what {}", wider,
                                       told ? "is stated" : "was expected, as nothing is stated of them");
  const Confidence at_most = AtMost(wider, kWider, kMuchWider);
  if (one_moves) return {at_most, text};
  if (!told && all_named && ErrAnew(fit))
    return {std::max(at_most, Confidence::kFair),
            text + ": is the sensor so coarse? Then `cairn import csv " + OptionsOf(fit) + "` states it"};
  return {at_most, text + (wider > kMuchWider && !ErrAnew(fit) ? ": is the sensor's mount right?"
                                                               : ": is the sensor less exact?")};
}

Verdict::Doubt OfMuchLeftOut(const kinds::LandmarkMap::Fit& fit, bool all_named, double explained_share) {
  constexpr double kMost = 0.2, kWider = 1.5;
  const double left_out = 1 - explained_share, wider = WidestError(fit, kWider).first;
  if (wider == 0 || all_named || left_out <= kMost || IsAsStated(fit, left_out)) return {Confidence::kHigh};
  return {Confidence::kLow,
          fmt::format("more than a fifth of the observations was left out, and ranges or bearings err by "
                      "{:.1f} times what is stated, or was expected{}",
                      wider, fit.false_ratio ? "" : "; --false-ratio says how many are of nothing")};
}

}  // namespace cairn::datasets
