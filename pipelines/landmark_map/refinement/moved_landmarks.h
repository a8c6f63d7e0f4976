// Landmarks with an identity that somebody moved while the log was made: until some time they stand in one
// place, from then on in another, and all others stay.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/landmark_map/refinement/contradictions.h"
#include "pipelines/landmark_map/refinement/joint_refinement.h"
#include "pipelines/landmark_map/refinement/refine.h"

namespace cairn::landmark_map {

struct MovedLandmark {
  std::int32_t type = 0;
  // The last observation where it stood first, the first one where it is then.
  double until_s = 0, from_s = 0;
  // The map has it where more of it is expected, and is made without the rest.
  std::uint8_t later_left_out = 1;
  std::int64_t left_out = 0;  // rows of the log: WithoutLeftOut counts them

  bool LeavesOut(double time_s) const { return (time_s > 0.5 * (until_s + from_s)) == (later_left_out != 0); }
  // As schema/FORMAT.md has it, under `moved/`.
  static void Fields(const auto& field) {
    field("landmark", &MovedLandmark::type);
    field("until_s", &MovedLandmark::until_s);
    field("from_s", &MovedLandmark::from_s);
    field("left_out", &MovedLandmark::left_out);
    field("later_left_out", &MovedLandmark::later_left_out);
  }
};

// When the landmarks in two places (`found`, of EM) were moved, by EM's paths.
// Throws InputError with the first reason where not all of them were: their observations in the two places
// take turns; not more than twice as many others stay where they were meanwhile; or another landmark stands,
// or stood, in one of the two places, and names were exchanged.
std::vector<MovedLandmark> FindMoved(const std::vector<InTwoPlaces>& found,
                                     const std::vector<AssociatedPath>& paths,
                                     const std::vector<Landmark>& landmarks, const MapRules& rules);

// The log without the names of what is left out, which it counts.
Blob WithoutLeftOut(Blob log, std::size_t robots, std::vector<MovedLandmark>* moved);

// RefineWithAllRows, if it `refines`, of a log some of whose landmarks may be `in_two_places`; once more
// without what is left out of those that were moved, which it returns. Throws InputError as FindMoved does,
// and where a landmark stays in two places nevertheless.
std::vector<MovedLandmark> RefineAllThatStayed(const Blob& log, const std::vector<AssociatedPath>& paths,
                                               const Settings& settings,
                                               const std::vector<InTwoPlaces>& in_two_places, bool refines,
                                               std::vector<Landmark>* landmarks,
                                               std::vector<RowAssociations>* rows, JointRefinement* refined);

}  // namespace cairn::landmark_map
