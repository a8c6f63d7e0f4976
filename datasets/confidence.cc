#include "datasets/confidence.h"

#include <cstdio>

#include "datasets/array_text.h"

namespace cairn::datasets {

std::string ConfidenceText(const Blob& result) {
  if (!result.Has("search/score_nats"))
    return "not stated: there was one candidate, no other map to compare with";
  const std::string tried = std::to_string(result.at("search/score_nats").size()) + " candidates";
  const char* const name = "search/lead_nats";
  if (!result.Has(name) || result.at(name).type() == DType::kText || result.at(name).size() != 1)
    return "high among the maps tried: all " + tried + " found this one or none";
  constexpr double kLow = 3.0, kFair = 10.0;
  const double lead = ElementNumber(result.at(name), 0);
  const char* const word = lead < kLow ? "low" : lead < kFair ? "fair" : "high";
  char text[160];
  std::snprintf(text, sizeof text, "%s among the maps tried: %.1f nats ahead of the next different one of %s",
                word, lead, tried.c_str());
  return text;
}

}  // namespace cairn::datasets
