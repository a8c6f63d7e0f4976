#include "datasets/report/pages/line_chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/parts.h"

namespace cairn::datasets::report {
namespace {

constexpr double kPixelsPerLetter = 6.5;
constexpr std::size_t kMostPoints = 1500;  // a picture has fewer columns of pixels

struct Span {
  double low = INFINITY, high = -INFINITY;
  void Take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool Some() const { return low <= high; }
};

std::string TickText(double value, double step, bool log_y) {
  if (log_y) {
    char text[24];
    std::snprintf(text, sizeof text, "%.2g", std::pow(10.0, value));
    return text;
  }
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
  return Grouped(value, digits);
}

// Points as they are drawn: y as its logarithm where the axis is one.
std::vector<ChartPoint> Drawable(const std::vector<ChartPoint>& all, bool log_y) {
  std::vector<ChartPoint> points;
  for (const ChartPoint& p : all) {
    const double y = log_y ? std::log10(p.y) : p.y;
    if (std::isfinite(p.x) && std::isfinite(y)) points.push_back({p.x, y});
  }
  return Thinned(points, kMostPoints);
}

// Of the area between a curve's bounds.
std::vector<ChartPoint> Outline(const Curve& curve, bool log_y) {
  std::vector<ChartPoint> outline = Drawable(curve.low, log_y), upper = Drawable(curve.high, log_y);
  outline.insert(outline.end(), upper.rbegin(), upper.rend());
  return outline;
}

class Frame {
 public:
  Frame(const Span& x, const Span& y, const Panel& panel) : x_(x), y_(y), p_(panel) {
    const double pad = std::max(0.05 * (y.high - y.low), 1e-9 + 1e-6 * std::abs(y.high));
    y_.low -= pad;
    y_.high += pad;
    if (x_.high <= x_.low) x_.high = x_.low + 1;
  }
  double X(double x) const { return p_.left + 8 + (p_.width - 16) * (x - x_.low) / (x_.high - x_.low); }
  double Y(double y) const { return p_.top + p_.height * (y_.high - y) / (y_.high - y_.low); }

  void DrawAxes(const LineChart& chart, Svg* svg) const {
    svg->Rect(p_.left, p_.top, p_.width, p_.height, "panel");
    const double step = TickStep(y_.low, y_.high, 5);
    for (const double tick : Ticks(y_.low, y_.high, 5)) {
      svg->Line(p_.left, Y(tick), p_.left + p_.width, Y(tick), "grid");
      svg->Text(p_.left - 7, Y(tick) + 4, TickText(tick, step, chart.log_y), "tick end");
    }
    // No closer than their labels are wide.
    const double letters = static_cast<double>(std::max(Grouped(x_.low).size(), Grouped(x_.high).size()) + 3);
    const double room = p_.width / std::max(90.0, kPixelsPerLetter * letters + 16);
    const int most = static_cast<int>(std::clamp(x_.high - x_.low, 1.0, std::max(1.0, room)));
    const double x_step = TickStep(x_.low, x_.high, most);
    for (const double tick : Ticks(x_.low, x_.high, most))
      svg->Text(X(tick), p_.top + p_.height + 15, TickText(tick, x_step, false), "tick middle");
    svg->Rect(p_.left, p_.top, p_.width, p_.height, "frame");
    svg->Text(p_.left + p_.width / 2, p_.top + p_.height + 32, chart.x_label, "axis middle");
    svg->VerticalText(p_.left - 66, p_.top + p_.height / 2, chart.y_label, "axis middle");
  }

 private:
  Span x_, y_;
  Panel p_;
};

std::vector<Point> ToPixels(const Frame& frame, const std::vector<ChartPoint>& points) {
  std::vector<Point> pixels;
  for (const ChartPoint& p : points) pixels.push_back({frame.X(p.x), frame.Y(p.y)});
  return pixels;
}

std::string Colour(const Curve& curve) { return "r" + std::to_string(curve.colour % 8); }

}  // namespace

std::vector<ChartPoint> Thinned(const std::vector<ChartPoint>& points, std::size_t most) {
  if (points.size() <= most) return points;
  std::vector<ChartPoint> thinned;
  for (std::size_t i = 0; i < most; ++i) {
    const std::size_t first = i * points.size() / most, end = (i + 1) * points.size() / most;
    ChartPoint sum{0, 0};
    for (std::size_t k = first; k < end; ++k) {
      sum.x += points[k].x;
      sum.y += points[k].y;
    }
    const auto count = static_cast<double>(end - first);
    thinned.push_back({sum.x / count, sum.y / count});
  }
  return thinned;
}

bool Draw(const LineChart& chart, const Panel& panel, Svg* svg) {
  Span x, y;
  std::vector<std::vector<ChartPoint>> curves, areas;
  for (const Curve& curve : chart.curves) {
    curves.push_back(Drawable(curve.points, chart.log_y));
    areas.push_back(Outline(curve, chart.log_y));
    for (const auto* points : {&curves.back(), &areas.back()}) {
      for (const ChartPoint& p : *points) {
        x.Take(p.x);
        y.Take(p.y);
      }
    }
  }
  if (!x.Some()) return false;
  const Frame frame(x, y, panel);
  frame.DrawAxes(chart, svg);
  for (std::size_t c = 0; c < curves.size(); ++c)
    svg->Polygon(ToPixels(frame, areas[c]), "area " + Colour(chart.curves[c]));
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const std::vector<Point> pixels = ToPixels(frame, curves[c]);
    if (pixels.size() == 1)
      svg->Circle(pixels[0].x_m, pixels[0].y_m, 3, "start " + Colour(chart.curves[c]));
    else
      svg->Polyline(pixels, (chart.curves[c].faint ? "path faint " : "path ") + Colour(chart.curves[c]));
  }
  return true;
}

std::string ChartHtml(const LineChart& chart, const std::string& caption, double height) {
  const std::string figure = DrawingHtml(
      [&](double width) {
        constexpr double kLeft = 86, kRight = 10, kTop = 8, kBottom = 40;
        Svg svg(width, kTop + height + kBottom, chart.title);
        return Draw(chart, {kLeft, kTop, width - kLeft - kRight, height}, &svg) ? svg.Finish() : "";
      },
      caption);
  if (figure.empty()) return {};
  std::vector<LegendEntry> entries;
  for (const Curve& curve : chart.curves) {
    if (curve.name.empty()) continue;
    entries.push_back(
        {"<line class=\"path " + Colour(curve) + "\" x1=\"1\" y1=\"7\" x2=\"25\" y2=\"7\"/>", curve.name});
  }
  return "<h3>" + Escape(chart.title) + "</h3>\n" + LegendHtml(entries) + figure;
}

}  // namespace cairn::datasets::report
