// The three similarities of a recorded and an immediate trace, feature by feature ([DM98] section 4.2): from
// -1 (incompatible) to 1 (the same), 0 meaning 'I don't know'. The paper gives no formulas; these are ours.
#pragma once

#include <numbers>
#include <span>

#include "pipelines/local_map/traces/edge_trace.h"

namespace cairn::local_map {

struct SimilarityOptions {
  double angle_rad = std::numbers::pi / 4;  // a gap between orientations that makes them incompatible
  double sigma_m = 0.06;                    // of the difference of two distances of the same edge
  double cross_sigma_m = 0.06;              // the same of edges across the way
  double most_cross_cells = 8;              // of an edge across the way count
  double missing = -0.3;  // an edge now, in a feature that was recorded with an edge on the other side only
};

// Of two distances, `off_m` apart, known as intervals of these widths: 1 where equal, -1 far apart.
float DistanceSimilarity(double off_m, double width_a_m, double width_b_m, double sigma_m);

// Of edge orientations only.
float EdgeSimilarity(const Side& recorded, const Side& now, const SimilarityOptions& options);

// Of the distances from left to right. Where a side has no edge now its closest occupied cell stands in, and
// a negative result becomes zero ([DM98] footnote 4).
float WidthSimilarity(const Feature& recorded, const Feature& now, const SimilarityOptions& options);

// Of where the edges lie, for a robot that stands so much `nearer_m` to them than the recorded way is.
// Footnote 4 as above.
float SideSimilarity(const Side& recorded, const Side& now, double nearer_m,
                     const SimilarityOptions& options);

// Where edges across the way lie along it, times the number of cells that both know of them: a feature placed
// at `at_z` (in cells, any fraction) of the recorded trace; `left`: which side.
float CrossSimilarity(const EdgeTrace& recorded, const Side& now, double at_z, bool left,
                      const SimilarityOptions& options);

// How a vector of similarities becomes one. Unknown ones (zero) do not count.
enum class Scheme {
  kAverage,   // the paper's: furniture that was moved spoils it
  kTrimmed,   // without the worst part: moved furniture is such a part
  kBestSide,  // where one side fits and the other does not, the side that fits
};

struct Total {
  double sum = 0;  // of those that count
  int known = 0;   // how many of them
  double mean() const { return known > 0 ? sum / known : 0; }
};

// `left` and `right` are [columns]; `trim` is the part that kTrimmed leaves out. They are reordered.
Total TotalOf(std::span<float> left, std::span<float> right, Scheme scheme, double trim);

}  // namespace cairn::local_map
