// How sure a map is, in words: what `search/` in the result says.
#pragma once

#include <string>

#include "schema/blob.h"

namespace cairn::datasets {

// kNone: there was no search, for landmarks have identities or the map was given, or the file does not say.
enum class Confidence { kNone, kLow, kFair, kHigh };

// By how many starts found the best map (search/support) and by how many nats it is ahead of the next
// different one (search/lead_nats): high from three starts and ten nats on, fair from two starts and three
// nats on. How often each was right on simulated logs pipelines/landmark_map/README.md says.
Confidence ConfidenceOf(const Blob& result);

const char* Word(Confidence confidence);  // "not stated", "low", "fair", "high"

// "high (right in 99 of 100 such simulations): found from 6 of 12 starts, 57.2 nats ahead of the next
// different map". No lead says that a better map, which was not tried, does not exist.
std::string ConfidenceText(const Blob& result);

}  // namespace cairn::datasets
