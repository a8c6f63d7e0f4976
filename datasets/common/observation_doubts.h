// What is to be doubted of a log's observations of landmarks, in words: warnings, for maps are made all the
// same where they can be.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

// A sentence for each of
// - names that robots and landmarks share: a robot that was seen by another is no landmark;
// - ranges without bearings, or bearings without ranges: landmark_map takes both, or neither for a contact;
// - bearings, or ranges, that are all the same.
// Forgives what is missing, or not as its kind says.
std::vector<std::string> ObservationDoubtsOf(const Blob& log);

}  // namespace cairn::datasets
