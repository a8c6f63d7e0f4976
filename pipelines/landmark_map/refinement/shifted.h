// Landmarks that stand in a regular pattern and have no names: what a robot saw before a long way on which it
// saw nothing may be shifted by one spacing, and the map fits as well. Such maps are made, and weighed.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "pipelines/landmark_map/refinement/all_rows.h"
#include "pipelines/landmark_map/refinement/placing.h"

namespace cairn::landmark_map {

// What was seen from one time to another, moved so that most of its landmarks meet others.
struct Shift {
  double from_s = 0, until_s = 0;
  Point by = {};
  std::vector<std::pair<std::int32_t, std::int32_t>> meets;  // its landmarks, and those that they meet
  double behind_nats = 0;  // the map as it is over this one, by landmarks in common (placing.h)
  bool first = false;      // from where the robot began
};

// Those that are worth a least squares, the likeliest first: of what was seen before one of the three longest
// ways without landmarks, or between two, by the vector from a landmark to a neighbour, at most a quarter as
// long as the way. Three landmarks, and two of three, meet another. `rows`: a robot's, by time; `way_m`: how
// far it had come at each.
std::vector<Shift> FindShifts(const std::vector<PlacedRow>& rows, const std::vector<double>& way_m,
                              double sigma_m);

// The best other map of the kind, by how far it is behind.
struct WeighedShift {
  double from_s = 0, until_s = 0, by_m = 0;
  double lead_nats = 0;  // below 0: that one is ahead
  bool taken = false;    // the map is one that was shifted
};

// Of one robot's map: all shifts are fitted, and one that is three nats ahead takes the map's place. By the
// least squares, each under the widths that it finds, by landmarks in common, and by rows of no landmark.
// None where there is no such shift.
std::optional<WeighedShift> WeighShifts(const kinds::Log& log, const std::vector<AssociatedPath>& paths,
                                        const Settings& settings, std::vector<Landmark>* landmarks,
                                        std::vector<RowAssociations>* rows, JointRefinement* refined);

}  // namespace cairn::landmark_map
