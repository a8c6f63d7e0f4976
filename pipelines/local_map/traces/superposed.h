// A trace laid upon a recorded one: the summed similarities at a position ([DM98] section 4.2).
#pragma once

#include "pipelines/local_map/traces/edge_trace.h"
#include "pipelines/local_map/traces/profile.h"
#include "pipelines/local_map/traces/similarity.h"

namespace cairn::local_map {

inline constexpr int kMaxFeatures = 256;  // of the trace that is laid upon another: room on the stack

struct ScoreOptions {
  SimilarityOptions similarity;
  Scheme scheme = Scheme::kBestSide;
  double trim = 0.2;        // of the similarities, for kTrimmed
  double width_weight = 1;  // of the width similarity and of edges across the way, beside the edge
  double cross_weight = 1;  // similarity's 1, where z is sought
};

// `now`, with the robot assumed at `at` in the recorded trace's frame; both run the same way.
struct OnTrace {
  const EdgeTrace& recorded;
  const ImmediateTrace& now;
  Position at;

  // From the immediate trace's features to the recorded one's, in cells, where the robot is at `z_m`.
  double ShiftOf(double z_m) const { return (z_m - now.robot.z_m) / recorded.cell_m(); }
};

// Summed similarities of edges and of widths, shifted by a whole number of features.
double EdgeScore(const OnTrace& on, int shift, const ScoreOptions& options);
double WidthScore(const OnTrace& on, int shift, const ScoreOptions& options);
// Of edges across the way, shifted by any number.
double CrossScore(const OnTrace& on, double shift, const ScoreOptions& options);
// Of the sides, with the robot at `u_m`.
Total SidesScore(const OnTrace& on, int shift, double u_m, const ScoreOptions& options);

// What decides z: edge, width and cross similarity over corrections of z in quarters of a cell.
Profile AlongProfile(const OnTrace& on, double range_m, const ScoreOptions& options);
// The same once u is known, to be `u_m`: the sides similarity instead of the width, which furniture on one
// side spoils for both.
Profile AlongProfileAt(const OnTrace& on, double u_m, double range_m, const ScoreOptions& options);
// What decides u: the sides similarity over corrections of u, with z corrected by `dz_m`.
Profile SidesProfile(const OnTrace& on, double dz_m, double range_m, const ScoreOptions& options);

}  // namespace cairn::local_map
