#include "datasets/reproduce/ball/scores.h"

#include <algorithm>
#include <cmath>

#include "datasets/evaluate/learning/features.h"
#include "datasets/evaluate/learning/learned_networks.h"
#include "datasets/evaluate/learning/networks.h"
#include "schema/geometry.h"

namespace cairn::datasets {
namespace {

constexpr int kBeliefBins = 178;
constexpr std::size_t kBeliefRows = 9;

// Windows as the evaluation knows them: the corridor's length is global.
ScoreOptions HowToScore() {
  ScoreOptions how;
  how.samplings = 1;
  how.windows_m = BallWindows();
  how.windows_m.back() = kGlobal;
  return how;
}

std::vector<double> ReductionsOf(const std::vector<WindowScore>& windows) {
  std::vector<double> reductions;
  for (const WindowScore& window : windows) reductions.push_back(window.soft.error_reduction.value_or(NAN));
  return reductions;
}

std::size_t HeldOutRun(const BallJob& ball) {
  const std::vector<std::string> runs = ball.samples().Texts("runs");
  return static_cast<std::size_t>(std::ranges::find(runs, ball.held_out) - runs.begin());
}

OutputCurve OutputsAlong(const BallJob& ball, const Blob& networks) {
  const LearnedNetworks nets = ReadLearnedNetworks(networks);
  const std::string prefix = "run/" + std::to_string(HeldOutRun(ball)) + "/";
  const auto x = ball.samples().Get<double>(prefix + "x_m");
  return {{x.begin(), x.end()}, OutputsOf(nets, ball.samples().Get<float>(prefix + "input")), nets.networks};
}

double Correlation(const OutputCurve& curve, std::size_t i, std::size_t j) {
  const auto count = static_cast<double>(curve.x_m.size());
  double mean_i = 0, mean_j = 0, ii = 0, jj = 0, ij = 0;
  for (std::size_t row = 0; row < curve.output.size(); row += curve.networks) {
    mean_i += curve.output[row + i] / count;
    mean_j += curve.output[row + j] / count;
  }
  for (std::size_t row = 0; row < curve.output.size(); row += curve.networks) {
    const double a = curve.output[row + i] - mean_i, b = curve.output[row + j] - mean_j;
    ii += a * a;
    jj += b * b;
    ij += a * b;
  }
  return ii > 0 && jj > 0 ? ij / std::sqrt(ii * jj) : 0;
}

double MeanCorrelation(const OutputCurve& curve) {
  double sum = 0;
  int pairs = 0;
  for (std::size_t i = 0; i < curve.networks; ++i) {
    for (std::size_t j = i + 1; j < curve.networks; ++j, ++pairs) sum += std::abs(Correlation(curve, i, j));
  }
  return pairs > 0 ? sum / pairs : 0;
}

// The first steps of the first traverse.
std::vector<BeliefRow> BeliefOf(const BallJob& ball, const Blob& located, double length_m) {
  const std::string prefix = "truth/run/" + std::to_string(HeldOutRun(ball)) + "/";
  const auto true_x = ball.samples().Get<double>(prefix + "x_m"),
             true_y = ball.samples().Get<double>(prefix + "y_m");
  const auto x = located.Get<double>("position/x_m"), y = located.Get<double>("position/y_m");
  const auto travelled = located.Get<double>("step/travelled_m");
  const auto sample = located.Get<std::int32_t>("step/sample"),
             position = located.Get<std::int32_t>("belief/position");
  const auto entries = located.Get<std::int64_t>("step/entries");
  const auto probability = located.Get<float>("belief/probability");
  std::vector<BeliefRow> rows;
  std::size_t entry = 0;
  for (std::size_t step = 0; step < std::min(kBeliefRows, travelled.size()); ++step) {
    const auto at = static_cast<std::size_t>(sample[step]);
    BeliefRow row{true_x[at], 0, travelled[step], std::vector<double>(kBeliefBins, 0)};
    for (std::int64_t i = 0; i < entries[step]; ++i, ++entry) {
      const auto k = static_cast<std::size_t>(position[entry]);
      const auto bin = static_cast<int>(std::clamp(x[k] / length_m, 0.0, 0.9999) * kBeliefBins);
      row.density[static_cast<std::size_t>(bin)] += probability[entry];
      row.error_m += probability[entry] * DistanceM(Point{x[k], y[k]}, Point{true_x[at], true_y[at]});
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

BallScores ScoreBallJob(const BallJob& ball, const std::map<std::string, Blob>& results) {
  const ScoreOptions how = HowToScore();
  BallScores scores;
  scores.set = ball.set;
  scores.seed = ball.seed;
  const auto x = ball.samples().Get<double>("run/" + std::to_string(HeldOutRun(ball)) + "/x_m");
  scores.true_positions = static_cast<std::int64_t>(x.size());
  scores.length_m = *std::ranges::max_element(x);
  for (const std::string& feature : {PerfectFeature(ball.set), DetectedFeature(ball.set)}) {
    scores.reduction[feature] =
        ReductionsOf(EvaluateFeatures(ball.samples(), nullptr, {feature}, {ball.held_out}, how).windows);
  }
  for (const proto::Stage& stage : ball.job.stages()) {
    const auto found = results.find(stage.name());
    if (found == results.end()) throw InputError("the study's stage '" + stage.name() + "' has no result");
    if (stage.pipeline() == "localization") {
      scores.localization[stage.name()] = EvaluateLocalization(found->second, ball.samples());
      continue;
    }
    scores.reduction[stage.name()] =
        ReductionsOf(EvaluateNetworks(found->second, ball.samples(), how).windows);
    scores.outputs[stage.name()] = OutputsAlong(ball, found->second);
  }
  scores.correlation = MeanCorrelation(scores.outputs.at(BallStage(kMostBallNetworks, kBallWindowM)));
  scores.belief = BeliefOf(ball, results.at("locate"), scores.length_m);
  return scores;
}

}  // namespace cairn::datasets
