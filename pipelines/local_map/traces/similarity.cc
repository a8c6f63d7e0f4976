#include "pipelines/local_map/traces/similarity.h"

#include <algorithm>
#include <cmath>

namespace cairn::local_map {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// How far apart two intervals of angles modulo pi are; 0 where they overlap.
float AngleGap(const Interval& a, const Interval& b) {
  const float apart = std::abs(std::remainder(a.centre() - b.centre(), kPi));
  return std::max(0.0F, apart - 0.5F * (a.width() + b.width()));
}

// The distance that the immediate trace has on a side, its width, and whether it comes from occupancy.
struct Distance {
  float at_m, width_m;
  bool from_occupancy;
  bool known() const { return at_m == at_m; }
};

bool RunsAlong(const Side& side) { return side.known() && std::abs(side.angle_rad.centre()) <= 0.3F * kPi; }

Distance DistanceOf(const Side& side) {
  if (RunsAlong(side)) return {side.distance_m.centre(), side.distance_m.width(), false};
  return {side.nearest_m, 0, true};
}

float Agreement(const Side& recorded, const Side& now) {
  return recorded.occupied == now.occupied ? 1.0F : 0.7F;
}

Total Sum(std::span<const float> values) {
  Total total;
  for (const float s : values)
    if (s != 0) {
      total.sum += s;
      ++total.known;
    }
  return total;
}

// Moves the known values to the front.
std::span<float> Known(std::span<float> values) {
  return values.first(
      static_cast<std::size_t>(std::remove(values.begin(), values.end(), 0.0F) - values.begin()));
}

// Drops the worst part of both sides taken together.
Total Trimmed(std::span<float> left, std::span<float> right, double trim) {
  left = Known(left);
  right = Known(right);
  std::sort(left.begin(), left.end());
  std::sort(right.begin(), right.end());
  auto drop = static_cast<std::size_t>(trim * static_cast<double>(left.size() + right.size()));
  std::size_t l = 0, r = 0;
  for (; drop > 0; --drop) {
    const bool from_left = r >= right.size() || (l < left.size() && left[l] <= right[r]);
    ++(from_left ? l : r);
  }
  Total total = Sum(left.subspan(l));
  const Total other = Sum(right.subspan(r));
  total.sum += other.sum;
  total.known += other.known;
  return total;
}

}  // namespace

float DistanceSimilarity(double off_m, double width_a_m, double width_b_m, double sigma_m) {
  // A uniform interval has a variance of width^2 / 12.
  const double variance = sigma_m * sigma_m + (width_a_m * width_a_m + width_b_m * width_b_m) / 12;
  // [DM98] section 4.2: a similarity is negative or positive, and zero where nothing is known.
  return 2 * std::exp(static_cast<float>(-0.5 * off_m * off_m / variance)) - 1;
}

float EdgeSimilarity(const Side& recorded, const Side& now, const SimilarityOptions& options) {
  if (!now.known()) return 0;
  if (!recorded.known()) return 0;
  const float gap = AngleGap(recorded.angle_rad, now.angle_rad) / static_cast<float>(options.angle_rad);
  return (1 - 2 * std::min(1.0F, gap)) * Agreement(recorded, now);
}

float WidthSimilarity(const Feature& recorded, const Feature& now, const SimilarityOptions& options) {
  if (!RunsAlong(recorded.left) || !RunsAlong(recorded.right)) return 0;
  const Distance left = DistanceOf(now.left), right = DistanceOf(now.right);
  if (!left.known() || !right.known()) return 0;
  const float then_m = recorded.left.distance_m.centre() + recorded.right.distance_m.centre();
  const float s = DistanceSimilarity(left.at_m + right.at_m - then_m, left.width_m + right.width_m,
                                     recorded.left.distance_m.width() + recorded.right.distance_m.width(),
                                     std::numbers::sqrt2 * options.sigma_m);
  return left.from_occupancy || right.from_occupancy ? std::max(0.0F, s) : s;
}

float SideSimilarity(const Side& recorded, const Side& now, double nearer_m,
                     const SimilarityOptions& options) {
  if (!RunsAlong(recorded)) return 0;
  const Distance distance = DistanceOf(now);
  if (!distance.known()) return 0;
  const float s = DistanceSimilarity(distance.at_m + nearer_m - recorded.distance_m.centre(),
                                     distance.width_m, recorded.distance_m.width(), options.sigma_m);
  // [DM98] footnote 4: what occupancy contradicts is ignored.
  return distance.from_occupancy ? std::max(0.0F, s) : s;
}

float CrossSimilarity(const EdgeTrace& recorded, const Side& now, double at_z, bool left,
                      const SimilarityOptions& options) {
  if (now.cross_m != now.cross_m) return 0;
  const double cell_m = recorded.cell_m(), at_m = at_z * cell_m + now.cross_m;
  const int middle = static_cast<int>(std::lround(at_m / cell_m));
  double nearest_m = INFINITY;
  float cells = now.cross_cells;
  bool seen = false;
  for (int z = middle - 2; z <= middle + 2; ++z) {
    const Feature* feature = recorded.Find(z);
    if (!feature) continue;
    const Side& side = left ? feature->left : feature->right;
    seen = seen || (z == middle && side.known());
    const double off_m = std::abs(z * cell_m + side.cross_m - at_m);
    if (!(off_m < nearest_m)) continue;  // also where there is none
    nearest_m = off_m;
    cells = std::min(now.cross_cells, side.cross_cells);
  }
  const float witnesses = std::min(cells, static_cast<float>(options.most_cross_cells));
  if (std::isinf(nearest_m)) return seen ? static_cast<float>(options.missing) : 0.0F;
  return witnesses * DistanceSimilarity(nearest_m, 0, 0, options.cross_sigma_m);
}

Total TotalOf(std::span<float> left, std::span<float> right, Scheme scheme, double trim) {
  if (scheme == Scheme::kTrimmed) return Trimmed(left, right, trim);
  const Total l = Sum(left), r = Sum(right);
  // [DM98] section 4.2: 'If the left side matches relevantly but there is an incompatible area on the right
  // side, this may indicate a modification of the environment rather than poor matching.'
  if (scheme == Scheme::kBestSide && l.known > 0 && r.known > 0 && (l.sum > 0) != (r.sum > 0))
    return l.sum > 0 ? l : r;
  return {l.sum + r.sum, l.known + r.known};
}

}  // namespace cairn::local_map
