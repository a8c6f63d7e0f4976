// The landmarks of a result and of truth, and how their names tie them together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "schema/geometry.h"
#include "schema/kinds/landmark_map.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {

inline constexpr std::int32_t kNoTruth = -1;

std::vector<Point> PointsOf(std::span<const double> x_m, std::span<const double> y_m);

// Which of the log's true landmarks count as observed: those that truth/robot/N/observations/landmark names;
// for a robot without it, those that its observations name; all of them where neither tells.
std::vector<bool> ObservedLandmarks(const kinds::Log& log);

// The true landmark of the same name for each of the map's landmarks; kNoTruth where its identity is unknown
// or truth has none of its name.
std::vector<std::int32_t> MapIdentities(const kinds::LandmarkMap& map, const kinds::Log& log);

}  // namespace cairn::datasets
