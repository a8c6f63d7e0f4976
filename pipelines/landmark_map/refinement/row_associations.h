// Which landmark each row of a log is of, once the path is known. EM looks at one image a frame where
// observations name no landmark; what it leaves out is told apart here.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/landmark_map/refinement/refine.h"
#include "pipelines/landmark_map/refinement/refined_path.h"
#include "schema/kinds/log.h"

namespace cairn::landmark_map {

// Of each row of a robot's observations: its landmark, -1 for none, and how likely it is of that one.
struct RowAssociations {
  std::vector<std::int32_t> landmark;
  std::vector<double> probability;
};

// The landmark of that name, or -1.
int LandmarkNamed(const std::vector<Landmark>& landmarks, int identity);

// What EM says of the rows that it used. Of those before the robot's first step each that has a name is of
// the landmark of that name.
RowAssociations RowsOfEm(const AssociatedPath& path, const kinds::Log::Observations& seen,
                         const std::vector<Landmark>& landmarks);

// The same `rows`, but for range-bearing ones without a name: each is of that landmark which, seen from the
// refined path, it is likelier of than of all others and none. An image shows no landmark twice; what it
// shows best is given first.
RowAssociations RowsSeenFrom(const RefinedPath& refined, RowAssociations rows,
                             const kinds::Log::Observations& seen, const std::vector<Landmark>& landmarks,
                             const ObservationNoise& noise, double until_s);

// Which landmarks stay: not one without a name within `reach_m` of another that has more rows, if hardly an
// image shows both, and none that has fewer than two rows. `seen`, `rows`: of each robot.
std::vector<bool> WithoutDoubles(const std::vector<Landmark>& landmarks, int names,
                                 const std::vector<const kinds::Log::Observations*>& seen,
                                 const std::vector<RowAssociations>& rows, double reach_m);

}  // namespace cairn::landmark_map
