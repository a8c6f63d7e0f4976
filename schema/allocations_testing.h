// How often this thread has allocated memory. For tests whose target has allocations_testing.cc, which
// counts.
#pragma once

namespace cairn {

long Allocations();

}  // namespace cairn
