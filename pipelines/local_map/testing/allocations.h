// How often this program has allocated memory (allocations.cc counts).
#pragma once

namespace cairn::local_map {

long Allocations();

}  // namespace cairn::local_map
