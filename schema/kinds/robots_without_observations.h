// Robots that no map of landmarks can place beside the others.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn {

// A sentence for people for each robot of the log that observed no landmark where another did. Of columns
// that are missing or of another type it says nothing.
std::vector<std::string> RobotsWithoutObservationsOf(const Blob& log);

}  // namespace cairn
