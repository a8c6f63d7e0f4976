#include "datasets/report/drawing/axes.h"

#include <algorithm>
#include <cmath>

namespace cairn::datasets::report {

double RoundBelow(double value) {
  const double power = std::pow(10, std::floor(std::log10(value) + 1e-12));
  const double digit = value / power * (1 + 1e-12);
  return (digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power;
}

double TickStep(double low, double high, int count) {
  const double raw = (high - low) / count;
  const double below = RoundBelow(raw);
  const double power = std::pow(10, std::floor(std::log10(below) + 1e-9));
  const double above = below < 1.5 * power ? 2 * power : below < 3 * power ? 5 * power : 10 * power;
  return raw / below < above / raw ? below : above;
}

std::vector<double> Ticks(double low, double high, int count) {
  std::vector<double> ticks;
  if (!(high > low)) return ticks;
  const double step = TickStep(low, high, count);
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
    ticks.push_back(k * step);
  return ticks;
}

namespace {

Axes AtOneScale(const Box& box, const Panel& panel) {
  const double scale = std::min(panel.width / box.width_m(), panel.height / box.height_m());
  const double grow_x = (panel.width / scale - box.width_m()) / 2,
               grow_y = (panel.height / scale - box.height_m()) / 2;
  return {
      panel, {box.x_low_m - grow_x, box.x_high_m + grow_x}, {box.y_low_m - grow_y, box.y_high_m + grow_y}};
}

}  // namespace

MapFrame::MapFrame(const Box& box, const Panel& panel) : Axes(AtOneScale(box, panel)) {}

double PanelHeight(const Box& box, double width, double low, double high) {
  return std::clamp(std::round(width * box.height_m() / box.width_m()), low, high);
}

}  // namespace cairn::datasets::report
