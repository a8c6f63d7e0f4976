// Pictures of curves side by side: a measure against a condition, with error bars.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/report/drawing/canvas.h"

namespace cairn::datasets::report {

struct PlotPoint {
  double x = 0, y = 0;
  std::optional<std::pair<double, double>> bar;  // from, to
};

struct PlotSeries {
  std::string name;  // for the legend; series of one name share it. Empty: not in it
  std::vector<PlotPoint> points;
  Rgb colour{28, 39, 51};
  bool dashed = false;
  bool dots = false;  // at the points
};

struct Plot {
  std::string title, x_label, y_label;
  std::vector<PlotSeries> series;
  std::vector<std::string> x_names;     // where x counts conditions (0, 1, …): their names
  std::optional<double> y_low, y_high;  // else by what is drawn
  std::optional<double> marked_x;       // a line there: where the robot truly is, say
};

struct PlotLayout {
  int columns = 1;
  double width = 320, height = 220;  // of a plot, in pixels
};

// The bytes of a PNG file: plots in rows of `columns`, the legend of all below.
std::string DrawPlots(const std::vector<Plot>& plots, const PlotLayout& layout);

}  // namespace cairn::datasets::report
