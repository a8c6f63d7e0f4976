#include "datasets/common/confidence.h"

#include <fmt/format.h>

#include <limits>
#include <optional>

#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {
namespace {

// How many of the maps that were called so were right: 375 of 376, 27 of 30, 4 of 13.
const char* Frequency(Confidence confidence) {
  if (confidence == Confidence::kHigh) return "99 of 100";
  return confidence == Confidence::kFair ? "9 of 10" : "3 of 10";
}

// In what the job differs from those on which the rates were measured; none: in nothing.
std::optional<std::string> Unlike(const kinds::LandmarkMap::Search& search) {
  if (!search.unlike) return "the file does not say what it was made from";
  std::string all;
  for (const std::string& what : search.unlike) all += (all.empty() ? "" : ", ") + what;
  if (all.empty()) return {};
  return all;
}

std::string FoundText(const kinds::LandmarkMap::Search& search) {
  const std::optional<double> lead = search.lead_nats.Optional();
  char ahead[80] = "no other map was found";
  if (lead) std::snprintf(ahead, sizeof ahead, "%.1f nats ahead of the next different map", *lead);
  char found[160];
  std::snprintf(found, sizeof found, "found from %d of %d starts, %s", search.support.Or(0),
                search.starts.Or(0), ahead);
  return found;
}

}  // namespace

Confidence ReadConfidence(const Blob& result) {
  constexpr std::int32_t kFairSupport = 2, kHighSupport = 3;
  constexpr double kFairLead = 3.0, kHighLead = 10.0;
  const auto search = FieldsIn<kinds::LandmarkMap::Search>("search/", result);
  if (!search.support) return Confidence::kNone;
  const std::int32_t support = search.support.Scalar();
  const double lead = search.lead_nats.Or(std::numeric_limits<double>::infinity());
  if (support >= kHighSupport && lead >= kHighLead) return Confidence::kHigh;
  return support >= kFairSupport && lead >= kFairLead ? Confidence::kFair : Confidence::kLow;
}

const char* Word(Confidence confidence) {
  switch (confidence) {
    case Confidence::kNone:
      return "not stated";
    case Confidence::kLow:
      return "low";
    case Confidence::kFair:
      return "fair";
    case Confidence::kHigh:
      return "high";
  }
  return "";
}

std::string ConfidenceText(const Blob& result) {
  const Confidence confidence = ReadConfidence(result);
  if (confidence == Confidence::kNone) return std::string(Word(confidence)) + ": there was no search";
  const auto search = FieldsIn<kinds::LandmarkMap::Search>("search/", result);
  if (search.starts.Or(0) == 1)
    return "unknown: EM started once, no other map to compare with; it searches where the drift of the "
           "heading is stated at import (--heading-drift-rad-per-m), or with --set starts=10";
  const std::string found = FoundText(search);
  if (const auto unlike = Unlike(search))
    return "unknown: " + found + "; how often such maps are right was not measured (" + *unlike + ")";
  return std::string(Word(confidence)) + " (right in " + Frequency(confidence) +
         " such simulations): " + found;
}

std::string NotRefined(const Blob& result) {
  const Texts reason = Texts::In(result, "refinement/reason");
  return reason ? reason.Scalar() : "";
}

bool RefinementRefused(const Blob& result) { return NotRefined(result).starts_with("refused"); }

}  // namespace cairn::datasets
