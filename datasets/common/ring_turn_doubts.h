// Rings of range sensors that are not mounted as the log says: where the robot drives ahead, what beams that
// point ahead see comes nearer by just the way driven, whatever it is, and what those behind see goes away.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {

// By how much the beams of robot's `sensor` would have to be turned for that, by odometry, else by its poses;
// none where too little comes nearer or goes away, where beams do not agree, or of a sensor on a turret.
std::optional<double> RingTurnRad(const kinds::Log::Robot& robot, const kinds::Log::RangeSensor& sensor);

// A warning a sensor where that is far from nothing. Forgives what is missing.
std::vector<std::string> RingTurnDoubtsOf(const Blob& log);

}  // namespace cairn::datasets
