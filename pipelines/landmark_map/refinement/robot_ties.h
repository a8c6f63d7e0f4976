// What holds the robots of a map together, and the halves of a path before and after a hole in the odometry:
// landmarks in common.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipelines/landmark_map/refinement/joint_refinement.h"
#include "pipelines/landmark_map/refinement/placing.h"
#include "pipelines/landmark_map/refinement/row_associations.h"
#include "schema/blob.h"
#include "schema/kinds/log.h"
#include "schema/kinds/odometry_holes.h"

namespace cairn::landmark_map {

struct Tie {
  // Landmarks that both sides have seen twice at least.
  std::int64_t shared = 0;
  // That one side alone has seen though the other looked there, and by how many nats they are likelier to lie
  // so than otherwise (placing.h). None where names say it, of two landmarks or more, and landmarks without
  // do not say by kTiedNats that it is elsewhere.
  std::optional<std::int64_t> one_sided = {};
  std::optional<double> lead_nats = {};
  std::optional<double> odds_nats = {};  // Placings::OddsNats
};

// From so many nats on a place is held for sure enough.
inline constexpr double kTiedNats = 10;

// The rows of each robot at a range and bearing, from its refined path.
std::vector<std::vector<PlacedRow>> PlacedRows(const kinds::Log& log, const JointRefinement& refined,
                                               const std::vector<RowAssociations>& rows, double until_s);

// How far off landmarks are that two sides see: by what ranges and bearings were found to err.
double TieSigma_m(const std::vector<std::vector<PlacedRow>>& rows, const ModelFit& fit);

// Of each robot to the others; where those do not hang together either, to the most that do, which are each
// tied to the rest of them. None of a single robot. `named`: of each landmark, whether it has a name.
std::vector<Tie> TiesOfRobots(const std::vector<std::vector<PlacedRow>>& rows, const std::vector<bool>& named,
                              double sigma_m);

// Robots that hold less together as they are than with one of them, or some that hang together, in another
// place, by kTiedNats nats: all landmarks, where they are then. None where there are no such robots.
std::optional<std::vector<Landmark>> PlacedAnew(const std::vector<std::vector<PlacedRow>>& rows,
                                                const std::vector<Landmark>& landmarks, int names,
                                                double sigma_m);

// Of what a robot saw up to a time to what it saw after.
Tie TieAcross(double time_s, const std::vector<PlacedRow>& rows, const std::vector<bool>& named,
              double sigma_m);

// As schema/FORMAT.md has them: `robot/N/shared_landmarks` and what belongs to it, and `holes/` where the
// odometry lacks some way, the latter only of landmarks seen at a distance, as is `fit/few_common_lead_nats`.
void PutTies(const Blob& log, const JointRefinement& refined, const std::vector<RowAssociations>& rows,
             const std::vector<Landmark>& landmarks, const Settings& settings, Blob* result);

}  // namespace cairn::landmark_map
