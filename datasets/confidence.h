// How sure a map is, in words: what `search/` in the result says.
#pragma once

#include <string>

#include "schema/blob.h"

namespace cairn::datasets {

// kNone: there was one candidate, or the file does not say.
enum class Confidence { kNone, kLow, kFair, kHigh };

// By how many starts found the best map (search/support) and by how many nats it is ahead of the next
// different one (search/lead_nats): high from three starts and ten nats on, fair from three starts and three
// nats on. How often each was right on simulated logs pipelines/landmark_map/README.md says.
Confidence ConfidenceOf(const Blob& result);

const char* Word(Confidence confidence);  // "not stated", "low", "fair", "high"

// "high: found from 6 of 12 starts, 57.2 nats ahead of the next different map of 20". No lead says that a
// better map, which was not tried, does not exist.
std::string ConfidenceText(const Blob& result);

}  // namespace cairn::datasets
