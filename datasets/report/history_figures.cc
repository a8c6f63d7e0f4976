#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/report/drawing/charts.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/pictures.h"

namespace cairn::datasets::report {
namespace {

constexpr double kHistoryTop = 24, kLikelihoodHeight = 230;
constexpr double kNarrowest = 600;  // on which two panels stand side by side

// May the likelihoods of two iterations in a row be compared?
bool SameData(const Iteration& a, const Iteration& b) {
  return a.prefix == b.prefix && a.robots == b.robots && std::isfinite(a.log_likelihood + b.log_likelihood);
}

// Iterations [first, end) with axes of their own; `robots`: all there are.
void DrawLikelihoods(const std::vector<Iteration>& iterations, std::size_t first, std::size_t end,
                     std::int64_t robots, const Panel& panel, const std::string& title, Picture* picture) {
  Span y;
  for (std::size_t i = first; i < end; ++i) y.Take(iterations[i].log_likelihood);
  if (y.empty()) return;
  const double pad = std::max(0.06 * y.length(), 1e-9 + 1e-6 * std::abs(y.high));
  const auto from = static_cast<double>(first), to = std::max(from + 1, static_cast<double>(end) - 1);
  const Axes axes(panel, {from, to}, {y.low - pad, y.high + pad}, 14);
  const auto at = [&](std::size_t i) {
    return axes.At(static_cast<double>(i), iterations[i].log_likelihood);
  };
  DrawAxes(axes,
           {.x = "iteration",
            .y = panel.left <= kChartLeft ? "log-likelihood [nat]" : "",
            .x_ticks = static_cast<int>(std::min(to - from, panel.width / 50))},
           picture);
  DrawFrame(axes, picture);
  picture->Text({panel.left, panel.top - 6}, title, "heading");
  for (std::size_t i = first + 1; i < end; ++i)
    if (SameData(iterations[i - 1], iterations[i])) picture->Line(at(i - 1), at(i), "curve");
  for (std::size_t i = first; i < end; ++i) {
    const Iteration& it = iterations[i];
    if (!std::isfinite(it.log_likelihood)) continue;
    picture->Circle(at(i), 3.6, it.prefix < 1 || it.robots < robots ? "point part" : "point",
                    fmt::format("iteration {}: {} on {}% of the data of {}", i, Short(it.log_likelihood, 3),
                                Short(100 * it.prefix, 1), Count(it.robots, "robot")));
  }
}

}  // namespace

Picture LikelihoodPicture(const std::vector<Iteration>& iterations, double width) {
  constexpr std::size_t kFirst = 1;
  std::int64_t robots = 0;
  bool any = false;
  for (std::size_t i = kFirst; i < iterations.size(); ++i) {
    robots = std::max(robots, iterations[i].robots);
    any = any || std::isfinite(iterations[i].log_likelihood);
  }
  if (!any) return Picture();
  // The iterations over all data, at the end, have an axis of their own: the others' values do not compare.
  const std::size_t end = iterations.size();
  std::size_t split = end;
  while (split > kFirst && iterations[split - 1].prefix >= 1 && iterations[split - 1].robots == robots)
    --split;
  const bool both = split > kFirst && split < end, stacked = both && width < kNarrowest;
  constexpr double kPitch = kHistoryTop + kLikelihoodHeight + kChartBottom;
  Picture picture(width, stacked ? 2 * kPitch : kPitch, "Log-likelihood by iteration");
  const double space = width - kChartLeft - kChartRight;
  Panel part{kChartLeft, kHistoryTop, space, kLikelihoodHeight}, all = part;
  if (stacked) {
    all.top += kPitch;
  } else if (both) {
    const double share = static_cast<double>(split - kFirst) / static_cast<double>(end - kFirst);
    part.width = std::clamp(share, 0.25, 0.75) * (space - kChartLeft);
    all.left = part.right() + kChartLeft;
    all.width = space - kChartLeft - part.width;
  }
  if (split > kFirst) DrawLikelihoods(iterations, kFirst, split, robots, part, "part of the data", &picture);
  if (split < end) DrawLikelihoods(iterations, split, end, robots, all, "all data", &picture);
  return picture;
}

Picture RoundsPicture(const std::vector<RoundTime>& rounds, double width) {
  const auto seconds_each = [](const RoundTime& round) {
    return round.seconds / static_cast<double>(std::max<std::int64_t>(1, round.rounds));
  };
  double longest = 0, count = 0;
  for (const RoundTime& round : rounds) {
    longest = std::max(longest, seconds_each(round));
    count += static_cast<double>(round.rounds);
  }
  if (longest <= 0) return Picture();
  const Panel panel{kChartLeft, 10, width - kChartLeft - kChartRight, 180};
  Picture picture(width, panel.bottom() + kChartBottom, "Wall time of each round");
  // Round k stands over k.
  const Axes axes(panel, {-0.5, count - 0.5}, {0, 1.05 * longest});
  const double pitch = panel.width / count, gap = pitch > 4 ? std::min(4.0, 0.2 * pitch) : 0;
  const int ticks = static_cast<int>(std::clamp(count, 1.0, panel.width / 60));
  DrawAxes(axes, {.x = "round", .y = "wall time [s]", .x_ticks = ticks, .y_ticks = 4}, &picture);
  std::int64_t first = 0;
  for (const RoundTime& round : rounds) {
    const std::int64_t last = first + round.rounds - 1;
    const Point corner = axes.At(static_cast<double>(first) - 0.5, seconds_each(round));
    picture.Rect({corner.x_m + gap / 2, corner.y_m, pitch * static_cast<double>(round.rounds) - gap,
                  panel.bottom() - corner.y_m},
                 "bar",
                 fmt::format("round {}{}{}; {}, {}, {} of computing", first,
                             last > first ? fmt::format(" to {}", last) : "",
                             round.note.empty() ? "" : ": " + round.note, Duration(round.seconds),
                             Count(round.tasks, "task"), Duration(round.compute_seconds)));
    first = last + 1;
  }
  DrawFrame(axes, &picture);
  return picture;
}

}  // namespace cairn::datasets::report
