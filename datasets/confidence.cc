#include "datasets/confidence.h"

#include <cstdio>
#include <limits>
#include <optional>

#include "datasets/array_text.h"

namespace cairn::datasets {
namespace {

// A file may hold anything.
std::optional<double> NumberIn(const Blob& result, const char* name) {
  if (!result.Has(name) || result.at(name).type() == DType::kText || result.at(name).size() != 1) return {};
  return ElementNumber(result.at(name), 0);
}

}  // namespace

Confidence ConfidenceOf(const Blob& result) {
  constexpr double kEnoughSupport = 3.0, kFairLead = 3.0, kHighLead = 10.0;
  const std::optional<double> support = NumberIn(result, "search/support");
  if (!support) return Confidence::kNone;
  const double lead = NumberIn(result, "search/lead_nats").value_or(std::numeric_limits<double>::infinity());
  if (!(*support >= kEnoughSupport && lead >= kFairLead)) return Confidence::kLow;
  return lead >= kHighLead ? Confidence::kHigh : Confidence::kFair;
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
  const Confidence confidence = ConfidenceOf(result);
  if (confidence == Confidence::kNone)
    return std::string(Word(confidence)) + ": there was one candidate, no other map to compare with";
  const std::optional<double> lead = NumberIn(result, "search/lead_nats");
  char ahead[80] = "no other map was found";
  if (lead) std::snprintf(ahead, sizeof ahead, "%.1f nats ahead of the next different map", *lead);
  char text[200];
  std::snprintf(text, sizeof text, "%s: found from %.0f of %.0f starts, %s", Word(confidence),
                NumberIn(result, "search/support").value_or(0.0),
                NumberIn(result, "search/starts").value_or(0.0), ahead);
  return text;
}

}  // namespace cairn::datasets
