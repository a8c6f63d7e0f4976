#include "datasets/reproduce/ball/adapt.h"

#include <cmath>

#include "datasets/evaluate/learning/learned_networks.h"
#include "datasets/evaluate/learning/networks.h"
#include "datasets/reproduce/figure_panels.h"
#include "datasets/reproduce/over_seeds.h"
#include "datasets/simulate/corridor/corridor.h"
#include "schema/geometry.h"

namespace cairn::datasets {
namespace {

constexpr int kRuns = 7;  // three to train on, three to adapt on, one to test on
// A sensation each 0.1 m or so, five times as often as where each counts by the power of 0.5.
constexpr double kEveryM = 0.05, kTrust = 0.1;

struct AdaptRow {
  const char *key, *title;
};
constexpr AdaptRow kRows[] = {{"before", "before the change, networks and map of then"},
                              {"stale", "after it, networks and map of before"},
                              {"map", "networks of before, map by the robot's own labels"},
                              {"adapted", "networks trained on with the robot's own labels"},
                              {"anew", "networks trained anew with the robot's own labels"},
                              {"labelled", "networks trained anew with the simulator's labels"}};

std::string PrefixOf(std::size_t run) { return "run/" + std::to_string(run) + "/"; }

// Some runs of samples, by another name, so that nobody takes them for runs of before the change.
Blob RunsFrom(const Blob& samples, std::size_t first, std::size_t end, const std::string& name) {
  Blob part = samples.Without("run/").Without("truth/");
  std::vector<std::string> names;
  for (std::size_t r = first; r < end; ++r) {
    for (const std::string& group : {std::string(), std::string("truth/")})
      part.PutAll(group + PrefixOf(names.size()), samples.Sub(group + PrefixOf(r)));
    names.push_back(name + " " + std::to_string(r + 1));
  }
  part.Put("runs", Array::Texts(names));
  return part;
}

// The networks with another map: what they make of these samples, at the positions that are written there.
Blob WithMapOf(const Blob& networks, const Blob& samples) {
  const LearnedNetworks nets = ReadLearnedNetworks(networks);
  std::vector<double> x, y;
  std::vector<float> output;
  std::vector<std::int32_t> run;
  const std::vector<std::string> runs = samples.Texts("runs");
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const auto run_x = samples.Get<double>(PrefixOf(r) + "x_m"),
               run_y = samples.Get<double>(PrefixOf(r) + "y_m");
    x.insert(x.end(), run_x.begin(), run_x.end());
    y.insert(y.end(), run_y.begin(), run_y.end());
    run.insert(run.end(), run_x.size(), static_cast<std::int32_t>(r));
    for (const double g : OutputsOf(nets, samples.Get<float>(PrefixOf(r) + "input")))
      output.push_back(static_cast<float>(g));
  }
  Blob with = networks;
  with.Put("runs", Array::Texts(runs));
  with.PutVector("map/x_m", x);
  with.PutVector("map/y_m", y);
  with.PutVector("map/along_m", x);
  with.PutVector("map/run", run);
  with.Put("map/output",
           Array::Of<float>({static_cast<std::int64_t>(x.size()), static_cast<std::int64_t>(nets.networks)},
                            output));
  return with;
}

double Reduction(const Blob& networks, const Blob& samples) {
  ScoreOptions how;
  how.samplings = 1;
  how.windows_m = {kBallWindowM};
  return EvaluateNetworks(networks, samples, how).windows.front().soft.error_reduction.value_or(NAN);
}

double LabelError(const Blob& labelled) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t r = 0; r < labelled.Texts("runs").size(); ++r) {
    const auto x = labelled.Get<double>(PrefixOf(r) + "x_m"), y = labelled.Get<double>(PrefixOf(r) + "y_m");
    const auto true_x = labelled.Get<double>("truth/" + PrefixOf(r) + "x_m"),
               true_y = labelled.Get<double>("truth/" + PrefixOf(r) + "y_m");
    for (std::size_t k = 0; k < x.size(); ++k, ++count)
      sum += DistanceM(Point{x[k], y[k]}, Point{true_x[k], true_y[k]});
  }
  return sum / static_cast<double>(count);
}

}  // namespace

Blob SelfLabelled(const Blob& samples, const Blob& located) {
  const auto run = located.Get<std::int32_t>("step/run"), sample = located.Get<std::int32_t>("step/sample"),
             traverse = located.Get<std::int32_t>("step/traverse");
  const auto x = located.Get<double>("step/mean_x_m"), y = located.Get<double>("step/mean_y_m");
  const std::size_t inputs = samples.Texts("input_name").size();
  struct Labelled {
    std::vector<double> time_s, x_m, y_m, true_x_m, true_y_m;
    std::vector<float> input;
  };
  std::vector<Labelled> runs(samples.Texts("runs").size());
  for (std::size_t k = 1; k < run.size(); ++k) {
    if (traverse[k] != traverse[k - 1]) continue;  // nothing was sensed yet
    const auto r = static_cast<std::size_t>(run[k]), s = static_cast<std::size_t>(sample[k]);
    Labelled& labelled = runs.at(r);
    labelled.time_s.push_back(samples.Get<double>(PrefixOf(r) + "time_s")[s]);
    labelled.x_m.push_back(x[k]);
    labelled.y_m.push_back(y[k]);
    labelled.true_x_m.push_back(samples.Get<double>("truth/" + PrefixOf(r) + "x_m")[s]);
    labelled.true_y_m.push_back(samples.Get<double>("truth/" + PrefixOf(r) + "y_m")[s]);
    const auto row = samples.Get<float>(PrefixOf(r) + "input").subspan(s * inputs, inputs);
    labelled.input.insert(labelled.input.end(), row.begin(), row.end());
  }
  Blob out;
  out.Put("runs", samples.at("runs"));
  out.Put("input_name", samples.at("input_name"));
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const Labelled& labelled = runs[r];
    out.PutVector(PrefixOf(r) + "time_s", labelled.time_s);
    out.PutVector(PrefixOf(r) + "x_m", labelled.x_m);
    out.PutVector(PrefixOf(r) + "y_m", labelled.y_m);
    out.PutVector("truth/" + PrefixOf(r) + "x_m", labelled.true_x_m);
    out.PutVector("truth/" + PrefixOf(r) + "y_m", labelled.true_y_m);
    const Shape shape{static_cast<std::int64_t>(labelled.x_m.size()), static_cast<std::int64_t>(inputs)};
    out.Put(PrefixOf(r) + "input", Array::Of<float>(shape, labelled.input));
  }
  return out;
}

BallJob MakeAdaptJob(std::uint64_t seed, const BallRecipe& recipe) {
  BallJob ball;
  ball.name = "adapt_" + std::to_string(seed);
  ball.set = "d1";
  ball.seed = seed;
  ball.job.set_name("reproduce-ball-" + ball.name);
  ball.job.set_seed(seed);
  SimulateCorridorOptions corridor{.set = ball.set, .runs = kRuns, .seed = seed};
  const Blob before = SimulateCorridor(corridor);
  corridor.changed = kChangedShare;
  const Blob after = SimulateCorridor(corridor);
  AddInput("training", RunsFrom(before, 0, 3, "before").Without("truth/"), &ball);
  AddInput("drive", RunsFrom(after, 3, 6, "after"), &ball);
  AddTraining("networks", "training", recipe,
              {{"networks", IntegerValue(kMostBallNetworks)}, {"window_m", RealValue(kBallWindowM)}},
              &ball.job);
  proto::Stage& track = *ball.job.add_stages();
  track.set_name("track");
  track.set_pipeline("localization");
  (*track.mutable_inputs())["samples"] = "drive";
  (*track.mutable_inputs())["networks"] = "networks";
  auto& options = *track.mutable_options();
  options["traverses"] = IntegerValue(0);
  options["travelled_m"] = RealValue(0);
  options["every_m"] = RealValue(kEveryM);
  options["trust"] = RealValue(kTrust);
  options["window_m"] = RealValue(kBallWindowM);
  ball.inputs["test"] = RunsFrom(after, 6, 7, "after");
  ball.inputs["test_before"] = RunsFrom(before, 6, 7, "before");
  return ball;
}

BallJob ContinueAdaptJob(const BallJob& first, const BallRecipe& recipe,
                         const std::map<std::string, Blob>& results) {
  BallJob ball;
  ball.name = first.name + "_then";
  ball.set = first.set;
  ball.seed = first.seed;
  ball.job.set_name("reproduce-ball-" + ball.name);
  ball.job.set_seed(first.seed);
  AddInput("self_labelled", SelfLabelled(first.inputs.at("drive"), results.at("track")), &ball);
  AddInput("drive", first.inputs.at("drive"), &ball);
  const BallRecipe options = {{"networks", IntegerValue(kMostBallNetworks)},
                              {"window_m", RealValue(kBallWindowM)}};
  AddTraining("adapted", "self_labelled", recipe, options, &ball.job);
  AddInput("networks", results.at("networks").Without("provenance/"), &ball);
  (*ball.job.mutable_stages(0)->mutable_inputs())["weights"] = "networks";
  AddTraining("anew", "self_labelled", recipe, options, &ball.job);
  AddTraining("labelled", "drive", recipe, options, &ball.job);
  return ball;
}

AdaptScores ScoreAdaptJob(const BallJob& first, const std::map<std::string, Blob>& results) {
  const Blob& networks = results.at("networks");
  const Blob& test = first.inputs.at("test");
  const Blob labelled = SelfLabelled(first.inputs.at("drive"), results.at("track"));
  AdaptScores scores;
  scores.label_error_m = LabelError(labelled);
  scores.reduction["before"] = Reduction(networks, first.inputs.at("test_before"));
  scores.reduction["stale"] = Reduction(networks, test);
  scores.reduction["map"] = Reduction(WithMapOf(networks, labelled), test);
  for (const char* stage : {"adapted", "anew", "labelled"})
    scores.reduction[stage] = Reduction(results.at(stage), test);
  return scores;
}

std::vector<PaperFigure> AdaptFigures(const std::vector<AdaptScores>& scores) {
  std::vector<double> label_error;
  for (const AdaptScores& score : scores) label_error.push_back(score.label_error_m);
  PaperFigure figure{
      .file = {},
      .title = "Section 7: adaptation to a changed corridor by self-labelled data, D-1, n = 4, +-2 m",
      .claim =
          "As the robot knows roughly where it is, BaLL can use its position estimates to label "
          "sensor data automatically; the effectiveness in practice remains to be seen.",
      .measured = Say("%.0f%% of posters, boards, doors' paint and bins replaced; three runs before "
                      "the change to train on, three after it to adapt on, another to test on. The "
                      "robot's own labels are %.2f m off on average.",
                      100 * kChangedShare, MeanOverSeeds(label_error).mean),
      .png = {}};
  figure.table.head = {"", "error reduction, percent", "more than stale"};
  for (const AdaptRow& row : kRows) {
    std::vector<double> values, more;
    for (const AdaptScores& score : scores) {
      values.push_back(score.reduction.at(row.key));
      more.push_back(values.back() - score.reduction.at("stale"));
    }
    const bool stale = std::string(row.key) == "stale";
    figure.table.rows.push_back(
        {row.title, PercentText(MeanOverSeeds(values)), stale ? "" : PercentText(MeanOverSeeds(more))});
  }
  return {figure};
}

}  // namespace cairn::datasets
