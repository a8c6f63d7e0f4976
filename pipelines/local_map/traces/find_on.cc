#include "pipelines/local_map/traces/find_on.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

  Total SidesAt(int z, double du_m) const {
    return SidesScore(on, shift + z, on.at.u_m + du_m, options.score);
  }
  Surface Search(const SearchWindow& range) const;
  // Of all positions, and of none of them, in units of the best one's.
  double Mass(Surface& surface, double top) const;
  Candidate At(Surface& surface, int z, int u, double mass, double top) const;
};

Surface Finder::Search(const SearchWindow& range) const {
  const double cell_m = on.recorded.cell_m();
  Surface surface{static_cast<int>(std::ceil(range.z_m / cell_m)),
                  static_cast<int>(std::ceil(range.u_m / options.step_m)),
                  cell_m,
                  options.step_m,
                  {}};
  surface.score.resize(static_cast<std::size_t>((2 * surface.reach_z + 1) * (2 * surface.reach_u + 1)));
  for (int z = -surface.reach_z; z <= surface.reach_z; ++z) {
    // The sides say what the widths do, where z and u are sought together.
    const double score = EdgeScore(on, shift + z, options.score) + CrossScore(on, shift + z, options.score);
    for (int u = -surface.reach_u; u <= surface.reach_u; ++u) {
      const Total sides = SidesAt(z, u * options.step_m);
      surface.At(z, u) = sides.known < options.min_known ? kNever : score + sides.sum;
    }
  }
  return surface;
}

double Finder::Mass(Surface& surface, double top) const {
  double mass = 0;
  int known = 0;
  surface.ForEach([&](int z, int u, double score) {
    mass += std::exp(options.sharpness * (score - top));
    if (score == top) known = SidesAt(z, u * surface.step_u_m).known;
  });
  return mass + std::exp(options.sharpness * (options.null_score * known - top));
}

// The peak near the step (z, u), sought in finer ones.
Candidate Finder::At(Surface& surface, int z, int u, double mass, double top) const {
  Candidate found;
  found.score = surface.At(z, u);
  double near = 0, near_z = 0, near_u = 0;
  surface.ForEach([&](int other_z, int other_u, double score) {
    const double off_z = (other_z - z) * surface.step_z_m, off_u = (other_u - u) * surface.step_u_m;
    const double weight = std::exp(options.sharpness * (score - top));
    if (std::abs(off_z) <= options.apart_m) near_z += weight;
    if (std::abs(off_u) <= options.apart_m) near_u += weight;
    if (std::hypot(off_z, off_u) <= options.apart_m) near += weight;
  });
  found.confidence = near / mass;
  found.confidence_z = near_z / mass;
  found.confidence_u = near_u / mass;
  const Total sides = SidesAt(z, u * surface.step_u_m);
  found.sides = sides.mean();
  found.known = sides.known;
  OnTrace here = on;
  here.at = {(shift + z) * surface.step_z_m, on.at.u_m + u * surface.step_u_m};
  const Peak along =
      AlongProfileAt(here, here.at.u_m, options.apart_m, options.score).FindPeak(options.peak_sharpness);
  const double dz_m = std::isfinite(along.sd_m) ? along.at_m : 0;
  const Peak across =
      SidesProfile(here, dz_m, options.apart_m, options.score).FindPeak(options.peak_sharpness);
  found.z_m = here.at.z_m + dz_m;
  found.u_m = here.at.u_m + (std::isfinite(across.sd_m) ? across.at_m : 0);
  found.sd_z_m = std::hypot(along.sd_m, options.floor_sd_m);
  found.sd_u_m = std::hypot(across.sd_m, options.floor_sd_m);
  return found;
}

}  // namespace

std::vector<Candidate> FindOn(const EdgeTrace& recorded, const EdgeTrace& other, const Position& at,
                              const SearchWindow& range, const FindOptions& options) {
  const ImmediateTrace now{other, {}};
  const Finder finder{
      {recorded, now, at}, static_cast<int>(std::lround(at.z_m / recorded.cell_m())), options};
  Surface surface = finder.Search(range);
  const double top = *std::max_element(surface.score.begin(), surface.score.end());
  std::vector<Candidate> found;
  if (top == kNever) return found;
  const double mass = finder.Mass(surface, top);
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
