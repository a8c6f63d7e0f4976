// P(o | xi, m) of [TBF98] section 2.2 as one table a landmark type, and the M-step's expected counts.
#pragma once

#include "pipelines/common/layered_grid.h"
#include "pipelines/landmark_map/model/steps.h"
#include "schema/kinds/fields.h"

namespace cairn::landmark_map {

// The grid of a job.
struct GridSpec {
  double cell_m = 1.0;
  int headings = 72;  // layers of a belief: corrections of the odometric heading
};

// For each landmark type (the last layers: identity unknown, by the kind that it seems of) the likelihood of
// observing it at a cell, up to a factor; `outside[type]` is its value outside the layer's box. Made by the
// M-step, read by every task.
struct Perception {
  LayeredGrid likelihood;
  std::vector<double> outside;
  // [types]: the layer to look a type up in; empty: each has its own.
  std::vector<std::int32_t> look_up;

  std::size_t LayerOf(int type) const {
    const auto own = static_cast<std::size_t>(type);
    return look_up.empty() ? own : static_cast<std::size_t>(look_up[own]);
  }
  const Layer& Of(int type) const { return likelihood.layers[LayerOf(type)]; }
  double OutsideOf(int type) const { return outside[LayerOf(type)]; }
  // Throws InputError where it is none of so many layers.
  void Check(int layers) const;
  static void Fields(const auto& field) {
    field("likelihood", &Perception::likelihood);
    field("outside", &Perception::outside);
    field("look_up", &Perception::look_up);
  }
};

// The cells of layer `layer` from which the observation would fall into the map's table.
Box PlacesThatSee(const Observation& observation, const GridSpec& grid, const Perception& perception,
                  int layer);

// belief(xi) *= P(o | xi, m).
void Observe(const Observation& observation, const GridSpec& grid, const Perception& perception,
             LayeredGrid* belief);

// Without what names no landmark: what has no name says nothing then.
Perception NamesAlone(Perception perception, int names);

// counts[type](x) += probability that the observed landmark stands at x, for a normalised belief.
void Count(const Observation& observation, const GridSpec& grid, const LayeredGrid& belief,
           LayeredGrid* counts);

}  // namespace cairn::landmark_map
