#include "datasets/evaluate/learning/feature_map.h"

#include <algorithm>
#include <utility>

#include "schema/error.h"
#include "schema/headings.h"

namespace cairn::datasets {
namespace {

using NearSample = std::pair<double, std::size_t>;  // distance, index: ties go to the first

std::vector<NearSample> Distances(const std::vector<Point>& positions, const Point& from) {
  std::vector<NearSample> distances;
  distances.reserve(positions.size());
  for (const Point& position : positions) distances.emplace_back(DistanceM(position, from), distances.size());
  return distances;
}

// What a window holds so far; it grows by one position after the other.
struct Held {
  explicit Held(std::size_t vectors) : error(vectors, 0.0), mass(vectors, 0.0) {}

  void Add(double distance_m, const double* probability) {
    ++positions;
    distance_sum += distance_m;
    for (std::size_t f = 0; f < mass.size(); ++f) {
      error[f] += distance_m * probability[f];
      mass[f] += probability[f];
    }
  }
  double PriorM() const { return distance_sum / static_cast<double>(positions); }
  double PosteriorM(std::size_t f) const { return mass[f] > 0 ? error[f] / mass[f] : PriorM(); }

  std::size_t positions = 0;
  double distance_sum = 0;
  std::vector<double> error, mass;  // [vectors]: of e P(f | xi), of P(f | xi)
};

WindowError ErrorOf(const Held& held, std::span<const double> probability,
                    const std::vector<std::size_t>& drawn) {
  WindowError out;
  out.positions = held.positions;
  if (held.positions == 0) return out;
  out.prior_m = held.PriorM();
  // [Thr98] eq. 36, the sum over f for one true position
  for (std::size_t f = 0; f < probability.size(); ++f) out.soft_m += probability[f] * held.PosteriorM(f);
  for (const std::size_t f : drawn) out.sampled_m.push_back(held.PosteriorM(f));
  return out;
}

}  // namespace

std::vector<double> FeatureProbabilities(std::span<const double> g) {
  std::vector<double> probability(std::size_t{1} << g.size(), 1.0);
  for (std::size_t f = 0; f < probability.size(); ++f) {
    // [Thr98] eqs 32, 33
    for (std::size_t i = 0; i < g.size(); ++i) probability[f] *= (f >> i & 1) != 0 ? g[i] : 1.0 - g[i];
  }
  return probability;
}

FeatureMap MapByNearest(const std::vector<Point>& positions, std::span<const double> output,
                        std::size_t networks, std::size_t nearest, const std::vector<double>& heading_rad) {
  CAIRN_DEMAND(nearest >= 1 && nearest <= positions.size(), "no such number of nearest samples");
  CAIRN_DEMAND(heading_rad.empty() || heading_rad.size() == positions.size(), "a heading for each position");
  FeatureMap map{.positions = positions,
                 .vectors = std::size_t{1} << networks,
                 .probability = {},
                 .heading_rad = heading_rad};
  for (std::size_t k = 0; k < positions.size(); ++k) {
    std::vector<NearSample> near = Distances(positions, positions[k]);
    if (!heading_rad.empty())
      std::erase_if(near,
                    [&](const NearSample& n) { return !FaceAlike(heading_rad[n.second], heading_rad[k]); });
    const std::size_t count = std::min(nearest, near.size());
    std::ranges::partial_sort(near, near.begin() + static_cast<std::ptrdiff_t>(count));
    std::vector<double> mean(networks, 0.0);
    for (std::size_t j = 0; j < count; ++j) {
      for (std::size_t i = 0; i < networks; ++i) mean[i] += output[near[j].second * networks + i];
    }
    // [Thr98] section 5.1.6
    for (double& g : mean) g /= static_cast<double>(count);
    const std::vector<double> probability = FeatureProbabilities(mean);
    map.probability.insert(map.probability.end(), probability.begin(), probability.end());
  }
  return map;
}

std::vector<WindowError> ErrorsInMap(const FeatureMap& map, const Point& truth,
                                     std::span<const double> probability,
                                     const std::vector<std::size_t>& drawn,
                                     const std::vector<double>& windows_m, const KnownHeading& known) {
  std::vector<NearSample> near = Distances(map.positions, truth);
  if (!map.heading_rad.empty())
    std::erase_if(near, [&](const NearSample& n) {
      return TurnBetween(map.heading_rad[n.second], known.heading_rad) > known.window_rad;
    });
  std::ranges::sort(near);
  Held held(map.vectors);
  std::vector<WindowError> errors;
  auto next = near.begin();
  for (const double window_m : windows_m) {
    for (; next != near.end() && next->first <= window_m; ++next)
      held.Add(next->first, &map.probability[next->second * map.vectors]);
    errors.push_back(ErrorOf(held, probability, drawn));
  }
  return errors;
}

}  // namespace cairn::datasets
