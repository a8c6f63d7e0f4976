#include "datasets/report/drawing/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/report/drawing/format.h"
#include "schema/error.h"

namespace cairn::datasets::report {
namespace {

constexpr std::size_t kMostPoints = 1500;  // a picture has fewer columns of pixels

std::string TickText(double value, double step, bool log) {
  if (log) return fmt::format("{:.2g}", std::pow(10.0, value));
  return Grouped(value, std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6));
}

// Points as they are drawn: y as its logarithm where the axis is one.
std::vector<ChartPoint> Drawable(const std::vector<ChartPoint>& all, bool log_y) {
  std::vector<ChartPoint> points;
  for (ChartPoint p : all) {
    if (log_y) p.y = std::log10(p.y);
    if (std::isfinite(p.x) && std::isfinite(p.y)) points.push_back(p);
  }
  return Thinned(points, kMostPoints);
}

// Of the area between a curve's bounds.
std::vector<ChartPoint> Outline(const Curve& curve, bool log_y) {
  std::vector<ChartPoint> outline = Drawable(curve.low, log_y), upper = Drawable(curve.high, log_y);
  outline.insert(outline.end(), upper.rbegin(), upper.rend());
  return outline;
}

std::string ColourClass(const Curve& curve) { return fmt::format("r{}", curve.colour % kRobotColours); }

std::string CurveClass(const Curve& curve) {
  return fmt::format("path {}{}{}", curve.dashed ? "dashed " : "", curve.faint ? "faint " : "",
                     ColourClass(curve));
}

// Of all points; grown so that no curve lies on the panel's edge.
std::pair<Span, Span> SpansOf(const LineChart& chart) {
  Span x, y;
  for (const Curve& curve : chart.curves) {
    for (const auto& points : {Drawable(curve.points, chart.log_y), Outline(curve, chart.log_y)}) {
      for (const ChartPoint& p : points) {
        x.Take(p.x);
        y.Take(p.y);
        if (p.bar) y.Take(p.bar->first);
        if (p.bar) y.Take(p.bar->second);
      }
    }
  }
  const double pad = std::max(0.05 * y.length(), 1e-9 + 1e-6 * std::abs(y.high));
  y = {chart.y_low.value_or(y.low - pad), chart.y_high.value_or(y.high + pad)};
  if (!x.empty() && x.high <= x.low) x.high = x.low + 1;
  if (!chart.x_names.empty()) x = {-0.4, static_cast<double>(chart.x_names.size()) - 0.6};
  return {x, y};
}

// Values beyond the axis are on its end.
std::vector<Point> ToPixels(const Axes& axes, const std::vector<ChartPoint>& points) {
  std::vector<Point> pixels;
  for (const ChartPoint& p : points)
    pixels.push_back(axes.At(p.x, std::clamp(p.y, axes.y().low, axes.y().high)));
  return pixels;
}

void DrawBars(const Axes& axes, const Curve& curve, Picture* picture) {
  const std::string classes = "interval " + ColourClass(curve);
  for (const ChartPoint& p : curve.points) {
    if (!p.bar || !std::isfinite(p.y)) continue;
    const std::vector<Point> ends = ToPixels(axes, {{p.x, p.bar->first}, {p.x, p.bar->second}});
    picture->Line(ends[0], ends[1], classes);
    for (const Point& end : ends) picture->Line({end.x_m - 3, end.y_m}, {end.x_m + 3, end.y_m}, classes);
  }
}

}  // namespace

void DrawAxes(const Axes& axes, const AxesText& text, Picture* picture) {
  const Panel& p = axes.panel();
  picture->Rect(p, "panel");
  const double y_low = std::min(axes.y().low, axes.y().high), y_high = std::max(axes.y().low, axes.y().high);
  const int y_most = text.y_ticks > 0 ? text.y_ticks : std::clamp(static_cast<int>(p.height / 35), 2, 5);
  double widest = 0;
  for (const double tick : Ticks(y_low, y_high, y_most)) {
    const std::string words = TickText(tick, TickStep(y_low, y_high, y_most), text.log_y);
    picture->Line({p.left, axes.Y(tick)}, {p.right(), axes.Y(tick)}, "grid");
    picture->Text({p.left - 6, axes.Y(tick) + 4}, words, "tick end");
    widest = std::max(widest, TextWidth(words, 11.5));
  }
  if (!text.y.empty())
    picture->Text({p.left - 6 - widest - 10, p.top + p.height / 2}, text.y, "axis middle", -90);
  if (text.x.empty()) return;
  picture->Text({p.left + p.width / 2, p.bottom() + 33}, text.x, "axis middle");
  const double below = p.bottom() + 15;
  for (std::size_t k = 0; k < text.x_names.size(); ++k)
    picture->Text({axes.X(static_cast<double>(k)), below}, text.x_names[k], "tick middle");
  if (!text.x_names.empty()) return;
  // No closer than their labels are wide.
  const Span& x = axes.x();
  const double label = TextWidth(std::max(Grouped(x.low), Grouped(x.high),
                                          [](const auto& a, const auto& b) { return a.size() < b.size(); }) +
                                 ".00");
  const double room = p.width / std::max(90.0, label + 16);
  const int x_most =
      text.x_ticks > 0 ? text.x_ticks : static_cast<int>(std::clamp(x.length(), 1.0, std::max(1.0, room)));
  for (const double tick : Ticks(x.low, x.high, x_most)) {
    if (text.x_lines) picture->Line({axes.X(tick), p.top}, {axes.X(tick), p.bottom()}, "grid");
    picture->Text({axes.X(tick), below}, TickText(tick, TickStep(x.low, x.high, x_most), false),
                  "tick middle");
  }
}

void DrawFrame(const Axes& axes, Picture* picture) { picture->Rect(axes.panel(), "frame"); }

std::vector<ChartPoint> Thinned(const std::vector<ChartPoint>& points, std::size_t most) {
  if (points.size() <= most) return points;
  std::vector<ChartPoint> thinned;
  for (std::size_t i = 0; i < most; ++i) {
    const std::size_t first = i * points.size() / most, end = (i + 1) * points.size() / most;
    ChartPoint sum;
    for (std::size_t k = first; k < end; ++k) {
      sum.x += points[k].x;
      sum.y += points[k].y;
    }
    const auto count = static_cast<double>(end - first);
    thinned.push_back({sum.x / count, sum.y / count});
  }
  return thinned;
}

bool Draw(const LineChart& chart, const Panel& panel, Picture* picture) {
  const auto [x, y] = SpansOf(chart);
  if (x.empty() || y.empty()) return false;
  const Axes axes(panel, x, y, chart.x_names.empty() ? 8 : 0);
  DrawAxes(axes, {.x = chart.x_label, .y = chart.y_label, .log_y = chart.log_y, .x_names = chart.x_names},
           picture);
  DrawFrame(axes, picture);
  if (chart.marked_x)
    picture->Line({axes.X(*chart.marked_x), panel.top}, {axes.X(*chart.marked_x), panel.bottom()}, "miss");
  for (const Curve& curve : chart.curves)
    picture->Polygon(ToPixels(axes, Outline(curve, chart.log_y)), "area " + ColourClass(curve));
  for (const Curve& curve : chart.curves) {
    DrawBars(axes, curve, picture);
    const std::vector<Point> pixels = ToPixels(axes, Drawable(curve.points, chart.log_y));
    picture->Polyline(pixels, CurveClass(curve));
    for (const Point& at : pixels) {
      if (curve.dots || pixels.size() == 1) picture->Circle(at, 3, "start " + ColourClass(curve));
    }
  }
  return true;
}

std::vector<LegendEntry> LegendOf(const std::vector<LineChart>& charts) {
  std::vector<LegendEntry> entries;
  for (const LineChart& chart : charts) {
    for (const Curve& curve : chart.curves) {
      const bool known = std::ranges::find(entries, curve.name, &LegendEntry::text) != entries.end();
      if (!curve.name.empty() && !known) entries.push_back(LineEntry(CurveClass(curve), curve.name));
    }
  }
  return entries;
}

Picture ChartsPicture(const std::vector<LineChart>& charts, std::size_t columns, double width,
                      double height) {
  CAIRN_DEMAND(columns > 0 && !charts.empty(), "something to draw");
  constexpr double kTitle = 26, kBetween = 8;
  const double pitch = kChartLeft + width + kChartRight;
  Picture picture(static_cast<double>(columns) * pitch, 0);
  double top = 0, next = 0;
  for (std::size_t k = 0; k < charts.size(); ++k) {
    if (k % columns == 0) top = next;
    const Panel panel{static_cast<double>(k % columns) * pitch + kChartLeft, top + kTitle, width, height};
    picture.Text({panel.left, panel.top - 8}, charts[k].title, "heading");
    Draw(charts[k], panel, &picture);
    next = std::max(next, panel.bottom() + (charts[k].x_label.empty() ? kBetween : kChartBottom));
  }
  picture.SetHeight(next + kBetween + DrawLegend(LegendOf(charts), kChartLeft, next + kBetween, &picture));
  return picture;
}

}  // namespace cairn::datasets::report
