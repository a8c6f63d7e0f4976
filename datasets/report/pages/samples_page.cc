#include <algorithm>
#include <cmath>
#include <vector>

#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/facts.h"
#include "datasets/report/pages/pages.h"
#include "datasets/report/pages/parts.h"
#include "datasets/report/pictures.h"

namespace cairn::datasets::report {
namespace {

std::string RunPrefix(std::size_t run) { return "run/" + std::to_string(run) + "/"; }

double LengthOf(const Path& path) {
  double travelled_m = 0;
  for (std::size_t i = 1; i < path.points.size(); ++i)
    travelled_m += DistanceM(path.points[i - 1], path.points[i]);
  return travelled_m;
}

// What was sensed on a run: a row an input, each over its own range, a column a sample.
struct Sensed {
  std::size_t inputs = 0, samples = 0;
  std::vector<double> share;  // [inputs][samples], in [0, 1]; NaN: not a number
};

Sensed SensedOn(const Blob& samples, std::size_t run) {
  const std::string name = RunPrefix(run) + "input";
  Sensed sensed;
  if (!samples.Has(name) || samples.at(name).shape().size() != 2 || samples.at(name).size() == 0)
    return sensed;
  const auto values = samples.Get<float>(name);
  sensed.samples = static_cast<std::size_t>(samples.at(name).shape()[0]);
  sensed.inputs = static_cast<std::size_t>(samples.at(name).shape()[1]);
  for (std::size_t i = 0; i < sensed.inputs; ++i) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (std::size_t k = 0; k < sensed.samples; ++k) {
      const double value = values[k * sensed.inputs + i];
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    for (std::size_t k = 0; k < sensed.samples; ++k) {
      const double value = values[k * sensed.inputs + i];
      sensed.share.push_back(!std::isfinite(value) ? NAN : high > low ? (value - low) / (high - low) : 0.5);
    }
  }
  return sensed;
}

Picture SensedPicture(const Sensed& sensed, double width) {
  if (sensed.share.empty()) return Picture();
  constexpr double kTop = 8;
  const auto samples = static_cast<double>(sensed.samples), inputs = static_cast<double>(sensed.inputs);
  const Panel panel{kChartLeft, kTop, width - kChartLeft - kChartRight, std::clamp(4 * inputs, 90.0, 420.0)};
  Picture picture(width, panel.bottom() + kChartBottom, "What was sensed along the run");
  const Axes axes(panel, {0, samples}, {inputs, 0});  // the first input on top
  DrawAxes(axes, {.x = "sample", .y = "input"}, &picture);
  Raster raster{static_cast<std::uint32_t>(sensed.samples), static_cast<std::uint32_t>(sensed.inputs)};
  for (const double share : sensed.share)
    raster.Add(std::isnan(share) ? kUnknown : Mix(kPaper, kDensity, share));
  picture.Image(panel, std::move(raster));
  DrawFrame(axes, &picture);
  return picture;
}

}  // namespace

Scene SamplesSceneOf(const Blob& samples) {
  Scene scene;
  const std::vector<std::string> runs = samples.Texts("runs");
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const auto x = samples.Get<double>(RunPrefix(r) + "x_m"), y = samples.Get<double>(RunPrefix(r) + "y_m");
    Path path{.robot = runs[r], .index = r, .points = {}};
    for (std::size_t k = 0; k < x.size(); ++k) path.points.push_back({x[k], y[k]});
    scene.paths.push_back(std::move(path));
  }
  return scene;
}

std::string SamplesHtml(const Blob& samples) {
  const Scene scene = SamplesSceneOf(samples);
  const std::vector<std::string> inputs = samples.Texts("input_name");
  std::int64_t count = 0;
  Table rows{{"run", "samples", "path"}};
  std::string sensed;
  for (std::size_t r = 0; r < scene.paths.size(); ++r) {
    const Path& path = scene.paths[r];
    count += static_cast<std::int64_t>(path.points.size());
    rows.push_back(
        {path.robot, Grouped(static_cast<double>(path.points.size())), Grouped(LengthOf(path), 1) + " m"});
    const Sensed on = SensedOn(samples, r);
    const std::string figure =
        DrawingHtml([&](double width) { return SensedPicture(on, width); },
                    "Each input over its own range on this run, the darker the higher.");
    if (!figure.empty()) sensed += "<h3>" + Escape(path.robot) + "</h3>\n" + figure;
  }
  std::string html =
      "<p class=\"lead\">" +
      Escape(Count(count, "sample") + " in " + Count(static_cast<std::int64_t>(scene.paths.size()), "run") +
             ", of " + Count(static_cast<std::int64_t>(inputs.size()), "input") + ".") +
      "</p>\n";
  html += SectionHtml(
      "Where they were taken",
      LegendHtml(LegendOf(scene)) + DrawingHtml([&](double width) { return MapPicture(scene, width); },
                                                "By the positions that the samples are labelled with."));
  html += SectionHtml("What was sensed", sensed);
  html += SectionHtml("Runs", TableHtml(rows));
  return html + SectionHtml("Time", TimeHtml(RoundTimes(samples)));
}

}  // namespace cairn::datasets::report
