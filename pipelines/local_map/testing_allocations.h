// How often this program has allocated memory (testing_allocations.cc counts).
#pragma once

namespace cairn::local_map {

long Allocations();

}  // namespace cairn::local_map
