#include "pipelines/landmark_map/model/landmark_classes.h"

#include <algorithm>
#include <cmath>

namespace cairn::landmark_map {

Layer WeightedSum(const LayeredGrid& grid, int first, const std::vector<double>& weights) {
  Layer sum;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    sum.Cover(grid.layers[static_cast<std::size_t>(first) + k].box);
  }
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const Layer& layer = grid.layers[static_cast<std::size_t>(first) + k];
    if (!layer.box.empty()) sum.AddShifted(layer, 0, 0, weights[k]);
  }
  return sum;
}

Layer CountsOfAllClasses(const LayeredGrid& counts, int first, const ClassRules& rules) {
  return WeightedSum(counts, first, std::vector<double>(static_cast<std::size_t>(rules.count), 1.0));
}

std::vector<double> ClassPosterior(const std::vector<double>& seemed, const ClassRules& rules) {
  std::vector<double> posterior;
  for (int is = 0; is < rules.count; ++is) {
    double log_likelihood = 0.0;
    for (int as = 0; as < rules.count; ++as) {
      // [TBF98] section 2.2: the robot might misjudge the type of a landmark.
      log_likelihood += seemed[static_cast<std::size_t>(as)] * std::log(rules.Confusion(as, is));
    }
    posterior.push_back(log_likelihood);
  }
  const double most = *std::ranges::max_element(posterior);
  double sum = 0.0;
  for (double& p : posterior) sum += p = std::exp(p - most);
  for (double& p : posterior) p /= sum;
  return posterior;
}

std::vector<Layer> SplitAmongClasses(const Layer& map, const LayeredGrid& counts, int first,
                                     double radius_cells, const ClassRules& rules) {
  if (rules.count == 1) return {map};
  const auto classes = static_cast<std::size_t>(rules.count);
  std::vector<Layer> near, split(classes, Layer(map.box));
  for (std::size_t k = 0; k < classes; ++k) {
    const Layer& count = counts.layers[static_cast<std::size_t>(first) + k];
    near.push_back(count.box.empty() ? Layer() : DiscSum(count, radius_cells));
  }
  std::vector<double> seemed(classes);
  for (int y = map.box.y0; y < map.box.y0 + map.box.ny; ++y) {
    for (int x = map.box.x0; x < map.box.x0 + map.box.nx; ++x) {
      if (!(map.Row(y)[x] > 0.0)) continue;
      for (std::size_t k = 0; k < classes; ++k) seemed[k] = near[k].At(x, y);
      const std::vector<double> posterior = ClassPosterior(seemed, rules);
      for (std::size_t k = 0; k < classes; ++k) split[k].Row(y)[x] = map.Row(y)[x] * posterior[k];
    }
  }
  return split;
}

}  // namespace cairn::landmark_map
