#include "datasets/reproduce/ball/figures.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "datasets/report/drawing/charts.h"
#include "datasets/reproduce/figure_panels.h"
#include "datasets/reproduce/over_seeds.h"

namespace cairn::datasets {
namespace {

using report::ChartPoint;
using report::Curve;
using report::LineChart;

constexpr double kFound_m = 1;
constexpr std::size_t kLearned = 0, kDetected = 1, kPerfect = 2, kThree = 3;  // colours

std::string Title(const std::string& set) { return "D-" + set.substr(1); }

std::vector<std::string> WindowNames(const std::string& before, const std::string& after) {
  std::vector<std::string> names;
  for (const double window_m : BallWindows()) names.push_back(before + Say("%g", window_m) + after);
  return names;
}

std::size_t WindowIndex(double window_m) {
  return static_cast<std::size_t>(std::ranges::find(BallWindows(), window_m) - BallWindows().begin());
}

class BallPage {
 public:
  explicit BallPage(const std::vector<BallScores>& scores) : scores_(scores) {
    for (const BallScores& score : scores_) {
      if (std::ranges::find(sets_, score.set) == sets_.end()) sets_.push_back(score.set);
    }
  }

  std::vector<PaperFigure> Make() {
    Table3();
    Figure3();
    Figure4();
    Figure5();
    Figure6();
    Figure7();
    Figure8();
    Correlations();
    return std::move(figures_);
  }

 private:
  using Measure = std::function<double(const BallScores&)>;

  OverSeeds Over(const std::string& set, const Measure& measure) const {
    std::vector<double> values;
    for (const BallScores& score : scores_) {
      if (score.set == set) values.push_back(measure(score));
    }
    return MeanOverSeeds(values);
  }
  OverSeeds Reduction(const std::string& set, const std::string& what, std::size_t window) const {
    return Over(set, [&](const BallScores& score) { return score.reduction.at(what)[window]; });
  }
  const BallScores& First(const std::string& set) const {
    return *std::ranges::find(scores_, set, &BallScores::set);
  }

  void Table3() {
    PaperFigure figure{.file = {},
                       .title = "Table 3: error reduction in percent, +-2 m",
                       .claim =
                           "D-1, D-2, D-3: doors 8.3 +- 1.1, 1.4 +- 1.5; ceiling lights 15.6 +- 1.4 (D-3); "
                           "BaLL n = 1: 14.9 +- 1.3, 14.2 +- 1.6, 21.0 +- 1.7; n = 2: 33.5, 36.7, 34.5; "
                           "n = 3: 39.7, 36.3, 41.5; n = 4: 41.7 +- 2.5, 36.7 +- 1.9, 42.9 +- 1.6.",
                       .measured =
                           "by the run that nothing was trained on, a seed a corridor; doors (lights on "
                           "D-3) as a detector finds them, and as they truly are.",
                       .png = {}};
    const std::size_t window = WindowIndex(kBallWindowM);
    PaperTable& table = figure.table;
    table.head = {""};
    for (const std::string& set : sets_) table.head.push_back(Title(set));
    const auto add = [&](const std::string& name,
                         const std::function<std::string(const std::string&)>& what) {
      table.rows.push_back({name});
      for (const std::string& set : sets_)
        table.rows.back().push_back(PercentText(Reduction(set, what(set), window)));
    };
    add("doors, lights: detected", DetectedFeature);
    add("doors, lights: perfect", PerfectFeature);
    for (int networks = 1; networks <= kMostBallNetworks; ++networks)
      add(Say("BaLL, n = %d", networks),
          [&](const std::string&) { return BallStage(networks, kBallWindowM); });
    figures_.push_back(std::move(figure));
  }

  struct Comparisons {
    int above = 0, apart = 0, below = 0, all = 0;  // apart, below: by intervals that do not overlap
  };

  // Reductions by window: learned ones as `stage` says for each window, and the hand-made features.
  Comparisons ByWindow(PaperFigure figure, const std::string& name,
                       const std::function<std::string(double)>& stage) {
    std::vector<LineChart> plots;
    figure.table.head = {"percent"};
    for (const std::string& window : WindowNames("+-", " m")) figure.table.head.push_back(window);
    Comparisons counts;
    for (const std::string& set : sets_) {
      LineChart plot{.title = Title(set),
                     .x_label = "uncertainty [+- m]",
                     .y_label = "error reduction [%]",
                     .curves = {},
                     .x_names = WindowNames("", "")};
      const auto add = [&](const std::string& label, std::size_t colour, bool dashed,
                           const std::function<std::string(double)>& what) {
        Curve series{.name = label, .points = {}, .colour = colour, .dashed = dashed, .dots = true};
        figure.table.rows.push_back({Title(set) + " " + label});
        for (std::size_t w = 0; w < BallWindows().size(); ++w) {
          const OverSeeds over = Reduction(set, what(BallWindows()[w]), w);
          figure.table.rows.back().push_back(PercentText(over));
          ChartPoint point{static_cast<double>(w), 100 * over.mean, {}};
          if (over.half) point.bar = {100 * over.low(), 100 * over.high()};
          series.points.push_back(point);
        }
        plot.curves.push_back(std::move(series));
      };
      add(name, kLearned, false, stage);
      add("doors, lights: detected", kDetected, true, [&](double) { return DetectedFeature(set); });
      add("doors, lights: perfect", kPerfect, true, [&](double) { return PerfectFeature(set); });
      plots.push_back(std::move(plot));
      for (std::size_t w = 0; w < BallWindows().size(); ++w) {
        const OverSeeds ours = Reduction(set, stage(BallWindows()[w]), w);
        for (const std::string& feature : {DetectedFeature(set), PerfectFeature(set)}) {
          const OverSeeds theirs = Reduction(set, feature, w);
          ++counts.all;
          counts.above += ours.mean > theirs.mean ? 1 : 0;
          counts.apart += ours.half && ours.low() > theirs.high() ? 1 : 0;
          counts.below += ours.half && ours.high() < theirs.low() ? 1 : 0;
        }
      }
    }
    figure.measured =
        Say("BaLL is above in %d of %d comparisons of a set, a window and a hand-made feature "
            "(detected, perfect); by 95%% intervals that do not overlap above in %d, below in %d.",
            counts.above, counts.all, counts.apart, counts.below);
    figure.png = report::ChartsPicture(plots, 3, 300, 240).Png();
    figures_.push_back(std::move(figure));
    return counts;
  }

  void Figure3() {
    const Comparisons counts = ByWindow(
        {.file = "figure_03.png",
         .title = "Figure 3: one network, trained and tested at the same uncertainty",
         .claim = "BaLL significantly outperforms doors and lights: D-1 14.9 against 8.3 at +-2 m, 36.9 "
                  "against 5.0 at +-50 m; D-2 15.6 against 9.8 at +-5 m, 27.5 against 0.0 at +-89 m; D-3 "
                  "21.0 against 15.6 at +-2 m, 39.5 at +-50 m.",
         .measured = {},
         .png = {}},
        "BaLL, n = 1", [](double window_m) { return BallStage(1, window_m); });
    figures_.back().holds = counts.apart == counts.all;
  }

  void Figure4() {
    const Comparisons counts = ByWindow(
        {.file = "figure_04.png",
         .title = "Figure 4: four networks, trained for +-2 m, tested at all uncertainties",
         .claim = "Performance degrades gracefully; BaLL still outperforms both alternatives or gives "
                  "statistically indistinguishable results.",
         .measured = {},
         .png = {}},
        "BaLL, n = 4", [](double) { return BallStage(kMostBallNetworks, kBallWindowM); });
    figures_.back().holds = counts.below == 0;
  }

  void Figure5() {
    const BallScores& first = First(sets_.front());
    std::vector<LineChart> plots;
    std::string errors;
    for (std::size_t k = 0; k < first.belief.size(); ++k) {
      const BeliefRow& row = first.belief[k];
      LineChart plot;
      plot.title = Say("%zu sensed, %.1f m on the way: error %.2f m", k, row.travelled_m, row.error_m);
      if (k + 1 == first.belief.size()) plot.x_label = "along the corridor [m]; red: where the robot is";
      plot.marked_x = row.true_x_m;
      plot.y_low = 0;
      const auto bins = static_cast<double>(row.density.size());
      Curve series{.name = {}, .points = {}, .colour = kLearned};
      for (std::size_t b = 0; b < row.density.size(); ++b)
        series.points.push_back({(static_cast<double>(b) + 0.5) / bins * first.length_m, row.density[b]});
      plot.curves.push_back(std::move(series));
      plots.push_back(std::move(plot));
      errors += Say("%s %.1f", k == 0 ? "" : ",", row.error_m);
    }
    figures_.push_back(
        {.file = "figure_05.png",
         .title = "Figure 5: a belief over one run, " + Title(first.set),
         .claim = "Uniform at first; after four sensor readings (2 m) it is centred on the correct "
                  "position.",
         .measured =
             "the first of the 35 robots of the first seed; error in m, reading by reading:" + errors + ".",
         .png = report::ChartsPicture(plots, 1, 900, 54).Png()});
  }

  OverSeeds ErrorAfter(const std::string& set, const std::string& stage, std::size_t sensed) const {
    return Over(set, [&](const BallScores& score) {
      const auto& rows = score.localization.at(stage).rows;
      return sensed < rows.size() ? rows[sensed].believed.mean_m : NAN;
    });
  }

  // Sensations after which the mean error over seeds stays below 1 m; -1: it does not.
  int FoundAfter(const std::string& set, const std::string& stage) const {
    const std::size_t rows = First(set).localization.at(stage).rows.size();
    int found = -1;
    for (std::size_t k = 0; k < rows; ++k) {
      const double error_m = ErrorAfter(set, stage, k).mean;
      if (std::isnan(error_m)) break;
      if (error_m >= kFound_m)
        found = -1;
      else if (found < 0)
        found = static_cast<int>(k);
    }
    return found;
  }

  void Figure6() {
    PaperFigure figure{
        .file = "figure_06.png",
        .title = "Figure 6: global localisation, mean error against metres travelled, 35 robots a corridor",
        .claim =
            "After 9.5 m BaLL's mean error is below 1 m; doors have 7.46 m after 30 m, which BaLL has after "
            "4 m. 19 readings for the 5.4 bits from 42.2 m to 1 m: 3.5 a bit.",
        .measured = {},
        .png = {}};
    figure.table.head = {"mean error [m] after"};
    const std::vector<std::size_t> shown = {0, 4, 8, 19, 30, 40, 56};
    for (const std::size_t k : shown)
      figure.table.head.push_back(Say("%.1f m", 0.5 * static_cast<double>(k)));
    figure.table.head.emplace_back("below 1 m after");
    figure.table.head.emplace_back("readings a bit");
    std::vector<LineChart> plots;
    for (const std::string& set : sets_) {
      LineChart plot{.title = Title(set),
                     .x_label = "distance travelled [m]",
                     .y_label = "error [m]",
                     .curves = {},
                     .y_low = 0};
      const auto add = [&](const std::string& label, const std::string& stage, std::size_t colour,
                           bool dashed) {
        Curve series{.name = label, .points = {}, .colour = colour, .dashed = dashed};
        const std::size_t rows = First(set).localization.at(stage).rows.size();
        for (std::size_t k = 0; k < rows; ++k) {
          const OverSeeds error = ErrorAfter(set, stage, k);
          ChartPoint point{0.5 * static_cast<double>(k), error.mean, {}};
          if (error.half && k % 4 == 0) point.bar = {std::max(0.0, error.low()), error.high()};
          series.points.push_back(point);
        }
        plot.curves.push_back(std::move(series));
        std::vector<std::string> cells = {Title(set) + " " + label};
        for (const std::size_t k : shown) {
          const OverSeeds error = ErrorAfter(set, stage, k);
          cells.push_back(error.half ? Say("%.2f +- %.2f", error.mean, *error.half)
                                     : Say("%.2f", error.mean));
        }
        const int found = FoundAfter(set, stage);
        cells.push_back(found < 0 ? "never" : Say("%.1f m", 0.5 * found));
        cells.push_back(
            found <= 0 ? "" : Say("%.1f", found / std::log2(ErrorAfter(set, stage, 0).mean / kFound_m)));
        figure.table.rows.push_back(std::move(cells));
      };
      add("BaLL, n = 4 for +-2 m", "locate", kLearned, false);
      add("BaLL, n = 4 for each of +-5, 10, 89 m", "locate_three", kThree, false);
      add("doors, lights: detected", "locate_detected", kDetected, true);
      add("doors, lights: perfect", "locate_perfect", kPerfect, true);
      plots.push_back(std::move(plot));
    }
    figure.measured =
        "the mean over the belief of the distance to the true position, over 35 robots a seed. Readings a "
        "bit: those until 1 m over log2 of the error at the start in m.";
    figure.png = report::ChartsPicture(plots, 3, 300, 240).Png();
    figures_.push_back(std::move(figure));
  }

  static LineChart ChartOf(const OutputCurve& curve, std::size_t network, const std::string& title,
                           bool last) {
    LineChart plot;
    plot.title = title;
    if (last) plot.x_label = "along the corridor [m]";
    plot.y_low = 0;
    plot.y_high = 1;
    Curve series{.name = {}, .points = {}, .colour = network};
    for (std::size_t k = 0; k < curve.x_m.size(); ++k)
      series.points.push_back({curve.x_m[k], curve.output[k * curve.networks + network]});
    plot.curves.push_back(std::move(series));
    return plot;
  }

  void Figure7() {
    const BallScores& first = First(sets_.front());
    std::vector<LineChart> plots;
    for (const double window_m : {2.0, 10.0, 89.0})
      plots.push_back(ChartOf(first.outputs.at(BallStage(1, window_m)), 0,
                              Say("trained for +-%g m", window_m), window_m == 89.0));
    figures_.push_back(
        {.file = "figure_07.png",
         .title = "Figure 7: a network's output along the corridor, " + Title(first.set),
         .claim = "Trained for +-2 m it is sensitive to local features (doors, hallways, dark spots), "
                  "for +-89 m to the colour of the walls alone.",
         .measured = "the first seed's held-out run; a quarter of the simulated corridor is orange.",
         .png = report::ChartsPicture(plots, 1, 900, 110).Png()});
  }

  void Figure8() {
    const BallScores& first = First(sets_.front());
    const OutputCurve& curve = first.outputs.at(BallStage(kMostBallNetworks, kBallWindowM));
    std::vector<LineChart> plots;
    for (std::size_t i = 0; i < curve.networks; ++i)
      plots.push_back(ChartOf(curve, i, Say("network %zu", i + 1), i + 1 == curve.networks));
    figures_.push_back({.file = "figure_08.png",
                        .title = "Figure 8: four networks trained together for +-2 m, " + Title(first.set),
                        .claim = "The networks specialise to different perceptual features.",
                        .measured = Say("the first seed's held-out run; the mean absolute correlation of two "
                                        "networks' outputs is %.2f.",
                                        first.correlation),
                        .png = report::ChartsPicture(plots, 1, 900, 110).Png()});
  }

  void Correlations() {
    PaperFigure figure{
        .file = {},
        .title = "Section 5.2.2: correlation between the networks' outputs, n = 4, +-2 m",
        .claim = "The output of the networks is largely uncorrelated.",
        .measured = "mean over the six pairs of the absolute correlation, on the held-out run.",
        .png = {}};
    figure.holds = true;
    figure.table.head = {""};
    figure.table.rows = {{"mean |correlation|"}};
    for (const std::string& set : sets_) {
      figure.table.head.push_back(Title(set));
      const OverSeeds over = Over(set, [](const BallScores& score) { return score.correlation; });
      // Two outputs that share less than a quarter of their variance.
      figure.holds = *figure.holds && over.mean < 0.5;
      figure.table.rows[0].push_back(over.half ? Say("%.2f +- %.2f", over.mean, *over.half)
                                               : Say("%.2f", over.mean));
    }
    figures_.push_back(std::move(figure));
  }

  const std::vector<BallScores>& scores_;
  std::vector<std::string> sets_;
  std::vector<PaperFigure> figures_;
};

}  // namespace

std::vector<PaperFigure> BallFigures(const std::vector<BallScores>& scores) {
  return BallPage(scores).Make();
}

}  // namespace cairn::datasets
