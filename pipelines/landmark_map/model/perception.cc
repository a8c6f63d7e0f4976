#include "pipelines/landmark_map/model/perception.h"

#include <cmath>
#include <numbers>

#include "pipelines/common/handed_over.h"

namespace cairn::landmark_map {
namespace {

// A vector of the odometric frame as seen by layer c, in whole cells and weights of the four cells around its
// end.
struct Offset {
  int dx, dy;
  double weight[4];  // (0,0), (1,0), (0,1), (1,1)
};

Offset OffsetOf(const Observation& o, const GridSpec& grid, int layer) {
  const double angle = layer * 2.0 * std::numbers::pi / grid.headings;
  const double x = (std::cos(angle) * o.x_m - std::sin(angle) * o.y_m) / grid.cell_m;
  const double y = (std::sin(angle) * o.x_m + std::cos(angle) * o.y_m) / grid.cell_m;
  const double fx = std::floor(x), fy = std::floor(y), ax = x - fx, ay = y - fy;
  return {static_cast<int>(fx),
          static_cast<int>(fy),
          {(1 - ax) * (1 - ay), ax * (1 - ay), (1 - ax) * ay, ax * ay}};
}

// The likelihood table over `wanted`, with its outside value where it has none.
Layer Padded(const Layer& table, double outside, const Box& wanted) {
  Layer padded(wanted);
  padded.values.assign(padded.values.size(), outside);
  const Box common = Intersection(wanted, table.box);
  for (int y = common.y0; y < common.y0 + common.ny; ++y) {
    const RowOf<const double> from = table.Row(y);
    const RowOf<double> to = padded.Row(y);
    for (int x = common.x0; x < common.x0 + common.nx; ++x) to[x] = from[x];
  }
  return padded;
}

void MultiplyByLookup(const Layer& table, const Offset& offset, Layer* layer) {
  const int begin = layer->box.x0, end = begin + layer->box.nx;
  for (int y = layer->box.y0; y < layer->box.y0 + layer->box.ny; ++y) {
    const RowOf<const double> low = table.Row(y + offset.dy) + offset.dx;
    const RowOf<const double> high = table.Row(y + offset.dy + 1) + offset.dx;
    const RowOf<double> row = layer->Row(y);
    for (int x = begin; x < end; ++x) {
      const double below = std::fma(offset.weight[1], low[x + 1], offset.weight[0] * low[x]);
      row[x] *= std::fma(offset.weight[3], high[x + 1], std::fma(offset.weight[2], high[x], below));
    }
  }
}

}  // namespace

void Perception::Check(int layers) const {
  RequireSize("likelihood", likelihood.layers.size(), static_cast<std::size_t>(layers));
  RequireSize("outside", outside.size(), likelihood.layers.size());
  if (!look_up.empty()) RequireSize("look_up", look_up.size(), likelihood.layers.size());
  RequireAllWithin("look_up", look_up, std::int64_t{0}, std::int64_t{layers} - 1);
}

Perception NamesAlone(Perception perception, int names) {
  for (std::size_t k = static_cast<std::size_t>(names); k < perception.likelihood.layers.size(); ++k)
    perception.likelihood.layers[k] = Layer();
  return perception;
}

Box PlacesThatSee(const Observation& observation, const GridSpec& grid, const Perception& perception,
                  int layer) {
  const Box& table = perception.Of(observation.type).box;
  if (table.empty()) return {};
  const Offset offset = OffsetOf(observation, grid, layer);
  Box places = table.Shifted(-offset.dx - 1, -offset.dy - 1);
  ++places.nx;
  ++places.ny;
  return places;
}

void Observe(const Observation& observation, const GridSpec& grid, const Perception& perception,
             LayeredGrid* belief) {
  const Layer& table = perception.Of(observation.type);
  if (table.box.empty()) return;  // never seen so far: says nothing
  const double outside = perception.OutsideOf(observation.type);
  for (int c = 0; c < grid.headings; ++c) {
    Layer& layer = belief->layers[c];
    if (layer.box.empty()) continue;
    const Offset offset = OffsetOf(observation, grid, c);
    Box seen = layer.box.Shifted(offset.dx, offset.dy);
    seen.nx += 1;
    seen.ny += 1;
    const bool inside = Intersection(seen, table.box) == seen;
    // [TBF98] eqs 3, 4: times P(o | xi, m); Settle normalises
    if (inside)
      MultiplyByLookup(table, offset, &layer);
    else
      MultiplyByLookup(Padded(table, outside, seen), offset, &layer);
  }
}

void Count(const Observation& observation, const GridSpec& grid, const LayeredGrid& belief,
           LayeredGrid* counts) {
  Layer& count = counts->layers[observation.type];
  Box reach;
  for (int c = 0; c < grid.headings; ++c) {
    const Layer& layer = belief.layers[c];
    if (layer.box.empty()) continue;
    const Offset offset = OffsetOf(observation, grid, c);
    Box seen = layer.box.Shifted(offset.dx, offset.dy);
    seen.nx += 1;
    seen.ny += 1;
    reach = Union(reach, seen);
  }
  count.Cover(reach);
  for (int c = 0; c < grid.headings; ++c) {
    const Layer& layer = belief.layers[c];
    if (layer.box.empty()) continue;
    const Offset offset = OffsetOf(observation, grid, c);
    for (int k = 0; k < 4; ++k) {
      // [TBF98] eqs 19 to 21: P(m_xy = l | o, xi) is one where o puts the landmark, shared among four cells.
      if (offset.weight[k] > 0)
        count.AddShifted(layer, offset.dx + k % 2, offset.dy + k / 2, offset.weight[k]);
    }
  }
}

}  // namespace cairn::landmark_map
