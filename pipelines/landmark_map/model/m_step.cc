#include "pipelines/landmark_map/model/m_step.h"

#include <algorithm>
#include <cmath>

namespace cairn::landmark_map {
namespace {

// c / (c + c* + prior): local to the perceptual radius. Without the prior any cell with nothing near it would
// hold a full landmark, however little is expected there.
Layer LocalRatio(const Layer& count, const MapRules& rules) {
  const Layer near = DiscSum(count, rules.radius_m / rules.grid.cell_m);
  Layer ratio(count.box);
  for (int y = count.box.y0; y < count.box.y0 + count.box.ny; ++y) {
    for (int x = count.box.x0; x < count.box.x0 + count.box.nx; ++x) {
      const double c = count.Row(y)[x];
      const double all = std::max(near.Row(y)[x], c);  // the disc holds the cell itself
      // [TBF98] eq. 19: all is how often something was observed there, landmark or none.
      if (c > 0.0) ratio.Row(y)[x] = c / (all + rules.prior_count);
    }
  }
  return ratio;
}

Layer Share(Layer count) {
  const double sum = count.Sum();
  // [TBF98] eq. 19 for a landmark that stands in one place
  for (double& value : count.values) value /= sum;
  return count;
}

// The chance of a false observation; per cell, or fine grids would stall.
double FalseRate(const MapRules& rules) {
  return std::min(0.5, rules.false_rate_per_m2 * rules.grid.cell_m * rules.grid.cell_m);
}

// eps + (1 - eps) * map, slightly blurred.
// Of a false observation's chance `outside` is what it seems to be.
Layer Mixture(const Layer& map, double sigma_cells, double eps, double outside) {
  Layer mixture = Blur(map, sigma_cells);
  for (double& value : mixture.values) value = std::fma(1.0 - eps, value, outside);
  return mixture;
}

// The same with the no-landmark evidence: exp(-lambda * map mass within the radius, outside the core).
// `seeming`: the part of the map that would seem as was observed.
Layer WithNoLandmark(const Layer& seeming, const Layer& map, const MapRules& rules) {
  const double cell = rules.grid.cell_m;
  const Layer wide = DiscSum(map, rules.radius_m / cell);
  const Layer core = DiscSum(map, rules.core_m / cell);
  const double outside = FalseRate(rules) / rules.classes.count;
  const Layer mixture = Mixture(seeming, rules.observation_m / cell, FalseRate(rules), outside);
  Layer likelihood(wide.box);
  for (int y = wide.box.y0; y < wide.box.y0 + wide.box.ny; ++y) {
    for (int x = wide.box.x0; x < wide.box.x0 + wide.box.nx; ++x) {
      const double seen = mixture.box.Contains(x, y) ? mixture.Row(y)[x] : outside;
      const double others = std::max(0.0, wide.Row(y)[x] - core.At(x, y));
      // [TBF98] eq. 3, the robust model
      likelihood.Row(y)[x] = seen * std::exp(-rules.no_landmark * others);
    }
  }
  return likelihood;
}

// Bernoulli cells: m_xi * product over the radius, the cell itself left out, of (1 - m).
Layer ExactLikelihood(const Layer& map, const MapRules& rules) {
  Layer log_absent(map.box), likelihood(map.box);
  constexpr double kSmallest = 1e-300;
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    log_absent.values[i] = std::log(std::max(kSmallest, 1.0 - map.values[i]));
  }
  const Layer sums = DiscSum(log_absent, rules.radius_m / rules.grid.cell_m);
  for (int y = map.box.y0; y < map.box.y0 + map.box.ny; ++y) {
    for (int x = map.box.x0; x < map.box.x0 + map.box.nx; ++x) {
      // [TBF98] eq. 3, the exact model
      likelihood.Row(y)[x] = map.Row(y)[x] * std::exp(sums.Row(y)[x] - log_absent.Row(y)[x]);
    }
  }
  return likelihood;
}

// What an observation without identity may be of, as often as it was observed.
Layer CountsOfWhatHasNoName(const LayeredGrid& counts, const MapRules& rules) {
  if (!rules.partly_named) return CountsOfAllClasses(counts, rules.types, rules.classes);
  return WeightedSum(counts, 0, std::vector<double>(counts.layers.size(), 1.0));
}

// Landmarks of all classes: where any is, then of which class it is.
void AddClasses(const LayeredGrid& counts, const MapRules& rules, double least, LayeredGrid* map) {
  const Layer count = CountsOfWhatHasNoName(counts, rules);
  if (!(count.Sum() > 0.0)) {
    map->layers.resize(static_cast<std::size_t>(rules.layers()));
    return;
  }
  for (Layer& layer : SplitAmongClasses(LocalRatio(count, rules), counts, rules.types,
                                        rules.core_m / rules.grid.cell_m, rules.classes)) {
    layer.Prune(least);
    map->layers.push_back(std::move(layer));
  }
}

// P(o | xi, m) for landmarks that seem of each class; a false one may seem of any.
void AddSeeming(const LayeredGrid& map, const MapRules& rules, Perception* perception) {
  const Layer all = CountsOfAllClasses(map, rules.types, rules.classes);
  for (int as = 0; as < rules.classes.count; ++as) {
    std::vector<double> seems;
    for (int is = 0; is < rules.classes.count; ++is) seems.push_back(rules.classes.Confusion(as, is));
    const Layer seeming = WeightedSum(map, rules.types, seems);
    const double false_one = FalseRate(rules) / rules.classes.count;
    if (all.box.empty())  // never seen so far: says nothing
      perception->likelihood.layers.emplace_back();
    else
      perception->likelihood.layers.push_back(rules.exact ? ExactLikelihood(seeming, rules)
                                                          : WithNoLandmark(seeming, all, rules));
    perception->outside.push_back(rules.exact && !all.box.empty() ? 0.0 : false_one);
  }
}

// Identities that nobody has seen so far, where the first robot gives none: each may be any landmark's.
void LookUpAmongAll(const MapRules& rules, Perception* perception) {
  if (!rules.named_later || rules.classes.count > 1) return;
  for (int layer = 0; layer < rules.layers(); ++layer)
    perception->look_up.push_back(
        perception->likelihood.layers[static_cast<std::size_t>(layer)].box.empty() ? rules.types : layer);
}

}  // namespace

LayeredGrid NoCounts(const MapRules& rules) {
  LayeredGrid counts;
  counts.layers.resize(static_cast<std::size_t>(rules.layers()));
  return counts;
}

LayeredGrid MapFromCounts(const LayeredGrid& counts, const MapRules& rules) {
  const double least = rules.exact ? 0.0 : 1e-3 * FalseRate(rules);
  LayeredGrid map;
  for (int type = 0; type < rules.types; ++type) {
    const Layer& count = counts.layers[static_cast<std::size_t>(type)];
    map.layers.push_back(count.Sum() > 0.0 ? Share(count) : Layer());
    map.layers.back().Prune(least);
  }
  AddClasses(counts, rules, least, &map);
  return map;
}

Perception MakePerception(const LayeredGrid& map, const MapRules& rules) {
  Perception perception;
  const double eps = FalseRate(rules);
  for (int type = 0; type < rules.types; ++type) {
    const Layer& layer = map.layers[static_cast<std::size_t>(type)];
    perception.likelihood.layers.push_back(
        layer.box.empty() ? Layer()  // never seen so far: says nothing
                          : Mixture(layer, rules.observation_m / rules.grid.cell_m, eps, eps));
    perception.outside.push_back(eps);
  }
  AddSeeming(map, rules, &perception);
  LookUpAmongAll(rules, &perception);
  return perception;
}

}  // namespace cairn::landmark_map
