#include "datasets/reproduce/ball/active.h"

#include <algorithm>
#include <cmath>

#include "datasets/report/drawing/charts.h"
#include "datasets/reproduce/ball/variants.h"
#include "datasets/reproduce/figure_panels.h"
#include "datasets/reproduce/over_seeds.h"
#include "datasets/simulate/corridor/corridor.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr double kTrainedForM = 5;

struct Look {
  const char *stage, *title;
};
constexpr Look kLooks[] = {{"d1", "outer wall (D-1)"}, {"d2", "inner wall (D-2)"},
                           {"d3", "ceiling (D-3)"},    {"turn", "each in turn"},
                           {"active", "active"},       {"all", "all three at once"}};

// Of each value, the index of the nearest in `among`, which ascends or nearly so.
std::vector<std::size_t> Nearest(std::span<const double> values, std::span<const double> among) {
  std::vector<std::size_t> order(among.size()), nearest;
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return among[k]; });
  for (const double value : values) {
    const auto above = std::ranges::lower_bound(order, value, {}, [&](std::size_t k) { return among[k]; });
    if (above == order.begin())
      nearest.push_back(order.front());
    else if (above == order.end() || value - among[*(above - 1)] <= among[*above] - value)
      nearest.push_back(*(above - 1));
    else
      nearest.push_back(*above);
  }
  return nearest;
}

std::string RunPrefix(std::size_t run) { return "run/" + std::to_string(run) + "/"; }

void AddStages(const BallRecipe& recipe, BallJob* ball) {
  for (const std::string& set : CorridorSets()) {
    AddInput(
        "training_" + set,
        WithInputs(ball->inputs.at("training"), [&](const std::string& i) { return i.starts_with(set); }),
        ball);
    AddTraining("networks_" + set, "training_" + set, recipe,
                {{"networks", IntegerValue(kMostBallNetworks)}, {"window_m", RealValue(kTrainedForM)}},
                &ball->job);
  }
  for (const Look& look : kLooks) {
    proto::Stage& stage = *ball->job.add_stages();
    stage.set_name(look.stage);
    stage.set_pipeline("localization");
    auto& inputs = *stage.mutable_inputs();
    auto& options = *stage.mutable_options();
    inputs["samples"] = "samples";
    options["belief"].set_s("grid");
    options["cell_m"].set_d(0.5);
    const std::string name = look.stage;
    if (name.starts_with("d")) {
      inputs["networks"] = "networks_" + name;
      continue;
    }
    options["look"].set_s(name);
    inputs["networks"] = "networks_d1";
    inputs["networks_2"] = "networks_d2";
    inputs["networks_3"] = "networks_d3";
  }
  ball->job.mutable_inputs()->erase("training");  // only its parts are computed with
}

OverSeeds ErrorAfter(const std::vector<ActiveScores>& scores, const std::string& stage, std::size_t sensed) {
  std::vector<double> values;
  for (const ActiveScores& score : scores) {
    const auto& rows = score.at(stage).rows;
    values.push_back(sensed < rows.size() ? rows[sensed].believed.mean_m : NAN);
  }
  return MeanOverSeeds(values);
}

// The mean over stops, robots and seeds up to 9.5 m.
OverSeeds MeanErrorUntil(const std::vector<ActiveScores>& scores, const std::string& stage) {
  constexpr std::size_t kStops = 19;
  std::vector<double> values;
  for (const ActiveScores& score : scores) {
    const auto& rows = score.at(stage).rows;
    double sum = 0;
    for (std::size_t k = 1; k <= kStops; ++k) sum += rows.at(k).believed.mean_m / kStops;
    values.push_back(sum);
  }
  return MeanOverSeeds(values);
}

std::string Metres(const OverSeeds& over) {
  return over.half ? Say("%.2f +- %.2f", over.mean, *over.half) : Say("%.2f", over.mean);
}

}  // namespace

Blob ThreeDirections(const std::vector<Blob>& sets) {
  CAIRN_DEMAND(sets.size() == 3, "three sets");
  Blob joined = sets[0];
  std::vector<std::string> names;
  for (std::size_t s = 0; s < 3; ++s) {
    for (const std::string& input : sets[s].Texts("input_name"))
      names.push_back(CorridorSets()[s] + " " + input);
  }
  const auto runs = sets[0].Texts("runs").size();
  for (std::size_t r = 0; r < runs; ++r) {
    const auto x = sets[0].Get<double>("truth/" + RunPrefix(r) + "x_m");
    std::vector<std::vector<float>> rows(x.size());
    for (const Blob& set : sets) {
      const auto input = set.Get<float>(RunPrefix(r) + "input");
      const std::size_t width = set.Texts("input_name").size();
      const std::vector<std::size_t> nearest = Nearest(x, set.Get<double>("truth/" + RunPrefix(r) + "x_m"));
      for (std::size_t k = 0; k < x.size(); ++k) {
        const auto first = input.begin() + static_cast<std::ptrdiff_t>(nearest[k] * width);
        rows[k].insert(rows[k].end(), first, first + static_cast<std::ptrdiff_t>(width));
      }
    }
    std::vector<float> values;
    for (const auto& row : rows) values.insert(values.end(), row.begin(), row.end());
    joined.Put(RunPrefix(r) + "input",
               Array::Of<float>(
                   {static_cast<std::int64_t>(x.size()), static_cast<std::int64_t>(names.size())}, values));
  }
  joined.Put("input_name", Array::Texts(names));
  return joined;
}

BallJob MakeActiveJob(std::uint64_t seed, const BallRecipe& recipe) {
  std::vector<Blob> sets;
  for (const std::string& set : CorridorSets()) sets.push_back(SimulateCorridor({.set = set, .seed = seed}));
  BallJob ball;
  ball.name = "active_" + std::to_string(seed);
  ball.seed = seed;
  ball.job.set_name("reproduce-ball-" + ball.name);
  ball.job.set_seed(seed);
  Blob samples = ThreeDirections(sets);
  const std::vector<std::string> runs = samples.Texts("runs");
  ball.held_out = runs[seed % runs.size()];
  AddInput("training", WithoutRun(samples, ball.held_out), &ball);
  AddInput("samples", std::move(samples), &ball);
  AddStages(recipe, &ball);
  return ball;
}

ActiveScores ScoreActiveJob(const BallJob& ball, const std::map<std::string, Blob>& results) {
  ActiveScores scores;
  for (const Look& look : kLooks)
    scores[look.stage] = EvaluateLocalization(results.at(look.stage), ball.samples());
  return scores;
}

std::vector<PaperFigure> ActiveFigures(const std::vector<ActiveScores>& scores) {
  PaperFigure figure{
      .file = "active_sensing.png",
      .title = "Section 7: active sensing, mean error against metres travelled, 35 robots a corridor",
      .claim =
          "Pointing the camera so as to minimise the expected future localisation error improves efficiency "
          "and robustness further (Thrun 1996).",
      .measured = {},
      .png = {}};
  const std::vector<std::size_t> shown = {0, 2, 4, 8, 19, 30, 40};
  figure.table.head = {"mean error [m] after"};
  for (const std::size_t k : shown) figure.table.head.push_back(Say("%.1f m", 0.5 * static_cast<double>(k)));
  figure.table.head.emplace_back("mean to 9.5 m");
  report::LineChart plot;
  plot.x_label = "distance travelled [m]";
  plot.y_label = "error [m]";
  plot.y_low = 0;
  std::size_t colour = 0;
  for (const Look& look : kLooks) {
    std::vector<std::string> row = {look.title};
    for (const std::size_t k : shown) row.push_back(Metres(ErrorAfter(scores, look.stage, k)));
    row.push_back(Metres(MeanErrorUntil(scores, look.stage)));
    figure.table.rows.push_back(std::move(row));
    const bool fixed = std::string(look.stage).starts_with("d");
    report::Curve series{.name = look.title, .points = {}, .colour = colour++, .dashed = fixed};
    for (std::size_t k = 0; k <= 50; ++k)
      series.points.push_back({0.5 * static_cast<double>(k), ErrorAfter(scores, look.stage, k).mean});
    plot.curves.push_back(std::move(series));
  }
  figure.measured =
      Say("four networks for +-%g m in each direction; one direction at each stop, but in the last row. "
          "A robot that looks where it pays has %.2f m on average until 9.5 m, one that looks each way "
          "in turn %.2f m.",
          kTrainedForM, MeanErrorUntil(scores, "active").mean, MeanErrorUntil(scores, "turn").mean);
  figure.png = report::ChartsPicture({plot}, 1, 640, 320).Png();
  return {figure};
}

}  // namespace cairn::datasets
