// Pictures of localised robots: how wrong and how sure they are by distance travelled, and what one of them
// believes on its way.
#pragma once

#include <string>

#include "datasets/evaluate/learning/localization.h"
#include "datasets/evaluate/learning/localized_steps.h"
#include "datasets/report/drawing/picture.h"

namespace cairn::datasets::report {

// Means over the traverses with their 95% intervals, and below it each traverse.
std::string ErrorHtml(const LocalizationScore& score, const std::string& caption);

// How far off robots believe to be; with a score, how far off they are.
std::string SureHtml(const LocalizedSteps& localized, const LocalizationScore* score,
                     const std::string& caption);

// Both, as far as the score tells, as the bytes of a PNG.
std::string LocalizationPng(const LocalizedSteps& localized, const LocalizationScore* score);

// Of traverse number `traverse`, in the order of the result: belief, mean and, with a score, truth. Where the
// positions lie along a line, distance travelled against position along it; else maps at some steps.
Picture BeliefPicture(const LocalizedSteps& localized, const LocalizationScore* score, std::size_t traverse,
                      double width);

// The traverse that is in the middle by its error averaged over its way (without a score, by how far off it
// believes to be), and the worst.
struct Examples {
  std::size_t middle = 0, worst = 0;
};
Examples ExamplesOf(const LocalizedSteps& localized, const LocalizationScore* score);

}  // namespace cairn::datasets::report
