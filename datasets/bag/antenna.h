// From where an antenna was to where the robot was.
#pragma once

#include <cstddef>
#include <vector>

#include "datasets/bag/readers.h"
#include "schema/store/spooled_rows.h"

namespace cairn::datasets::bag {

// Of fixes of an antenna that sits at `antenna` on the robot, in the order of time: the robot's poses. Their
// headings are odometry's, turned so that the antenna's way by odometry lies on the fixes over five metres
// before and after; so they hold where the robot turns in place or drives backwards, too. `odometry`: in the
// order of time. Leaves those fixes out that have no odometry, and around which the robot hardly moves or
// odometry does not fit the fixes; returns how many.
std::size_t TakeOffAntenna(const Pose& antenna, const SpooledRows<PoseRow>& odometry,
                           std::vector<PoseRow>* fixes);

}  // namespace cairn::datasets::bag
