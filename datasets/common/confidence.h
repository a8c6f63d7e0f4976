// How sure a map is, in words: what `search/` in the result says.
#pragma once

#include <string>

#include "schema/blob.h"

namespace cairn::datasets {

// kNone: there was no search, for landmarks have identities or the map was given, or the file does not say.
enum class Confidence { kNone, kLow, kFair, kHigh };

// By how many starts found the best map (search/support) and by how many nats it is ahead of the next
// different one (search/lead_nats): high from three starts and ten nats on, fair from two starts and three
// nats on. How often each was right on simulated logs pipelines/landmark_map/EXPERIMENTS.md says; of other
// logs and options nobody knows.
Confidence ReadConfidence(const Blob& result);

const char* Word(Confidence confidence);  // "not stated", "low", "fair", "high"

// Of a map of a log, and with options, like those on which the rates were measured (search/unlike is there
// and empty): "high (right in 99 of 100 such simulations): found from 6 of 12 starts, 57.2 nats ahead of the
// next different map". Of another: "unknown: found from 6 of 12 starts, 57.2 nats ahead of the next different
// map; how often such maps are right was not measured (it has 4 robots)". No lead says that a better map,
// which was not tried, does not exist.
std::string ConfidenceText(const Blob& result);

// Why the landmarks of a map are not those of the least squares over its associations (refinement/reason):
// "refused: the weighted squares of its residuals rose from 210.4 to 388.0", "not tried: refine=false". Empty
// where they are, or where the file does not say.
std::string NotRefined(const Blob& result);
// True where that was tried and its outcome thrown away.
bool RefinementRefused(const Blob& result);

}  // namespace cairn::datasets
