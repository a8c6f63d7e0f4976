#include "pipelines/local_map/find_on.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cairn::local_map {
namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();

// Scores over whole steps of z (a cell each) and u.
struct Surface {
  int reach_z, reach_u;
  double step_z_m, step_u_m;
  std::vector<double> score;

  double& At(int z, int u) {
    return score[static_cast<std::size_t>(z + reach_z) * static_cast<std::size_t>(2 * reach_u + 1) +
                 static_cast<std::size_t>(u + reach_u)];
  }
  // Visits all (z, u) with their scores.
  template <class Visit>
  void ForEach(Visit&& visit) {
    for (int z = -reach_z; z <= reach_z; ++z)
      for (int u = -reach_u; u <= reach_u; ++u) visit(z, u, At(z, u));
  }
};

struct Finder {
  OnTrace on;
  int shift;  // features, from the assumed position
  const FindOptions& options;

  Total SidesAt(int z, double du_m) const { return Sides(on, shift + z, on.at.u_m + du_m, options.score); }
  Surface Search(const Range& range) const;
  Candidate At(Surface& surface, int z, int u, double mass, double top) const;
};

Surface Finder::Search(const Range& range) const {
  const double cell_m = on.recorded.cell_m();
  Surface surface{static_cast<int>(std::ceil(range.z_m / cell_m)),
                  static_cast<int>(std::ceil(range.u_m / options.step_m)),
                  cell_m,
                  options.step_m,
                  {}};
  surface.score.resize(static_cast<std::size_t>((2 * surface.reach_z + 1) * (2 * surface.reach_u + 1)));
  ScoreOptions along = options.score;
  along.width_weight = 0;  // the sides say it, where z and u are sought together
  for (int z = -surface.reach_z; z <= surface.reach_z; ++z) {
    const double score = EdgeAndWidth(on, shift + z, along) + Cross(on, shift + z, along);
    for (int u = -surface.reach_u; u <= surface.reach_u; ++u) {
      const Total sides = SidesAt(z, u * options.step_m);
      surface.At(z, u) = sides.known < options.min_known ? kNever : score + sides.sum;
    }
  }
  return surface;
}

// The peak between the steps around (z, u), and the spread of what lies within apart_m of it.
Candidate Finder::At(Surface& surface, int z, int u, double mass, double top) const {
  Candidate found;
  const auto vertex = [&](double before, double middle, double after) {
    return std::isfinite(before) && std::isfinite(after) ? Vertex(before, middle, after) : 0;
  };
  const double middle = surface.At(z, u);
  double dz = z, du = u;
  if (std::abs(z) < surface.reach_z) dz += vertex(surface.At(z - 1, u), middle, surface.At(z + 1, u));
  if (std::abs(u) < surface.reach_u) du += vertex(surface.At(z, u - 1), middle, surface.At(z, u + 1));
  double near = 0, spread_z = 0, spread_u = 0;
  surface.ForEach([&](int other_z, int other_u, double score) {
    const double off_z = (other_z - dz) * surface.step_z_m, off_u = (other_u - du) * surface.step_u_m;
    if (std::hypot(off_z, off_u) > options.apart_m) return;
    const double weight = std::exp(options.sharpness * (score - top));
    near += weight;
    spread_z += weight * off_z * off_z;
    spread_u += weight * off_u * off_u;
  });
  const Total sides = SidesAt(z, u * surface.step_u_m);
  found.z_m = (shift + dz) * surface.step_z_m;
  found.u_m = on.at.u_m + du * surface.step_u_m;
  found.sd_z_m = std::sqrt(spread_z / near);
  found.sd_u_m = std::sqrt(spread_u / near);
  found.score = middle;
  found.sides = sides.mean();
  found.known = sides.known;
  found.confidence = near / mass;
  // As flat as the neighbourhood: not determined.
  for (double* sd : {&found.sd_z_m, &found.sd_u_m})
    if (*sd > 0.45 * options.apart_m) *sd = std::numeric_limits<double>::infinity();
  return found;
}

}  // namespace

std::vector<Candidate> FindOn(const EdgeTrace& recorded, const EdgeTrace& other, const Position& at,
                              const Range& range, const FindOptions& options) {
  const ImmediateTrace now{other, {}};
  const Finder finder{
      {recorded, now, at}, static_cast<int>(std::lround(at.z_m / recorded.cell_m())), options};
  Surface surface = finder.Search(range);
  const double top = *std::max_element(surface.score.begin(), surface.score.end());
  std::vector<Candidate> found;
  if (top == kNever) return found;
  double mass = std::exp(options.sharpness * (options.null_score - top));
  for (const double score : surface.score) mass += std::exp(options.sharpness * (score - top));
  Surface left = surface;
  for (int k = 0; k < options.max_candidates; ++k) {
    int best_z = 0, best_u = 0;
    double best = kNever;
    left.ForEach([&](int z, int u, double score) {
      if (score <= best) return;
      best = score;
      best_z = z;
      best_u = u;
    });
    if (best == kNever) break;
    found.push_back(finder.At(surface, best_z, best_u, mass, top));
    left.ForEach([&](int z, int u, double& score) {
      const double off_z = (z - best_z) * surface.step_z_m, off_u = (u - best_u) * surface.step_u_m;
      if (std::hypot(off_z, off_u) <= options.apart_m) score = kNever;
    });
  }
  return found;
}

}  // namespace cairn::local_map
