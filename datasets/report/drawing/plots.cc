#include "datasets/report/drawing/plots.h"

#include <algorithm>
#include <cmath>

#include "datasets/report/drawing/axes.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/drawing/palette.h"
#include "schema/error.h"

namespace cairn::datasets::report {
namespace {

constexpr double kPlotsLeft = 62, kPlotsTop = 30, kPlotsBottom = 44, kPlotsRight = 16, kKeyRow = 24,
                 kPlotsText = 12;

struct Limits {
  double low = HUGE_VAL, high = -HUGE_VAL;

  void Stretch(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

Limits LimitsOfX(const Plot& plot) {
  Limits limits;
  for (const PlotSeries& series : plot.series) {
    for (const PlotPoint& point : series.points) limits.Stretch(point.x);
  }
  if (!plot.x_names.empty()) return {-0.4, static_cast<double>(plot.x_names.size()) - 0.6};
  return limits.low < limits.high ? limits : Limits{limits.low - 0.5, limits.low + 0.5};
}

Limits LimitsOfY(const Plot& plot) {
  Limits limits;
  for (const PlotSeries& series : plot.series) {
    for (const PlotPoint& point : series.points) {
      limits.Stretch(point.y);
      if (!point.bar) continue;
      limits.Stretch(point.bar->first);
      limits.Stretch(point.bar->second);
    }
  }
  if (!(limits.low <= limits.high)) limits = {0, 1};
  const double pad = std::max(0.05 * (limits.high - limits.low), 1e-9);
  return {plot.y_low.value_or(limits.low - pad), plot.y_high.value_or(limits.high + pad)};
}

class Painter {
 public:
  Painter(const Plot& plot, const Panel& panel, Canvas* canvas)
      : plot_(plot), panel_(panel), canvas_(*canvas), x_(LimitsOfX(plot)), y_(LimitsOfY(plot)) {}

  void Paint() {
    PaintAxes();
    if (plot_.marked_x)
      canvas_.Line({X(*plot_.marked_x), panel_.top}, {X(*plot_.marked_x), Bottom()}, kBad, 1.5);
    for (const PlotSeries& series : plot_.series) PaintSeries(series);
  }

 private:
  double X(double x) const { return panel_.left + panel_.width * (x - x_.low) / (x_.high - x_.low); }
  double Y(double y) const {
    const double share = std::clamp((y - y_.low) / (y_.high - y_.low), 0.0, 1.0);
    return Bottom() - panel_.height * share;
  }
  double Bottom() const { return panel_.top + panel_.height; }

  void PaintAxes() {
    const int y_ticks = std::max(2, static_cast<int>(panel_.height / 40));
    if (panel_.height >= 60) {
      for (const double tick : Ticks(y_.low, y_.high, y_ticks)) {
        canvas_.Line({panel_.left, Y(tick)}, {panel_.left + panel_.width, Y(tick)}, kRaster, 1);
        canvas_.Text({panel_.left - 6, Y(tick) + 4}, Short(tick, 3), kSoft, kPlotsText - 2, Align::kRight);
      }
    }
    canvas_.Frame({panel_.left, panel_.top}, {panel_.left + panel_.width, Bottom()}, kLine, 1);
    canvas_.Text({panel_.left, panel_.top - 8}, plot_.title, kInk, kPlotsText);
    if (!plot_.y_label.empty())
      canvas_.Text({panel_.left + panel_.width, panel_.top - 8}, plot_.y_label, kSoft, kPlotsText - 2,
                   Align::kRight);
    if (plot_.x_label.empty()) return;
    canvas_.Text({panel_.left + panel_.width / 2, Bottom() + 32}, plot_.x_label, kSoft, kPlotsText - 1,
                 Align::kMiddle);
    for (std::size_t k = 0; k < plot_.x_names.size(); ++k)
      canvas_.Text({X(static_cast<double>(k)), Bottom() + 15}, plot_.x_names[k], kSoft, kPlotsText - 2,
                   Align::kMiddle);
    if (!plot_.x_names.empty()) return;
    for (const double tick : Ticks(x_.low, x_.high, std::max(2, static_cast<int>(panel_.width / 60)))) {
      canvas_.Line({X(tick), Bottom()}, {X(tick), Bottom() - 4}, kSoft, 1);
      canvas_.Text({X(tick), Bottom() + 15}, Short(tick), kSoft, kPlotsText - 2, Align::kMiddle);
    }
  }

  void PaintSeries(const PlotSeries& series) {
    std::vector<Point> line;
    for (const PlotPoint& point : series.points) {
      if (!std::isfinite(point.y)) continue;
      const double x = X(point.x);
      line.push_back({x, Y(point.y)});
      if (!point.bar) continue;
      const double low = Y(point.bar->first), high = Y(point.bar->second);
      canvas_.Line({x, low}, {x, high}, series.colour, 1);
      for (const double end : {low, high}) canvas_.Line({x - 3, end}, {x + 3, end}, series.colour, 1);
    }
    if (!series.dashed) canvas_.Polyline(line, series.colour, 1.6);
    for (std::size_t k = 1; series.dashed && k < line.size(); ++k) Dash(line[k - 1], line[k], series.colour);
    for (const Point& at : line) {
      if (series.dots) canvas_.Dot(at, 3, series.colour);
    }
  }

  // Dashes go on along the whole curve.
  void Dash(Point from, Point to, Rgb colour) {
    constexpr double kOn = 6, kPeriod = 10;
    const double length = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
    const auto at = [&](double drawn) {
      return Point{from.x_m + (to.x_m - from.x_m) * drawn / length,
                   from.y_m + (to.y_m - from.y_m) * drawn / length};
    };
    for (double drawn = 0; drawn < length;) {
      const double phase = std::fmod(dashed_ + drawn, kPeriod);
      const double stretch = std::min(length - drawn, (phase < kOn ? kOn : kPeriod) - phase) + 1e-6;
      if (phase < kOn) canvas_.Line(at(drawn), at(std::min(length, drawn + stretch)), colour, 1.6);
      drawn += stretch;
    }
    dashed_ += length;
  }

  const Plot& plot_;
  Panel panel_;
  Canvas& canvas_;
  Limits x_, y_;
  double dashed_ = 0;
};

std::vector<const PlotSeries*> KeysOf(const std::vector<Plot>& plots) {
  std::vector<const PlotSeries*> keys;
  for (const Plot& plot : plots) {
    for (const PlotSeries& series : plot.series) {
      const auto same = [&](const PlotSeries* key) { return key->name == series.name; };
      if (!series.name.empty() && std::ranges::none_of(keys, same)) keys.push_back(&series);
    }
  }
  return keys;
}

// In rows of a width; null only counts. Returns their height.
double DrawKeys(const std::vector<const PlotSeries*>& keys, double width, double top, Canvas* canvas) {
  constexpr double kMark = 26, kBetween = 30;
  double x = kPlotsLeft, y = top + kKeyRow / 2;
  for (const PlotSeries* key : keys) {
    const double needed = kMark + 8 + Canvas::TextWidth(key->name, kPlotsText) + kBetween;
    if (x + needed - kBetween > width && x > kPlotsLeft) {
      x = kPlotsLeft;
      y += kKeyRow;
    }
    if (canvas != nullptr) {
      canvas->Line({x, y}, {x + (key->dashed ? 10 : kMark), y}, key->colour, 1.6);
      if (key->dashed) canvas->Line({x + 16, y}, {x + kMark, y}, key->colour, 1.6);
      canvas->Text({x + kMark + 8, y + 4}, key->name, kInk, kPlotsText);
    }
    x += needed;
  }
  return keys.empty() ? 0 : y + kKeyRow - top;
}

}  // namespace

std::string DrawPlots(const std::vector<Plot>& plots, const PlotLayout& layout) {
  CAIRN_DEMAND(layout.columns > 0 && !plots.empty(), "something to draw");
  const auto columns = static_cast<std::size_t>(layout.columns);
  const std::size_t rows = (plots.size() + columns - 1) / columns;
  std::vector<double> tops;
  double below = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    bool labelled = false;
    for (std::size_t k = row * columns; k < std::min(plots.size(), (row + 1) * columns); ++k)
      labelled = labelled || !plots[k].x_label.empty();
    tops.push_back(below + kPlotsTop);
    below += kPlotsTop + layout.height + (labelled ? kPlotsBottom : 4);
  }
  const double width = static_cast<double>(columns) * (kPlotsLeft + layout.width + kPlotsRight);
  const std::vector<const PlotSeries*> keys = KeysOf(plots);
  Canvas canvas(static_cast<int>(std::ceil(width)),
                static_cast<int>(std::ceil(below + DrawKeys(keys, width, 0, nullptr))), kPaper);
  for (std::size_t k = 0; k < plots.size(); ++k) {
    const double left =
        static_cast<double>(k % columns) * (kPlotsLeft + layout.width + kPlotsRight) + kPlotsLeft;
    Painter(plots[k], {left, tops[k / columns], layout.width, layout.height}, &canvas).Paint();
  }
  DrawKeys(keys, width, below, &canvas);
  return canvas.Png();
}

}  // namespace cairn::datasets::report
