#include <algorithm>
#include <cmath>

#include "datasets/report/drawing/axes.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/drawing/svg.h"
#include "datasets/report/pictures.h"

namespace cairn::datasets::report {
namespace {

constexpr double kLeft = 86, kRight = 10, kTop = 24, kBottom = 40;
constexpr double kNarrowest = 600;  // on which two panels stand side by side
constexpr double kLikelihoodHeight = 230;

std::string TickLabel(double value, double step) {
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
  return Grouped(value, digits);
}

struct AxisRange {
  double low = 0, high = 0;
};

AxisRange RangeOfValues(const std::vector<double>& values) {
  AxisRange range{INFINITY, -INFINITY};
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  }
  const double pad = std::max(0.06 * (range.high - range.low), 1e-9 + 1e-6 * std::abs(range.high));
  return {range.low - pad, range.high + pad};
}

// May the likelihoods of two iterations in a row be compared?
bool SameData(const Iteration& a, const Iteration& b) {
  return a.prefix == b.prefix && a.robots == b.robots && std::isfinite(a.log_likelihood + b.log_likelihood);
}

class LikelihoodCanvas {
 public:
  LikelihoodCanvas(Svg& svg, const std::vector<Iteration>& iterations, std::int64_t robots)
      : svg_(svg), iterations_(iterations), robots_(robots) {}

  // Iterations [first, end) with axes of their own.
  void Draw(const Panel& p, std::size_t first, std::size_t end, const std::string& title) {
    std::vector<double> values;
    for (std::size_t i = first; i < end; ++i) values.push_back(iterations_[i].log_likelihood);
    const AxisRange range = RangeOfValues(values);
    if (!(range.low < range.high)) return;
    const auto from = static_cast<double>(first), to = std::max(from + 1, static_cast<double>(end) - 1);
    const auto x = [&](double i) { return p.left + 14 + (p.width - 28) * (i - from) / (to - from); };
    const auto y = [&](double v) { return p.top + p.height * (range.high - v) / (range.high - range.low); };
    svg_.Rect(p.left, p.top, p.width, p.height, "panel");
    const double step = TickStep(range.low, range.high, 5);
    for (const double tick : Ticks(range.low, range.high, 5)) {
      svg_.Line(p.left, y(tick), p.left + p.width, y(tick), "grid");
      svg_.Text(p.left - 7, y(tick) + 4, TickLabel(tick, step), "tick end");
    }
    for (const double tick : Ticks(from, to, static_cast<int>(std::min(to - from, p.width / 50)))) {
      svg_.Text(x(tick), p.top + p.height + 15, Short(tick), "tick middle");
    }
    svg_.Rect(p.left, p.top, p.width, p.height, "frame");
    svg_.Text(p.left, p.top - 6, title, "heading");
    svg_.Text(p.left + p.width / 2, p.top + p.height + 34, "iteration", "axis middle");
    if (p.left <= kLeft) svg_.VerticalText(16, p.top + p.height / 2, "log-likelihood [nat]", "axis middle");
    for (std::size_t i = first + 1; i < end; ++i) {
      if (!SameData(iterations_[i - 1], iterations_[i])) continue;
      const auto at = static_cast<double>(i);
      svg_.Line(x(at - 1), y(values[i - 1 - first]), x(at), y(values[i - first]), "curve");
    }
    for (std::size_t i = first; i < end; ++i) {
      if (std::isfinite(values[i - first])) Point(x(static_cast<double>(i)), y(values[i - first]), i);
    }
  }

 private:
  void Point(double x, double y, std::size_t i) {
    const Iteration& it = iterations_[i];
    const bool part = it.prefix < 1 || it.robots < robots_;
    svg_.Circle(x, y, 3.6, part ? "point part" : "point",
                "iteration " + std::to_string(i) + ": " + Short(it.log_likelihood, 3) + " on " +
                    Short(100 * it.prefix, 1) + "% of the data of " + Count(it.robots, "robot"));
  }

  Svg& svg_;
  const std::vector<Iteration>& iterations_;
  std::int64_t robots_;
};

}  // namespace

std::string LikelihoodPicture(const std::vector<Iteration>& iterations, double width) {
  constexpr std::size_t kFirst = 1;
  std::int64_t robots = 0;
  bool any = false;
  for (std::size_t i = kFirst; i < iterations.size(); ++i) {
    robots = std::max(robots, iterations[i].robots);
    any = any || std::isfinite(iterations[i].log_likelihood);
  }
  if (!any) return {};
  // The iterations over all data, at the end, have an axis of their own: the others' values do not compare.
  const std::size_t end = iterations.size();
  std::size_t split = end;
  while (split > kFirst && iterations[split - 1].prefix >= 1 && iterations[split - 1].robots == robots)
    --split;
  const bool both = split > kFirst && split < end, stacked = both && width < kNarrowest;
  constexpr double kPitch = kTop + kLikelihoodHeight + kBottom;
  Svg svg(width, stacked ? 2 * kPitch : kPitch, "Log-likelihood by iteration");
  LikelihoodCanvas canvas(svg, iterations, robots);
  const double space = width - kLeft - kRight;
  if (!both) {
    canvas.Draw({kLeft, kTop, space, kLikelihoodHeight}, kFirst, end,
                split < end ? "all data" : "part of the data");
  } else if (stacked) {
    canvas.Draw({kLeft, kTop, space, kLikelihoodHeight}, kFirst, split, "part of the data");
    canvas.Draw({kLeft, kPitch + kTop, space, kLikelihoodHeight}, split, end, "all data");
  } else {
    const double share = static_cast<double>(split - kFirst) / static_cast<double>(end - kFirst);
    const double left = std::clamp(share, 0.25, 0.75) * (space - kLeft);
    canvas.Draw({kLeft, kTop, left, kLikelihoodHeight}, kFirst, split, "part of the data");
    canvas.Draw({kLeft + left + kLeft, kTop, space - kLeft - left, kLikelihoodHeight}, split, end,
                "all data");
  }
  return svg.Finish();
}

std::string RoundsPicture(const std::vector<RoundTime>& rounds, double width) {
  const auto seconds_each = [](const RoundTime& round) {
    return round.seconds / static_cast<double>(std::max<std::int64_t>(1, round.rounds));
  };
  double longest = 0, count = 0;
  for (const RoundTime& round : rounds) {
    longest = std::max(longest, seconds_each(round));
    count += static_cast<double>(round.rounds);
  }
  if (longest <= 0) return {};
  const Panel p{kLeft, 10, width - kLeft - kRight, 180};
  Svg svg(width, p.top + p.height + kBottom, "Wall time of each round");
  const double pitch = p.width / count;
  const double gap = pitch > 4 ? std::min(4.0, 0.2 * pitch) : 0;
  svg.Rect(p.left, p.top, p.width, p.height, "panel");
  const double step = TickStep(0, longest, 4);
  const auto y = [&](double seconds) { return p.top + p.height * (1 - seconds / (1.05 * longest)); };
  for (const double tick : Ticks(0, 1.05 * longest, 4)) {
    svg.Line(p.left, y(tick), p.left + p.width, y(tick), "grid");
    svg.Text(p.left - 7, y(tick) + 4, TickLabel(tick, step), "tick end");
  }
  std::int64_t at = 0;
  for (const RoundTime& round : rounds) {
    const double top = y(seconds_each(round));
    svg.Rect(p.left + pitch * static_cast<double>(at) + gap / 2, top,
             pitch * static_cast<double>(round.rounds) - gap, p.top + p.height - top, "bar",
             "round " + std::to_string(at) +
                 (round.rounds > 1 ? " to " + std::to_string(at + round.rounds - 1) : std::string()) +
                 (round.note.empty() ? "" : ": " + round.note) + "; " + Duration(round.seconds) + ", " +
                 Count(round.tasks, "task") + ", " + Duration(round.compute_seconds) + " of computing");
    at += round.rounds;
  }
  for (const double tick : Ticks(0, count - 1, static_cast<int>(std::clamp(count - 1, 1.0, p.width / 60)))) {
    svg.Text(p.left + pitch * (tick + 0.5), p.top + p.height + 15, Short(tick), "tick middle");
  }
  svg.Rect(p.left, p.top, p.width, p.height, "frame");
  svg.Text(p.left + p.width / 2, p.top + p.height + 34, "round", "axis middle");
  svg.VerticalText(16, p.top + p.height / 2, "wall time [s]", "axis middle");
  return svg.Finish();
}

}  // namespace cairn::datasets::report
