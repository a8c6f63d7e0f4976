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

MapFrame::MapFrame(const Box& box, const Panel& panel) : box_(box), panel_(panel) {
  pixels_per_m_ = std::min(panel.width / box.width_m(), panel.height / box.height_m());
  const double grow_x = (panel.width / pixels_per_m_ - box.width_m()) / 2;
  const double grow_y = (panel.height / pixels_per_m_ - box.height_m()) / 2;
  box_ = {box.x_low_m - grow_x, box.x_high_m + grow_x, box.y_low_m - grow_y, box.y_high_m + grow_y};
  left_ = panel.left;
  top_ = panel.top;
}

double PanelHeight(const Box& box, double width, double low, double high) {
  return std::clamp(std::round(width * box.height_m() / box.width_m()), low, high);
}

}  // namespace cairn::datasets::report
