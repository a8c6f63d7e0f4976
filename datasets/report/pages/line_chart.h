// Curves over a common axis, as inline SVG.
#pragma once

#include <string>
#include <vector>

#include "datasets/report/drawing/axes.h"
#include "datasets/report/drawing/svg.h"

namespace cairn::datasets::report {

struct ChartPoint {
  double x = 0, y = 0;
};

struct Curve {
  std::string name;                // for the legend
  std::vector<ChartPoint> points;  // x, y; what is not finite is left out
  int colour = 0;                  // style classes r0 to r7
  bool faint = false;              // one of many
  // An interval round the curve, as an area: its lower and its upper end, by rising x; both empty for none.
  std::vector<ChartPoint> low = {}, high = {};
};

struct LineChart {
  std::string title;  // above the legend, which is above the picture
  std::string x_label, y_label;
  std::vector<Curve> curves;
  bool log_y = false;  // values that are not above 0 are left out
};

// The middles of `most` stretches of even length, where there are more points than that.
std::vector<ChartPoint> Thinned(const std::vector<ChartPoint>& points, std::size_t most);

// Into the panel, which wants 40 pixels below and 76 on the left. False where there is no point to draw: the
// picture is as it was.
bool Draw(const LineChart& chart, const Panel& panel, Svg* svg);

// The whole figure: title, legend and picture with words below; empty where there is no point to draw.
std::string ChartHtml(const LineChart& chart, const std::string& caption, double height = 200);

}  // namespace cairn::datasets::report
