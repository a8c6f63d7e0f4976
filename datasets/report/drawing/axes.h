// Where numbers lie on a picture: linear axes, round ticks, scale bars.
#pragma once

#include <algorithm>
#include <cmath>
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

// An interval of numbers; empty where low > high, as it begins.
struct Span {
  double low = INFINITY, high = -INFINITY;

  // What is not finite is left out.
  void Take(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool empty() const { return low > high; }
  double length() const { return high - low; }
};

// A rectangle of the world, in metres, y upwards.
struct Box {
  double x_low_m = 0, x_high_m = 0, y_low_m = 0, y_high_m = 0;

  double width_m() const { return x_high_m - x_low_m; }
  double height_m() const { return y_high_m - y_low_m; }
};

// A rectangle of the picture, in pixels, y downwards.
struct Panel {
  double left = 0, top = 0, width = 0, height = 0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

// Numbers to pixels: x from left to right, y upwards.
class Axes {
 public:
  // `inset`: so many pixels are left free at the left and at the right.
  Axes(const Panel& panel, const Span& x, const Span& y, double inset = 0)
      : panel_(panel), x_(x), y_(y), inset_(inset) {}

  double X(double x) const {
    return panel_.left + inset_ + (panel_.width - 2 * inset_) * (x - x_.low) / x_.length();
  }
  double Y(double y) const { return panel_.top + panel_.height * (y_.high - y) / y_.length(); }
  Point At(double x, double y) const { return {X(x), Y(y)}; }
  const Panel& panel() const { return panel_; }
  const Span& x() const { return x_; }
  const Span& y() const { return y_; }

 private:
  Panel panel_;
  Span x_, y_;
  double inset_;
};

// Metres to pixels at one scale for both axes; the box, grown to fill the panel, sits in its middle.
class MapFrame : public Axes {
 public:
  MapFrame(const Box& box, const Panel& panel);

  Point At(Point point) const { return Axes::At(point.x_m, point.y_m); }
  Panel At(const Box& box) const {
    return {X(box.x_low_m), Y(box.y_high_m), box.width_m() * pixels_per_m(), box.height_m() * pixels_per_m()};
  }
  double pixels_per_m() const { return panel().width / x().length(); }
};

// Height of a panel of `width` pixels that shows `box` at one scale, kept between the limits.
double PanelHeight(const Box& box, double width, double low, double high);

}  // namespace cairn::datasets::report
