// Which observation belongs to which landmark, in a result and in truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "datasets/evaluate/matching/align.h"
#include "schema/kinds/landmark_map.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {

// For each robot, for each observation, a landmark's index or -1.
using Associations = std::vector<std::vector<std::int32_t>>;

// robot/N/observations/map_landmark.
// Throws InputError where one is missing, is not as long as the log's observations, or names a landmark
// outside [-1, landmarks).
Associations ReadMapAssociations(const kinds::LandmarkMap& map, const kinds::Log& log, std::size_t landmarks);

// truth/robot/N/observations/landmark; nothing where a robot with observations lacks it.
// Throws InputError as above.
std::optional<Associations> ReadTrueAssociations(const kinds::Log& log, std::size_t landmarks);

// Which observations a map looked at: those that it has a landmark for, or says with some probability
// (robot/N/observations/probability) that it has none. Of the others, and of later data than it was made of,
// it says nothing.
std::vector<std::vector<bool>> ReadLookedAt(const kinds::LandmarkMap& map, const Associations& of);

// Which observations were contact detections, where the robot stood: those without a range.
std::vector<std::vector<bool>> ReadContacts(const kinds::Log& log, const Associations& map);

struct TopologyScore {
  bool correct = false;
  std::int64_t observations = 0;  // that are truly of a landmark
  std::int64_t unused = 0;        // of them those that the map did not look at, or has no landmark for
  std::int64_t associations = 0;  // that the map makes: observations that it has a landmark for
  std::int64_t wrong = 0;         // of them those that are truly of another landmark than most, or of nothing
};

// Correct: each of the map's `landmarks` has observations, and most of them are truly of one landmark,
// another one each; of each true landmark with observations there are some that the map looked at, and most
// of these are in that landmark of the map; no contact detection is wrong, nor held to be of nothing though
// it is of a landmark; and of the associations of range-bearing observations one in twenty is wrong at most
// (of things that stand closer together than one range-bearing observation is exact some are taken for one
// another on any map).
TopologyScore ScoreTopology(const Associations& map, const std::vector<std::vector<bool>>& looked_at,
                            const std::vector<std::vector<bool>>& contacts, const Associations& truth,
                            std::size_t landmarks);

// The true landmark that most observations of each map landmark belong to, where it has any.
IndexPairs MajorityPairs(const Associations& map, const Associations& truth, std::size_t landmarks);

}  // namespace cairn::datasets
