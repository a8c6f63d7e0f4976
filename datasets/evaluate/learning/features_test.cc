#include "datasets/evaluate/learning/features.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "datasets/common/samples.h"
#include "datasets/evaluate/learning/learned_networks.h"
#include "datasets/evaluate/learning/networks.h"
#include "datasets/evaluate/testing/networks.h"
#include "datasets/testing.h"
#include "schema/rng.h"

namespace cairn::datasets {
namespace {

// `feature`: [samples][names].
Blob WithFeatures(const std::vector<RunByHand>& runs, const std::vector<std::string>& names,
                  const std::vector<std::vector<float>>& feature) {
  Blob file = SamplesFile(runs);
  file.Put("feature_name", Array::Texts(names));
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const Shape shape{static_cast<std::int64_t>(runs[r].x_m.size()), static_cast<std::int64_t>(names.size())};
    file.Put("run/" + std::to_string(r) + "/feature", Array::Of<float>(shape, feature[r]));
  }
  return file;
}

ScoreOptions Nearest(int nearest) { return {.nearest = nearest}; }

// Two runs see the same ten positions, and whether they are in the upper half.
Blob TwoHalves() {
  const std::vector<double> x{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  const std::vector<float> upper{0, 0, 0, 0, 0, 1, 1, 1, 1, 1}, none(10, 0.0F);
  std::vector<float> both;
  for (std::size_t k = 0; k < 10; ++k) both.insert(both.end(), {none[k], upper[k]});
  return WithFeatures({{"a", x, none}, {"b", x, none}}, {"never", "upper half"}, {both, both});
}

// Global: the mean distance of two of ten positions is 3.3, of two of the same five 1.6.
TEST(EvaluateFeatures, ABitThatHalvesTheWorldByHand) {
  const FeatureEvaluation e = EvaluateFeatures(TwoHalves(), nullptr, {"upper half"}, {}, Nearest(1));
  EXPECT_TRUE(e.in_turn);
  ASSERT_EQ(e.runs.size(), 2U);
  const WindowScore& global = e.windows.back();
  EXPECT_EQ(global.true_positions, 20);
  EXPECT_NEAR(global.prior_error_m, 3.3, 1e-12);
  EXPECT_NEAR(global.soft.posterior_error_m, 1.6, 1e-12);
  EXPECT_NEAR(*global.soft.error_reduction, 1 - 1.6 / 3.3, 1e-12);
  EXPECT_EQ(global.interval_over, "runs");
  const FeatureEvaluation nothing = EvaluateFeatures(TwoHalves(), nullptr, {"never"}, {}, Nearest(1));
  EXPECT_NEAR(*nothing.windows.back().soft.error_reduction, 0, 1e-12);
}

// The features of a run are what networks make of it: then both evaluations are the same in every figure.
TEST(EvaluateFeatures, ScoreAsNetworksOfTheSameOutputsDo) {
  Rng rng(3);
  std::vector<RunByHand> runs(3);
  for (std::size_t r = 0; r < 3; ++r) {
    runs[r].name = std::string(1, static_cast<char>('a' + r));
    for (int k = 0; k < 60; ++k) {
      runs[r].x_m.push_back(rng.Uniform(0, 50));
      runs[r].input.push_back(static_cast<float>(runs[r].x_m.back() + rng.Normal()));
    }
  }
  const std::vector<NetworkByHand> by_hand{{.slope = 1, .offset = -20, .weight = 20, .bias = -10},
                                           {.slope = -2, .offset = 70, .weight = 16, .bias = -8}};
  const LearnedNetworks nets =
      ReadLearnedNetworks(NetworksFile(by_hand, {0}, std::vector<float>{0.5F, 0.5F}));
  std::vector<std::vector<float>> feature;
  for (const RunByHand& run : runs) {
    const std::vector<double> output = OutputsOf(nets, run.input);
    feature.emplace_back(output.begin(), output.end());
  }
  const Blob samples = WithFeatures(runs, {"one", "two"}, feature);
  const Blob networks = NetworksFile(by_hand, runs[0].x_m, feature[0]);
  const NetworkEvaluation theirs =
      EvaluateNetworks(networks, SamplesFile({runs[1], runs[2]}), {.windows_m = {2, 10, kGlobal}});
  const FeatureEvaluation ours =
      EvaluateFeatures(samples, nullptr, {"one", "two"}, {"b", "c"}, {.windows_m = {2, 10, kGlobal}});
  EXPECT_EQ(ours.map_runs, std::vector<std::string>{"a"});
  EXPECT_GT(*ours.windows.back().soft.error_reduction, 0.2);
  for (std::size_t w = 0; w < 3; ++w) {
    EXPECT_EQ(ours.windows[w].prior_error_m, theirs.windows[w].prior_error_m);
    EXPECT_NEAR(*ours.windows[w].soft.error_reduction, *theirs.windows[w].soft.error_reduction, 1e-6);
    EXPECT_NEAR(ours.windows[w].soft.interval_95->low, theirs.windows[w].soft.interval_95->low, 0.2);
  }
}

TEST(EvaluateFeatures, RunsOfTwoFilesAreHeldOutOnceOnly) {
  const Blob map = TwoHalves();
  const Blob truth =
      WithFeatures({{"a", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, std::vector<float>(10)}, {"c", {2, 8}, {0, 0}}},
                   {"upper half"}, {{0, 0, 0, 0, 0, 1, 1, 1, 1, 1}, {0, 1}});
  const FeatureEvaluation e = EvaluateFeatures(map, &truth, {"upper half"}, {}, Nearest(1));
  ASSERT_EQ(e.runs.size(), 1U);
  EXPECT_EQ(e.runs[0].name, "c");
  EXPECT_EQ(e.windows.back().true_positions, 2);
}

TEST(EvaluateFeatures, CountsWhatADetectorFinds) {
  const Blob file = WithFeatures({{"a", {0, 1, 2, 3}, std::vector<float>(4)}}, {"detected", "true"},
                                 {{1, 1, 0.9F, 0, 0, 1, 0.5F, 0}});
  const Detection d = CompareFeatures(file, "detected", "true");
  EXPECT_EQ(d.both, 1);
  EXPECT_EQ(d.only_detected, 1);
  EXPECT_EQ(d.only_true, 1);
  EXPECT_EQ(d.neither, 1);
  EXPECT_EQ(*d.precision(), 0.5);
  EXPECT_EQ(*d.recall(), 0.5);
  EXPECT_EQ(Detection{}.precision(), std::nullopt);
  const auto e = EvaluateFeatures(TwoHalves(), nullptr, {"never"}, {}, Nearest(1));
  EXPECT_EQ(nlohmann::json::parse(MakeScores(e, d).ToJson())["detection"]["precision"], 0.5);
  ExpectContains(MakeScores(e, d).ToText(),
                 "detection.precision             50.0%\n"
                 "detection.recall                50.0%, of 4 samples\n");
}

TEST(EvaluateFeatures, SayWhatIsWrong) {
  const auto failure = [](const Blob& file, const std::vector<std::string>& features,
                          const std::vector<std::string>& holdout = {}) {
    return InputErrorOf(
        [&] { EvaluateFeatures(file, nullptr, features, holdout, {.nearest = 1, .map_name = "d1.h5"}); });
  };
  EXPECT_EQ(failure(TwoHalves(), {"never"}, {"a"}), "");
  EXPECT_EQ(failure(TwoHalves(), {"lift"}), "d1.h5: no feature 'lift'; there are 'never', 'upper half'");
  EXPECT_EQ(failure(TwoHalves(), {"never", "never"}), "d1.h5: feature 'never' is named twice");
  ExpectContains(failure(TwoHalves(), {}), "0 features; allowed");
  EXPECT_EQ(failure(TwoHalves(), {"never"}, {"z"}), "d1.h5: no run 'z'");
  ExpectContains(failure(TwoHalves(), {"never"}, {"a", "b"}), "every run is held out");
  EXPECT_EQ(failure(SamplesFile({{"a", {0}, {1}}}), {"door"}), "d1.h5: there are no hand-made features");
  ExpectContains(failure(WithFeatures({{"a", {0, 1}, {1, 1}}}, {"f"}, {{0, 1}}), {"f"}),
                 "there is one run only");
}

}  // namespace
}  // namespace cairn::datasets
