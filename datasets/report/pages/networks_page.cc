#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/facts.h"
#include "datasets/report/pages/pages.h"
#include "datasets/report/pages/parts.h"
#include "schema/kinds/learning.h"

namespace cairn::datasets::report {
namespace {

std::string Percent(double share) { return Short(100 * share, 1) + "%"; }

struct TrainingHistory {
  std::vector<double> error, validation, norm;
  double prior = 0, validation_prior = 0;

  std::size_t steps() const { return error.size(); }
  double Reduction() const { return error.empty() ? 0 : 1 - error.back() / prior; }
  // The best that the held-out run saw; NaN where none was held out.
  double BestHeldOut() const {
    double best = NAN;
    for (const double e : validation)
      if (std::isfinite(e) && !(e >= best)) best = e;
    return 1 - best / validation_prior;
  }
};

TrainingHistory HistoryOf(const kinds::Networks& of) {
  return {of.history.training_error_m.vector(), of.history.validation_error_m.vector(),
          of.history.gradient_norm.vector(), of.prior_error_m.Scalar(), of.validation_prior_error_m.Scalar()};
}

// By step, from 1.
std::vector<ChartPoint> ByStep(const std::vector<double>& values, double scale = 1, double offset = 0) {
  std::vector<ChartPoint> points;
  for (std::size_t i = 0; i < values.size(); ++i)
    points.push_back({static_cast<double>(i + 1), offset + scale * values[i]});
  return points;
}

std::string TrainingHtml(const TrainingHistory& h) {
  std::vector<Curve> reductions{{"trained on", ByStep(h.error, -100 / h.prior, 100), 0}};
  std::vector<Curve> errors{{"trained on", ByStep(h.error), 0}};
  if (std::isfinite(h.validation_prior)) {
    reductions.push_back({"held out", ByStep(h.validation, -100 / h.validation_prior, 100), 1});
    errors.push_back({"held out", ByStep(h.validation), 1});
  }
  const std::string caption =
      "Before each step. Of mini-batches the error is that of the true positions drawn; where networks come "
      "one "
      "after "
      "another, that of those in use.";
  return ChartHtml({"Error reduction", "step", "error reduction [%]", reductions}, caption) +
         ChartHtml({"Posterior error", "step", "E posterior [m]", errors}, "") +
         ChartHtml({"Gradient", "step", "norm of the gradient", {{"trained on", ByStep(h.norm), 0}}, true},
                   "");
}

}  // namespace

std::vector<std::vector<ChartPoint>> OutputsAlongRun(const Blob& result) {
  const auto map = FieldsIn<kinds::Networks::Map>("map/", result);
  const std::span<const std::int32_t> run = map.run;
  const std::span<const double> along = map.along_m;
  const std::span<const float> output = map.output;
  if (run.empty()) throw InputError("'map/run' is empty: there is nothing to draw");
  const std::size_t networks = output.size() / run.size();
  std::vector<std::size_t> order;
  const std::int32_t first = *std::ranges::min_element(run);
  for (std::size_t k = 0; k < run.size(); ++k)
    if (run[k] == first) order.push_back(k);
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return along[k]; });
  std::vector<std::vector<ChartPoint>> outputs(networks);
  for (std::size_t n = 0; n < networks; ++n) {
    for (const std::size_t k : order) outputs[n].push_back({along[k], output[k * networks + n]});
  }
  return outputs;
}

std::string OutputsHtml(const Blob& result) {
  std::string html;
  const auto outputs = OutputsAlongRun(result);
  for (std::size_t n = 0; n < outputs.size(); ++n) {
    html += ChartHtml(
        {"Network " + std::to_string(n), "distance travelled [m]", "P(f = 1)", {Curve{"", outputs[n], n}}},
        "", 150);
  }
  return html.empty()
             ? ""
             : "<p>Of the first run among those trained on: how likely each network's feature is.</p>\n" +
                   html;
}

namespace {

// Of each network, layer by layer.
std::string HiddenUnits(const kinds::Networks::Weights& weights) {
  std::string units;
  for (const Column<double>* bias : {&weights.hidden_bias, &weights.hidden_2_bias})
    if (*bias) units += (units.empty() ? "" : " + ") + std::to_string(bias->shape().back());
  return units;
}

std::string Tiles(const Blob& result, const kinds::Networks& of, const TrainingHistory& h) {
  const double window_m = of.window_m.Scalar();
  const double held_out = h.BestHeldOut();
  std::string tiles =
      CountTileHtml(static_cast<std::int64_t>(of.networks.output_bias.size()), "network") +
      TileHtml(HiddenUnits(of.networks), "hidden units of each") +
      TileHtml(window_m > 0 ? "±" + Short(window_m) + " m" : "global", "uncertainty trained for") +
      TileHtml(Percent(h.Reduction()), "error reduction, runs trained on");
  if (std::isfinite(held_out))
    tiles += TileHtml(Percent(held_out), "the best on the held-out run, which chose it");
  if (of.starts_chosen)
    tiles += TileHtml(
        std::to_string(of.starts_chosen.Scalar()) + " of " + std::to_string(of.starts_error_m.size()),
        "start (from 0 on) that went on");
  tiles += TileHtml(Grouped(static_cast<double>(h.steps())), "steps");
  return TilesHtml(tiles + WallTimeTile(result));
}

std::string Warnings(const kinds::Networks& of) {
  std::string items;
  for (const Texts& texts : {of.input_doubts, of.warnings})
    for (const std::string& warning : texts.OrNone()) items += "<li>" + Escape(warning) + "</li>\n";
  return items.empty() ? "" : "<ul class=\"bad\">\n" + items + "</ul>\n";
}

std::string Ancestry(const kinds::Networks::Ancestry& of) {
  if (!of.hash) return "";
  Table rows{{"result", "steps", "error reduction", "options"}};
  for (std::size_t i = 0; i < of.hash.size(); ++i) {
    rows.push_back({of.hash[i].substr(0, 8), std::to_string(of.steps[i]),
                    Percent(1 - of.training_error_m[i] / of.prior_error_m[i]), of.options[i]});
  }
  return TableHtml(rows);
}

}  // namespace

std::string NetworksHtml(const Blob& result) {
  const auto of = Read<kinds::Networks>(result);
  const TrainingHistory h = HistoryOf(of);
  std::string html = "<p class=\"lead\">" + Count(static_cast<std::int64_t>(of.map.x_m.size()), "sample") +
                     " of " + Count(static_cast<std::int64_t>(of.networks.input_mean.size()), "input") +
                     " trained on.</p>\n";
  html += Tiles(result, of, h);
  html += SectionHtml("Warnings", Warnings(of));
  html += SectionHtml("Training", TrainingHtml(h));
  html += SectionHtml("What the networks see", OutputsHtml(result));
  html += SectionHtml("Time", TimeHtml(RoundTimes(result)));
  return html + SectionHtml("Before this run", Ancestry(of.ancestry));
}

std::string NetworksPng(const Blob& result) {
  std::vector<LineChart> charts;
  for (const auto& output : OutputsAlongRun(result)) {
    charts.push_back({.title = fmt::format("network {}", charts.size()),
                      .x_label = {},
                      .y_label = "P(f = 1)",
                      .curves = {{.name = {}, .points = output, .colour = charts.size()}},
                      .y_low = 0,
                      .y_high = 1});
  }
  if (charts.empty()) throw InputError("there are no networks in it to draw");
  charts.back().x_label = "distance travelled in the first run [m]";
  return ChartsPicture(charts, 1, 900, 110).Png();
}

}  // namespace cairn::datasets::report
