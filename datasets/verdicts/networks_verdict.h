// How far networks can be trusted.
#pragma once

#include "datasets/verdicts/verdict.h"
#include "schema/blob.h"
#include "schema/kinds/learning.h"

namespace cairn::datasets {

// Of networks: by how much they reduce the error of a robot that senses nothing (which is what a detector
// that always says the same leaves it at) on the run that was held out, beside those that they were trained
// on, at the step whose weights are kept. Fair: at least half as much; never high, for that run chose the
// step. Low: less; or what they make of that run may agree with the map by chance, as drift does; or an input
// tells when rather than where; or much of what was held out had been trained on. Not known where no run was
// held out, or too little of it lies where the others have been.
Verdict NetworksVerdict(const Blob& result);
Verdict NetworksVerdict(const kinds::NetworksWorth& worth);

}  // namespace cairn::datasets
