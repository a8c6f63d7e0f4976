// What people want of a posterior: poses, landmarks, and which observation was of which landmark.
#pragma once

#include <vector>

#include "pipelines/common/layered_grid.h"
#include "pipelines/landmark_map/model/m_step.h"
#include "schema/kinds/fields.h"

namespace cairn::landmark_map {

// One belief in numbers. Heading is the correction of the odometric one, in (-pi, pi].
struct PoseSummary {
  double x_m, y_m, heading_rad;  // mean (heading: circular)
  double covariance[9];          // x, y, heading
  // The most likely cell, refined by the mean over its neighbours.
  double mode_x_m, mode_y_m, mode_heading_rad;
  static void Fields(const auto& field) {
    field("x_m", &PoseSummary::x_m);
    field("y_m", &PoseSummary::y_m);
    field("heading_rad", &PoseSummary::heading_rad);
    field({"covariance", "P,3,3"}, &PoseSummary::covariance);
    field("mode_x_m", &PoseSummary::mode_x_m);
    field("mode_y_m", &PoseSummary::mode_y_m);
    field("mode_heading_rad", &PoseSummary::mode_heading_rad);
  }
};
PoseSummary Summarise(const LayeredGrid& belief, const GridSpec& grid);
Point MeanPosition(const LayeredGrid& belief, const GridSpec& grid);

// A landmark drawn from the expected counts.
struct Landmark {
  double x_m, y_m;
  double covariance_m2[4];
  int type;                // layer of the map; without identity: the first of those layers
  double count;            // expected number of observations of it
  int landmark_class = 0;  // without identity: the most likely one
  static void Fields(const auto& field) {
    field("x_m", &Landmark::x_m);
    field("y_m", &Landmark::y_m);
    field({"covariance_m2", "K,2,2"}, &Landmark::covariance_m2);
    field("type", &Landmark::type);
    field("count", &Landmark::count);
    field("landmark_class", &Landmark::landmark_class);
  }
};

// Throws InputError where one is none of the map's.
std::vector<Landmark> LandmarksIn(const Blob& blob, const MapRules& rules);

// Identified landmarks: one a type, the mean around the mode. Others: peaks of the counts, strongest first,
// each taking what lies within core_m of it; one with less than half an observation is none. Where
// observations are partly named those without identity that lie within core_m of an identified landmark are
// that one's, and so are fewer than two of them that lie within what that one's own scatter over.
std::vector<Landmark> ExtractLandmarks(const LayeredGrid& counts, const MapRules& rules);

// Takes a landmark out of the counts, all within core_m of it, and returns how much it took of each layer. A
// landmark without identity may have been taken for one of another class, and where observations are partly
// named an identified one for one without.
std::vector<double> LeaveOut(const Landmark& landmark, const MapRules& rules, LayeredGrid* counts);

// For one observation whose landmark stands where `where` says (mass one): the landmark that is most likely
// meant, and its probability; index -1 where it is more likely none of them (further than reach_m from all).
struct Association {
  int landmark = -1;
  double probability = 0.0;
};
// `type`: of those only that are of it; kOfAnyType: of all.
constexpr int kOfAnyType = -1;
Association Associate(const Layer& where, int type, const std::vector<Landmark>& landmarks, double cell_m,
                      double reach_m);

}  // namespace cairn::landmark_map
