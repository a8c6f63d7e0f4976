#include "datasets/verdicts/verdict.h"

#include <algorithm>

namespace cairn::datasets {

const char* Word(Confidence confidence) {
  switch (confidence) {
    case Confidence::kNone:
      return "not known";
    case Confidence::kLow:
      return "low";
    case Confidence::kFair:
      return "fair";
    case Confidence::kHigh:
      return "high";
  }
  return "";
}

Confidence AtMost(double value, double some, double much) {
  if (value > much) return Confidence::kLow;
  return value > some ? Confidence::kFair : Confidence::kHigh;
}

void Verdict::AddCount(const std::string& name, std::size_t count) {
  numbers.emplace_back(name, static_cast<double>(count));
}

void Verdict::Add(const Doubt& doubt) {
  // Where nothing else is known of a result, a doubt of this weight is.
  trust = doubt.at_most == Confidence::kLow ? Confidence::kLow : std::min(trust, doubt.at_most);
  if (!doubt.text.empty() && why.find(doubt.text) == std::string::npos) why += "; " + doubt.text;
}

std::string Verdict::Text() const { return std::string(Word(trust)) + ": " + why; }

}  // namespace cairn::datasets
