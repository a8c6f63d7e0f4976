// What the tests of a landmark map's verdict share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/verdicts/landmark_map_verdict.h"
#include "schema/blob.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {

// A map that so many of twelve starts found, so far ahead of the next different one.
inline Blob Searched(int support, double lead_nats) {
  Blob result;
  result.PutScalar<std::int32_t>("search/support", support);
  result.PutScalar<std::int32_t>("search/starts", 12);
  result.PutScalar<double>("search/lead_nats", lead_nats);
  result.Put("search/unlike", Array::Texts({}));
  return result;
}

// With so many of `observations` misfits, and a map whose landmarks have names.
inline Blob FittedMap(std::int64_t observations, std::int64_t misfits, std::int64_t run, std::int64_t jumps,
                      double worst_sigmas = 4, double range_found_m = 0.1) {
  kinds::LandmarkMap map;
  map.robots = std::vector<std::string>{"robot"};
  map.robot.resize(1);
  map.robot[0].map_landmark = std::vector<std::int32_t>(static_cast<std::size_t>(observations), 0);
  map.map.landmark_identity = std::vector<std::int32_t>{0};
  map.fit.observations = observations;
  map.fit.misfits = misfits;
  map.fit.longest_run = run;
  map.fit.longest_run_from_s = 12.5;
  map.fit.odometry_misfits = jumps;
  map.fit.worst_odometry_s = 20.0;
  map.fit.worst_sigmas = std::vector<double>{worst_sigmas};
  map.fit.worst_time_s = std::vector<double>{7.0};
  map.fit.kind = std::vector<std::string>{"range"};
  map.fit.stated = std::vector<double>{0.1};
  map.fit.found = std::vector<double>{range_found_m};
  return BlobOf(map);
}

inline std::string TextOf(const Blob& result) { return LandmarkMapVerdict(result).Text(); }

}  // namespace cairn::datasets
