// Whether the truth can be in metres, by how far odometry goes.
#pragma once

#include <string>
#include <vector>

#include "schema/kinds/log.h"

namespace cairn::datasets {

inline constexpr double kMostBeyond = 2;  // times as far as robots drove and saw

// A sentence of true landmarks, and of each robot's true poses, that lie farther from their middle than
// robots which drove so far can have been from it: "true landmarks lie 8000 m from their middle …: are they
// in millimetres?". Of columns that are missing it says nothing.
std::vector<std::string> FindTruthDoubts(const kinds::Log& log);

}  // namespace cairn::datasets
