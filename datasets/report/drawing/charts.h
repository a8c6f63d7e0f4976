// Axes with their words, and curves over them.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/report/drawing/picture.h"

namespace cairn::datasets::report {

// What a panel needs about it for ticks and the axes' names, in pixels.
inline constexpr double kChartLeft = 86, kChartRight = 10, kChartBottom = 40;

struct AxesText {
  std::string x, y;  // the axes' names; without x there is nothing below the panel
  int x_ticks = 0;   // at most; 0: as many as their labels have room
  int y_ticks = 0;
  bool x_lines = false;                   // across the panel, as for y
  bool log_y = false;                     // y is a logarithm to base ten: its ticks say of what
  std::vector<std::string> x_names = {};  // where x counts conditions (0, 1, …)
};
// The panel, its ticks and their lines, on which the rest is drawn; then its edge.
void DrawAxes(const Axes& axes, const AxesText& text, Picture* picture);
void DrawFrame(const Axes& axes, Picture* picture);

struct ChartPoint {
  double x = 0, y = 0;
  std::optional<std::pair<double, double>> bar = {};  // an interval of y: from, to
};

struct Curve {
  std::string name;                // for the legend; curves of one name share it
  std::vector<ChartPoint> points;  // what is not finite is left out
  std::size_t colour = 0;          // style classes r0 to r7
  bool faint = false;              // one of many
  bool dashed = false;
  bool dots = false;  // at the points
  // An interval round the curve, as an area: its lower and its upper end, by rising x; both empty for none.
  std::vector<ChartPoint> low = {}, high = {};
};

struct LineChart {
  std::string title;
  std::string x_label, y_label;
  std::vector<Curve> curves;
  bool log_y = false;                             // values that are not above 0 are left out
  std::vector<std::string> x_names = {};          // where x counts conditions (0, 1, …)
  std::optional<double> y_low = {}, y_high = {};  // else by what is drawn
  std::optional<double> marked_x = {};            // a line there: where the robot truly is, say
};

// The middles of `most` stretches of even length, where there are more points than that.
std::vector<ChartPoint> Thinned(const std::vector<ChartPoint>& points, std::size_t most);

// Into the panel, without its title. False where there is no point to draw: the picture is as it was.
bool Draw(const LineChart& chart, const Panel& panel, Picture* picture);

std::vector<LegendEntry> LegendOf(const std::vector<LineChart>& charts);

// Charts in rows of `columns`, panels of a width and a height in pixels, the legend of all below.
Picture ChartsPicture(const std::vector<LineChart>& charts, std::size_t columns, double width, double height);

}  // namespace cairn::datasets::report
