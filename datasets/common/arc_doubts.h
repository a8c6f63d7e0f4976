// Whether a robot turned while it went, where its odometry is read as first the turn, then the way: by what
// it sees of landmarks soon after each other, without a map.
#pragma once

#include <optional>
#include <string>

#include "schema/kinds/log.h"

namespace cairn::datasets {

// How far odometry lies from first turning (0) to turning along the way (1), by pairs of observations.
struct StepArcs {
  double share = 0, sd = 0;
  std::size_t pairs = 0;
  double half_step_m = 0;
};

// Nothing where steps are too short to matter, where too few pairs tell, or where odometry errs by much else.
std::optional<StepArcs> FindStepArcs(const kinds::Log::Observations& seen,
                                     const kinds::Log::Odometry& odometry);

// A sentence with the question to ask where the pairs say clearly that it turned along the way.
std::optional<std::string> DoubtSteps(const kinds::Log::Observations& seen,
                                      const kinds::Log::Odometry& odometry);

}  // namespace cairn::datasets
