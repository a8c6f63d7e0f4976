// The landmarks of a result and of truth, and how their names tie them together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

inline constexpr std::int32_t kNoTruth = -1;

// Throws InputError where a column is missing, they differ in length or a value is not finite.
std::vector<Point> ReadPoints(const Blob& blob, const std::string& x_name, const std::string& y_name);

// Which of the log's true landmarks count as observed: those that truth/robot/N/observations/landmark names;
// for a robot without it, those that its observations name; all of them where neither tells. Indices must be
// in range.
std::vector<bool> ObservedLandmarks(const Blob& log, std::size_t landmarks);

// The true landmark of the same name for each of the map's landmarks; kNoTruth where its identity is unknown
// or truth has none of its name.
// Throws InputError for an identity out of range.
std::vector<std::int32_t> MapIdentities(const Blob& result, const Blob& log, std::size_t landmarks);

}  // namespace cairn::datasets
