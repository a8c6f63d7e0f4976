// Where names are put on a map.
#pragma once

#include <string>
#include <vector>

#include "datasets/report/drawing/axes.h"
#include "schema/geometry.h"

namespace cairn::datasets::report {

// The name of a point at `at`, all in pixels, y downwards.
struct Label {
  Point at;
  std::string text;
  double width = 0;   // of its text
  double weight = 0;  // where two want one place the heavier gets it
};

struct PlacedLabel {
  std::size_t label = 0;  // which
  Point baseline;         // where its text begins
};

// Each name beside its point, where it covers neither another name nor another point and lies in the panel;
// names that have no such place are left out. `height`: of the letters; `clear`: radius about a point that is
// kept free. The heavier first, of the same weight in their order.
std::vector<PlacedLabel> PlaceLabels(const std::vector<Label>& labels, const Panel& panel, double height,
                                     double clear);

}  // namespace cairn::datasets::report
