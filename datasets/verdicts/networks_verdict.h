// How far networks can be trusted.
#pragma once

#include "datasets/verdicts/verdict.h"
#include "schema/blob.h"

namespace cairn::datasets {

// Of networks: by how much they reduce the error of a robot that senses nothing (which is what a detector
// that always says the same leaves it at) on the run that was held out, beside those that they were trained
// on, at the step whose weights are kept. Fair: at least half as much; never high, for that run chose the
// step. Low: less, or where an input tells when rather than where. Not known where no run was held out.
Verdict NetworksVerdict(const Blob& result);

}  // namespace cairn::datasets
