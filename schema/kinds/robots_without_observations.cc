#include "schema/kinds/robots_without_observations.h"

#include <algorithm>

#include "schema/kinds/log.h"

namespace cairn {

std::vector<std::string> RobotsWithoutObservationsOf(const Blob& log) {
  const auto parts = Read<kinds::Log>(log);
  const auto has_observed = [](const kinds::Log::Robot& robot) {
    return !robot.observations.time_s.OrNone().empty();
  };
  std::vector<std::string> texts;
  if (std::ranges::none_of(parts.robot, has_observed)) return texts;
  for (std::size_t n = 0; n < parts.robots.OrNone().size(); ++n) {
    if (has_observed(parts.robot[n])) continue;
    texts.push_back("robot '" + parts.robots[n] +
                    "' has no observations, as others have: no map of landmarks can place it; leave its rows "
                    "out of the odometry");
  }
  return texts;
}

}  // namespace cairn
