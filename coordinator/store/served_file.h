// How long a store has been served, in all, while coordinators come and go: the clock by which jobs grow old
// (core/core.h). It needs no wall clock, so that none that jumps can make a young job old.
#pragma once

#include <filesystem>

#include "schema/error.h"

namespace cairn::coordinator {

// A line of text: the seconds, and a hash of them.
Status WriteServed(const std::filesystem::path& path, double served_s);
// 0 where there is no file yet. kCorrupt: it is damaged.
Result<double> ReadServed(const std::filesystem::path& path);

}  // namespace cairn::coordinator
