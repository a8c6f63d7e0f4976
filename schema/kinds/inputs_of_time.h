// Inputs of samples that tell when, not where: a row's number, a clock, a counter of a sensor's frames, left
// in the file. Where a robot drives the same way each time, networks learn such a one as if it were a
// landmark.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn {

// A sentence for people for each input that grows all along every run of `samples`, or falls, whatever noise
// and rounding do to it: by Spearman's rank correlation with the sample's number, 0.95 at least. None where a
// run has fewer than twenty samples: a sensor may do that by chance. Of what is missing or of another type it
// says nothing.
std::vector<std::string> InputsOfTimeOf(const Blob& samples);

}  // namespace cairn
