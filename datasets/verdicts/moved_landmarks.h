// What a landmark_map says of landmarks that somebody moved while its log was made.
#pragma once

#include <string>

#include "schema/blob.h"

namespace cairn::datasets {

// A sentence that names each, when it was moved, and what to do; empty: none was.
std::string MovedText(const Blob& landmark_map);

}  // namespace cairn::datasets
