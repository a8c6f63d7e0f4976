#include "datasets/common/confidence.h"

#include <fmt/format.h>

#include <limits>
#include <optional>

#include "datasets/common/array_text.h"

namespace cairn::datasets {
namespace {

// A file may hold anything.
std::optional<double> NumberIn(const Blob& result, const char* name) {
  if (!result.Has(name) || result.at(name).type() == DType::kText || result.at(name).size() != 1) return {};
  return ElementNumber(result.at(name), 0);
}

// How many of the maps that were called so were right: 375 of 376, 27 of 30, 4 of 13.
const char* Frequency(Confidence confidence) {
  if (confidence == Confidence::kHigh) return "99 of 100";
  return confidence == Confidence::kFair ? "9 of 10" : "3 of 10";
}

// In what the job differs from those on which the rates were measured; none: in nothing.
std::optional<std::string> Unlike(const Blob& result) {
  constexpr char kUnlike[] = "search/unlike";
  if (!result.Has(kUnlike) || result.at(kUnlike).type() != DType::kText)
    return "the file does not say what it was made from";
  std::string all;
  for (const std::string& what : result.Texts(kUnlike)) all += (all.empty() ? "" : ", ") + what;
  if (all.empty()) return {};
  return all;
}

std::string FoundText(const Blob& result, double starts) {
  const std::optional<double> lead = NumberIn(result, "search/lead_nats");
  return fmt::format(
      "found from {:.0f} of {:.0f} starts, {}", NumberIn(result, "search/support").value_or(0.0), starts,
      lead ? fmt::format("{:.1f} nats ahead of the next different map", *lead) : "no other map was found");
}

}  // namespace

Confidence ReadConfidence(const Blob& result) {
  constexpr double kFairSupport = 2.0, kHighSupport = 3.0, kFairLead = 3.0, kHighLead = 10.0;
  const std::optional<double> support = NumberIn(result, "search/support");
  if (!support) return Confidence::kNone;
  const double lead = NumberIn(result, "search/lead_nats").value_or(std::numeric_limits<double>::infinity());
  if (*support >= kHighSupport && lead >= kHighLead) return Confidence::kHigh;
  return *support >= kFairSupport && lead >= kFairLead ? Confidence::kFair : Confidence::kLow;
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
  const double starts = NumberIn(result, "search/starts").value_or(0.0);
  if (starts == 1.0) return "unknown: EM started once, no other map to compare with";
  const std::string found = FoundText(result, starts);
  if (const auto unlike = Unlike(result))
    return "unknown: " + found + "; how often such maps are right was not measured (" + *unlike + ")";
  return std::string(Word(confidence)) + " (right in " + Frequency(confidence) +
         " such simulations): " + found;
}

std::string NotRefined(const Blob& result) {
  const char* const name = "refinement/reason";
  if (!result.Has(name) || result.at(name).type() != DType::kText || result.at(name).size() != 1) return {};
  return result.Text(name);
}

bool RefinementRefused(const Blob& result) { return NotRefined(result).starts_with("refused"); }

}  // namespace cairn::datasets
