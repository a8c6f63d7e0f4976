// Columns of landmark observations that say nothing: a bearing, or a range, that is the same in every row was
// filled in by somebody, and a map made with it looks like one of a log whose clock or units are wrong.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn {

// A sentence for people for each robot of the log whose bearings, or ranges, of twenty observations or more
// are all the same to the last bit. Of columns that are missing or of another type it says nothing.
std::vector<std::string> ConstantObservationsOf(const Blob& log);

}  // namespace cairn
