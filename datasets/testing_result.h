// A small landmark map for this folder's tests, as schema/FORMAT.md has it.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

inline Blob SmallResult() {
  Blob blob;
  blob.Put("robots", Array::Texts({"Rosa", "a/b"}));
  blob.Put("landmarks", Array::Texts({"door"}));
  for (const std::string prefix : {"robot/0/poses/", "robot/1/poses/"}) {
    blob.PutVector<double>(prefix + "time_s", {1, 2, 3});
    blob.PutVector<double>(prefix + "x_m", {9, 9, 9});
    blob.PutVector<double>(prefix + "y_m", {9, 9, 9});
    blob.PutVector<double>(prefix + "heading_rad", {0, 0, 0});
    blob.PutVector<double>(prefix + "mode_x_m", {0, 1, 1});
    blob.PutVector<double>(prefix + "mode_y_m", {0, 0, 2});
    blob.PutVector<double>(prefix + "mode_heading_rad", {0, 1.5707963267948966, 3});
    std::vector<double> covariance(27);
    for (std::size_t i : {9U, 13U, 17U, 18U, 22U, 26U}) covariance[i] = 0.04;
    blob.Put(prefix + "covariance", Array::Of<double>({3, 3, 3}, covariance));
  }
  blob.PutVector<std::int32_t>("robot/0/observations/map_landmark", {0, -1, 1});
  blob.PutVector<double>("robot/0/observations/probability", {1, 0, 0.5});
  blob.PutVector<double>("map/landmark_x_m", {2, 1});
  blob.PutVector<double>("map/landmark_y_m", {0, 2});
  blob.Put("map/landmark_covariance_m2",
           Array::Of<double>({2, 2, 2}, std::vector<double>{.04, 0, 0, .01, .1, 0, 0, .1}));
  blob.PutVector<std::int32_t>("map/landmark_identity", {0, -1});
  blob.PutVector<double>("map/landmark_count", {1, 0.5});
  blob.Put("map/grid/probability",
           Array::Of<double>({2, 2, 3}, std::vector<double>{0, 0, 0.5, 0.4, 0, 0, 0, 0.9, 0, 0.5, 0, 0}));
  blob.PutScalar<double>("map/grid/origin_x_m", -1);
  blob.PutScalar<double>("map/grid/origin_y_m", -0.5);
  blob.PutScalar<double>("map/grid/cell_m", 1.5);
  return blob;
}

// The same robots' local map: of the second one a trace that runs along y, with edges at (7.5, 21) and
// (14, 21.5).
inline Blob SmallLocalMap() {
  Blob map;
  const Blob other = SmallResult();
  for (const auto& [name, array] : other.fields())
    if (!name.starts_with("map/")) map.Put(name, array);
  map.PutScalar("cell_m", 0.5);
  map.PutVector<std::int32_t>("traces/robot", {1});
  map.PutVector<double>("traces/first_s", {1});
  map.PutVector<double>("traces/last_s", {3});
  map.PutVector<double>("traces/x_m", {10});
  map.PutVector<double>("traces/y_m", {20});
  map.PutVector<double>("traces/direction_rad", {1.5707963267948966});
  map.PutVector<std::int32_t>("traces/first_z", {2});
  map.PutVector<std::int64_t>("traces/features", {2});
  for (const std::string side : {"features/left/", "features/right/"}) {
    const bool left = side == "features/left/";
    map.PutVector<float>(side + "angle_low_rad", {0, left ? std::nanf("") : 0});
    map.PutVector<float>(side + "angle_high_rad", {0, 0});
    map.PutVector<float>(side + "distance_low_m", {2, 4});
    map.PutVector<float>(side + "distance_high_m", {3, 4});
    map.PutVector<float>(side + "cross_m", {2.5F, 4});
    map.PutVector<std::uint8_t>(side + "occupied", {static_cast<std::uint8_t>(left ? 1 : 0), 1});
  }
  map.PutVector<std::int32_t>("connections/kind", {});
  return map;
}

// The log that goes with it.
inline Blob SmallLog() {
  Blob log;
  log.Put("robots", Array::Texts({"Rosa", "a/b"}));
  log.Put("landmarks", Array::Texts({"door"}));
  for (const std::string prefix : {"robot/0/", "robot/1/"}) {
    const bool first = prefix == "robot/0/";
    log.PutVector<double>(prefix + "odometry/time_s", {1, 2, 3});
    log.PutVector<double>(prefix + "odometry/turn_rad", {0, 0.1, 1.0 / 3});
    log.PutVector<double>(prefix + "odometry/forward_m", {1e-9, 1, 2});
    log.PutVector<double>(prefix + "observations/time_s",
                          first ? std::vector<double>{1, 2.5, 3} : std::vector<double>{});
    log.PutVector<std::int32_t>(prefix + "observations/landmark",
                                first ? std::vector<std::int32_t>{0, 0, -1} : std::vector<std::int32_t>{});
    log.PutVector<double>(
        prefix + "observations/range_m",
        first ? std::vector<double>{2, 1, std::numeric_limits<double>::quiet_NaN()} : std::vector<double>{});
    log.PutVector<double>(prefix + "observations/bearing_rad",
                          first ? std::vector<double>{0.5, 0, std::numeric_limits<double>::quiet_NaN()}
                                : std::vector<double>{});
  }
  log.PutScalar<double>("noise/range_m", 0.1);
  log.PutScalar<double>("noise/bearing_rad", 0.05);
  return log;
}

}  // namespace cairn::datasets
