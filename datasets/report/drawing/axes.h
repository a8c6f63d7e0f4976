// Where numbers lie on a picture: linear axes, round ticks, scale bars.
#pragma once

#include <vector>

#include "schema/geometry.h"

namespace cairn::datasets::report {

// Multiples of 1, 2 or 5 times a power of ten inside [low, high]: about `count` of them, at least one step
// apart. Empty where high <= low.
std::vector<double> Ticks(double low, double high, int count);

// The step of the ticks above.
double TickStep(double low, double high, int count);

// The largest of 1, 2, 5 times a power of ten that is at most `value` > 0.
double RoundBelow(double value);

// A rectangle of the world, in metres, y upwards.
struct Box {
  double x_low_m = 0, x_high_m = 0, y_low_m = 0, y_high_m = 0;

  double width_m() const { return x_high_m - x_low_m; }
  double height_m() const { return y_high_m - y_low_m; }
};

// A rectangle of the picture, in pixels, y downwards.
struct Panel {
  double left = 0, top = 0, width = 0, height = 0;
};

// Metres to pixels at one scale for both axes; the box sits in the middle of the panel.
class MapFrame {
 public:
  MapFrame(const Box& box, const Panel& panel);

  double X(double x_m) const { return left_ + (x_m - box_.x_low_m) * pixels_per_m_; }
  double Y(double y_m) const { return top_ + (box_.y_high_m - y_m) * pixels_per_m_; }
  double pixels_per_m() const { return pixels_per_m_; }
  const Box& box() const { return box_; }  // grown to fill the panel
  const Panel& panel() const { return panel_; }

 private:
  Box box_;
  Panel panel_;
  double pixels_per_m_ = 1, left_ = 0, top_ = 0;
};

// Height of a panel of `width` pixels that shows `box` at one scale, kept between the limits.
double PanelHeight(const Box& box, double width, double low, double high);

}  // namespace cairn::datasets::report
