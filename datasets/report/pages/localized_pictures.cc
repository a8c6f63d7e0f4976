#include "datasets/report/pages/localized_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/parts.h"
#include "datasets/report/pictures.h"

namespace cairn::datasets::report {
namespace {

constexpr double kErrorHeight = 220;
constexpr double kFlat = 6;         // a box so many times longer than it is high counts as a line
constexpr std::size_t kBins = 150;  // of a belief, along the longer side of the positions' box

struct Traverse {
  std::size_t first, end;
};

std::vector<Traverse> TraversesOf(const LocalizedSteps& localized) {
  std::vector<Traverse> traverses;
  for (std::size_t k = 0; k < localized.steps.size(); ++k) {
    if (localized.steps[k].sensations == 0) traverses.push_back({k, k});
    traverses.back().end = k + 1;
  }
  return traverses;
}

template <class Value>
Curve MeanCurve(const LocalizationScore& score, const char* name, std::size_t colour, bool band,
                const Value& value) {
  Curve curve{.name = name, .points = {}, .colour = colour};
  for (const LocalizationRow& row : score.rows) {
    const std::optional<MeanError> error = value(row);
    if (!error) continue;
    curve.points.push_back({row.travelled_m, error->mean_m});
    if (!band || !error->interval_95) continue;
    curve.low.push_back({row.travelled_m, std::max(0.0, error->interval_95->low)});
    curve.high.push_back({row.travelled_m, error->interval_95->high});
  }
  return curve;
}

// Root of the mean square over the traverses, by sensations.
template <class Value>
Curve RootMeanSquare(const std::vector<LocalizedStep>& steps, const char* name, std::size_t colour,
                     const Value& value) {
  struct Sum {
    double squares = 0, travelled_m = 0, count = 0;
  };
  std::vector<Sum> sums;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (steps[k].sensations >= sums.size()) sums.resize(steps[k].sensations + 1);
    Sum& sum = sums[steps[k].sensations];
    sum.squares += std::pow(value(k), 2);
    sum.travelled_m += steps[k].travelled_m;
    sum.count += 1;
  }
  Curve curve{.name = name, .points = {}, .colour = colour};
  for (const Sum& sum : sums)
    curve.points.push_back({sum.travelled_m / sum.count, std::sqrt(sum.squares / sum.count)});
  return curve;
}

Box LocalizedBox(const LocalizedSteps& localized) {
  Span x, y;
  for (const Point& p : localized.positions) {
    x.Take(p.x_m);
    y.Take(p.y_m);
  }
  return {x.low, x.high, y.low, y.high};
}

// Of the positions' longer side.
struct Axis {
  bool y = false;
  double low = 0, length = 1;
  double At(const Point& p) const { return y ? p.y_m : p.x_m; }
};

Axis LongerSide(const Box& box) {
  const bool y = box.height_m() > box.width_m();
  return {y, y ? box.y_low_m : box.x_low_m, std::max(1e-3, y ? box.height_m() : box.width_m())};
}

// Beliefs of a traverse, a column a step, along the axis; shared between the two nearest bins, so that
// positions as far apart as bins leave no stripes.
Grid Beliefs(const LocalizedSteps& localized, const Traverse& traverse, const Axis& axis) {
  Grid grid;
  grid.columns = static_cast<std::int64_t>(traverse.end - traverse.first);
  grid.rows = static_cast<std::int64_t>(std::clamp<std::size_t>(localized.positions.size(), 2, kBins));
  const auto columns = static_cast<std::size_t>(grid.columns), rows = static_cast<std::size_t>(grid.rows);
  grid.probability.assign(columns * rows, 0.0);
  for (std::size_t column = 0; column < columns; ++column) {
    const LocalizedStep& step = localized.steps[traverse.first + column];
    for (std::size_t i = step.first; i < step.end; ++i) {
      const Point& position = localized.positions[static_cast<std::size_t>(localized.position[i])];
      const double at = (axis.At(position) - axis.low) / axis.length * static_cast<double>(rows - 1);
      const auto below = std::min(rows - 2, static_cast<std::size_t>(std::max(0.0, at)));
      const double share = std::clamp(at - static_cast<double>(below), 0.0, 1.0);
      grid.probability[below * columns + column] += (1 - share) * localized.probability[i];
      grid.probability[(below + 1) * columns + column] += share * localized.probability[i];
    }
  }
  return grid;
}

// Distance travelled from left to right, the positions' longer side upwards.
Picture LineBelief(const LocalizedSteps& localized, const LocalizationScore* score, const Traverse& traverse,
                   const Axis& axis, double width) {
  constexpr double kHeight = 330;
  const Panel panel{kChartLeft, 10, width - kChartLeft - kChartRight, kHeight};
  Picture picture(width, panel.bottom() + kChartBottom, "Belief of one robot by distance travelled");
  const double travelled_m = std::max(1e-3, localized.steps[traverse.end - 1].travelled_m);
  const Axes axes(panel, {0, travelled_m}, {axis.low, axis.low + axis.length});
  DrawAxes(axes, {.x = "distance travelled [m]", .y = axis.y ? "y [m]" : "x [m]", .y_ticks = 6}, &picture);
  picture.BeginClip(panel);
  // A column of cells reaches half a step to either side, a row half a bin; the outermost are cut.
  const Grid grid = Beliefs(localized, traverse, axis);
  const double step = panel.width / std::max(1.0, static_cast<double>(grid.columns - 1)),
               bin = panel.height / static_cast<double>(grid.rows - 1);
  picture.Image({panel.left - step / 2, panel.top - bin / 2, panel.width + step, panel.height + bin},
                GridRaster(grid));
  std::vector<Point> truth, mean;
  for (std::size_t k = traverse.first; k < traverse.end; ++k) {
    const LocalizedStep& at = localized.steps[k];
    if (score != nullptr) truth.push_back(axes.At(at.travelled_m, axis.At(score->steps[k].truth)));
    mean.push_back(axes.At(at.travelled_m, axis.At(at.mean)));
  }
  picture.Polyline(truth, "truth-path");
  picture.Polyline(mean, "path r2");
  picture.EndClip();
  DrawFrame(axes, &picture);
  return picture;
}

// Of one step, in the plane.
Grid BeliefInPlane(const LocalizedSteps& localized, const LocalizedStep& step, const Box& box) {
  Grid grid;
  grid.cell_m = std::max(box.width_m(), box.height_m()) / 60;
  grid.origin = {box.x_low_m - 0.5 * grid.cell_m, box.y_low_m - 0.5 * grid.cell_m};
  grid.columns = static_cast<std::int64_t>(box.width_m() / grid.cell_m) + 2;
  grid.rows = static_cast<std::int64_t>(box.height_m() / grid.cell_m) + 2;
  grid.probability.assign(static_cast<std::size_t>(grid.columns * grid.rows), 0.0);
  for (std::size_t i = step.first; i < step.end; ++i) {
    const Point& position = localized.positions[static_cast<std::size_t>(localized.position[i])];
    const auto column = static_cast<std::int64_t>((position.x_m - grid.origin.x_m) / grid.cell_m);
    const auto row = static_cast<std::int64_t>((position.y_m - grid.origin.y_m) / grid.cell_m);
    grid.probability[static_cast<std::size_t>(row * grid.columns + column)] += localized.probability[i];
  }
  return grid;
}

void DrawBelief(const LocalizedSteps& localized, const LocalizationScore* score, const Traverse& traverse,
                std::size_t at, const Box& box, const Panel& panel, Picture* picture) {
  const LocalizedStep& step = localized.steps[at];
  const MapFrame frame(box, panel);
  const Grid grid = BeliefInPlane(localized, step, box);
  picture->Rect(panel, "panel");
  picture->BeginClip(panel);
  picture->Image(frame.At(BoxOf(grid)), GridRaster(grid));
  std::string title = fmt::format("{} sensed, {} m", step.sensations, Short(step.travelled_m, 1));
  if (score != nullptr) {
    std::vector<Point> truth;
    for (std::size_t k = traverse.first; k <= at; ++k) truth.push_back(frame.At(score->steps[k].truth));
    picture->Circle(truth.back(), 6, "truth-landmark");
    picture->Polyline(std::move(truth), "truth-path");
    title += fmt::format(": error {} m", Short(score->steps[at].believed_m));
  }
  picture->Circle(frame.At(step.mean), 3.5, "start r2");
  picture->EndClip();
  picture->Rect(panel, "frame");
  picture->Text({panel.left, panel.top - 6}, title, "heading");
}

// Six maps, at the start, at the end and between them, ever farther apart.
Picture MapBeliefs(const LocalizedSteps& localized, const LocalizationScore* score, const Traverse& traverse,
                   Box box, double full_width) {
  constexpr double kGap = 20, kTitle = 26, kBelow = 6, kNarrowestMap = 300;
  const auto columns = static_cast<std::size_t>(std::clamp(full_width / kNarrowestMap, 1.0, 3.0));
  const std::size_t last = traverse.end - traverse.first - 1;
  std::vector<std::size_t> shown;
  for (const double share : {0.0, 0.05, 0.12, 0.25, 0.5, 1.0}) {
    const auto at = static_cast<std::size_t>(std::lround(share * static_cast<double>(last)));
    if (shown.empty() || at > shown.back()) shown.push_back(at);
  }
  box = {box.x_low_m - 0.5, box.x_high_m + 0.5, box.y_low_m - 0.5, box.y_high_m + 0.5};
  const double width = (full_width + kGap) / static_cast<double>(columns) - kGap,
               height = PanelHeight(box, width, 120, 400), pitch = kTitle + height + kBelow;
  const std::size_t rows = (shown.size() + columns - 1) / columns;
  Picture picture(full_width, static_cast<double>(rows) * pitch, "Belief of one robot on its way");
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const std::size_t in_column = i / columns;
    const auto column = static_cast<double>(i % columns), row = static_cast<double>(in_column);
    DrawBelief(localized, score, traverse, traverse.first + shown[i], box,
               {column * (width + kGap), kTitle + row * pitch, width, height}, &picture);
  }
  return picture;
}

LineChart MeanErrors(const LocalizationScore& score) {
  const auto believed = [](const LocalizationRow& row) -> const MeanError& { return row.believed; };
  const Curve mean = MeanCurve(score, "over the belief, with its 95% interval", 0, true, believed);
  return {"Mean error over the robots",
          "distance travelled [m]",
          "error [m]",
          {mean,
           MeanCurve(score, "of the belief's mean", 2, false,
                     [](const LocalizationRow& row) -> const MeanError& { return row.mean; }),
           MeanCurve(score, "of the most likely position", 1, false,
                     [](const LocalizationRow& row) { return row.mode; })}};
}

LineChart EachError(const LocalizationScore& score) {
  LineChart each{"Each robot", "distance travelled [m]", "error [m]", {}};
  for (const LocalizationError& step : score.steps) {
    if (step.sensations == 0) {
      each.curves.push_back(
          {.name = "", .points = {}, .colour = each.curves.size(), .faint = score.traverses > 6});
    }
    each.curves.back().points.push_back({step.travelled_m, step.believed_m});
  }
  return each;
}

// In other colours than the errors above it, with which it shares a legend.
LineChart HowSure(const LocalizedSteps& localized, const LocalizationScore* score) {
  LineChart chart{"Root of the mean square over the robots", "distance travelled [m]", "distance [m]", {}};
  chart.curves.push_back(RootMeanSquare(localized.steps, "as far off as it believes to be", 3,
                                        [&](std::size_t k) { return localized.steps[k].spread_m; }));
  if (score != nullptr) {
    chart.curves.push_back(RootMeanSquare(localized.steps, "as far off as it is", 4,
                                          [&](std::size_t k) { return score->steps[k].mean_m; }));
  }
  return chart;
}

}  // namespace

std::string ErrorHtml(const LocalizationScore& score, const std::string& caption) {
  return ChartHtml(MeanErrors(score), caption, kErrorHeight) + ChartHtml(EachError(score), "", kErrorHeight);
}

std::string SureHtml(const LocalizedSteps& localized, const LocalizationScore* score,
                     const std::string& caption) {
  std::string html = ChartHtml(HowSure(localized, score), caption, kErrorHeight);
  if (score == nullptr || score->heading != "unknown") return html;
  LineChart facing{"Believed of facing as it does", "distance travelled [m]", "mean over the robots [%]", {}};
  Curve curve{.name = "", .points = {}, .colour = 0};
  for (const LocalizationRow& row : score->rows) curve.points.push_back({row.travelled_m, 100 * row.facing});
  facing.curves.push_back(curve);
  return html + ChartHtml(facing, "", kErrorHeight);
}

std::string LocalizationPng(const LocalizedSteps& localized, const LocalizationScore* score) {
  std::vector<LineChart> charts;
  if (score != nullptr) charts.push_back(MeanErrors(*score));
  charts.push_back(HowSure(localized, score));
  return ChartsPicture(charts, 1, 900, 320).Png();
}

Picture BeliefPicture(const LocalizedSteps& localized, const LocalizationScore* score, std::size_t traverse,
                      double width) {
  const Traverse of = TraversesOf(localized)[traverse];
  const Box box = LocalizedBox(localized);
  const double longer = std::max(box.width_m(), box.height_m()),
               shorter = std::min(box.width_m(), box.height_m());
  return longer >= kFlat * shorter ? LineBelief(localized, score, of, LongerSide(box), width)
                                   : MapBeliefs(localized, score, of, box, width);
}

Examples ExamplesOf(const LocalizedSteps& localized, const LocalizationScore* score) {
  std::vector<std::pair<double, std::size_t>> errors;
  for (const Traverse& traverse : TraversesOf(localized)) {
    double sum = 0;
    for (std::size_t k = traverse.first; k < traverse.end; ++k)
      sum += score != nullptr ? score->steps[k].believed_m : localized.steps[k].spread_m;
    errors.emplace_back(sum / static_cast<double>(traverse.end - traverse.first), errors.size());
  }
  std::ranges::sort(errors);
  return {errors[(errors.size() - 1) / 2].second, errors.back().second};
}

}  // namespace cairn::datasets::report
