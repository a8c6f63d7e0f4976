#include "datasets/evaluate/learning/networks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "datasets/evaluate/learning/learned_networks.h"
#include "datasets/evaluate/testing/networks.h"
#include "datasets/testing.h"
#include "schema/kinds/sample_hashes.h"
#include "schema/rng.h"

namespace cairn::datasets {
namespace {

// Positions 0, 10, 20, 30, 40 m, whose inputs are 0 to 4, and four networks, of which number i says whether
// the input is above i + 1/2.
Blob NetworksThatNameEveryPosition() {
  std::vector<NetworkByHand> networks;
  for (int i = 0; i < 4; ++i)
    networks.push_back({.slope = 80, .offset = -80 * (i + 0.5), .weight = 60, .bias = -30});
  std::vector<float> output;
  for (int position = 0; position < 5; ++position) {
    for (int i = 0; i < 4; ++i) output.push_back(position > i ? 1.0F : 0.0F);
  }
  return NetworksFile(networks, {0, 10, 20, 30, 40}, output);
}

// The same positions; no input matters.
Blob NetworksThatTellNothing() {
  return NetworksFile({{.bias = 0.3}}, {0, 10, 20, 30, 40}, std::vector<float>(5, 0.57F));
}

Blob FivePositions() {
  return SamplesFile({{"there", {0, 10, 20, 30, 40}, {0, 1, 2, 3, 4}}, {"back", {40, 30, 20}, {4, 3, 2}}});
}

const WindowScore& In(const NetworkEvaluation& evaluation, double window_m) {
  for (const WindowScore& score : evaluation.windows) {
    if (score.window_m == window_m) return score;
  }
  throw InputError("no such window");
}

TEST(OutputsOf, AreSigmoidsOfSigmoidsByHand) {
  Blob file = NetworksFile({{.slope = 2, .offset = 1, .weight = 3, .bias = -1}}, {0}, {0.5F});
  file.PutVector("networks/input_mean", std::vector<double>{10});
  file.PutVector("networks/input_scale", std::vector<double>{4});
  const std::vector<double> g = OutputsOf(ReadLearnedNetworks(file), std::vector<float>{10, 12});
  const auto s = [](double x) { return 1 / (1 + std::exp(-x)); };
  ASSERT_EQ(g.size(), 2U);
  EXPECT_DOUBLE_EQ(g[0], s(3 * s(1) - 1));
  EXPECT_DOUBLE_EQ(g[1], s(3 * s(2) - 1));
}

// Weights are [networks][hidden][inputs]: two networks, three hidden units, two inputs, all different.
TEST(OutputsOf, TakesWeightsInTheOrderOfTheFormat) {
  Blob file = NetworksFile({{}, {}}, {0}, {0.5F, 0.5F});
  std::vector<double> v, a, w;
  for (int i = 0; i < 12; ++i) v.push_back(0.1 * i - 0.5);
  for (int i = 0; i < 6; ++i) a.push_back(0.2 * i - 0.4);
  for (int i = 0; i < 6; ++i) w.push_back(0.7 - 0.3 * i);
  file.Put("networks/hidden_weight", Array::Of<double>({2, 3, 2}, v));
  file.Put("networks/hidden_bias", Array::Of<double>({2, 3}, a));
  file.Put("networks/output_weight", Array::Of<double>({2, 3}, w));
  for (const char* name : {"networks/input_mean", "networks/input_scale"})
    file.PutVector(name, std::vector<double>{1, 1});
  file.Put("networks/input_name", Array::Texts({"p", "q"}));
  const std::vector<double> g = OutputsOf(ReadLearnedNetworks(file), std::vector<float>{2, 4});
  const auto s = [](double x) { return 1 / (1 + std::exp(-x)); };
  ASSERT_EQ(g.size(), 2U);
  EXPECT_NEAR(g[0], s(0.7 * s(-0.4 - 0.5 - 1.2) + 0.4 * s(-0.2 - 0.3 - 0.6) + 0.1 * s(0.0 - 0.1 + 0.0)),
              1e-15);
  EXPECT_NEAR(g[1], s(-0.2 * s(0.2 + 0.1 + 0.6) - 0.5 * s(0.4 + 0.3 + 1.2) - 0.8 * s(0.6 + 0.5 + 1.8)),
              1e-15);
}

// One network of two units, then three: hidden_2_weight is [networks][hidden_2][hidden].
TEST(OutputsOf, PassTwoHiddenLayers) {
  Blob file = NetworksFile({{}}, {0}, {0.5F});
  file.Put("networks/hidden_weight", Array::Of<double>({1, 2, 1}, std::vector<double>{0.5, -1}));
  file.Put("networks/hidden_bias", Array::Of<double>({1, 2}, std::vector<double>{0.1, 0.2}));
  file.Put("networks/hidden_2_weight", Array::Of<double>({1, 3, 2}, std::vector<double>{1, 2, 3, 4, 5, 6}));
  file.Put("networks/hidden_2_bias", Array::Of<double>({1, 3}, std::vector<double>{-1, -2, -3}));
  const auto refused = [&] { return InputErrorOf([&] { ReadLearnedNetworks(file); }); };
  ExpectContains(refused(), "'networks/output_weight' is not of the last hidden layer");
  file.Put("networks/output_weight", Array::Of<double>({1, 3}, std::vector<double>{0.7, -0.8, 0.9}));
  file.PutVector("networks/output_bias", std::vector<double>{0.3});
  const std::vector<double> g = OutputsOf(ReadLearnedNetworks(file), std::vector<float>{2});
  const auto s = [](double x) { return 1 / (1 + std::exp(-x)); };
  const double a = s(1.1), b = s(-1.8);
  ASSERT_EQ(g.size(), 1U);
  EXPECT_NEAR(g[0], s(0.3 + 0.7 * s(a + 2 * b - 1) - 0.8 * s(3 * a + 4 * b - 2) + 0.9 * s(5 * a + 6 * b - 3)),
              1e-15);
}

TEST(EvaluateNetworks, NetworksThatTellNothingReduceNothing) {
  const NetworkEvaluation e = EvaluateNetworks(NetworksThatTellNothing(), FivePositions());
  ASSERT_EQ(e.windows.size(), 7U);
  for (const double window_m : {10.0, 50.0, 89.0, kGlobal}) {
    const WindowScore& score = In(e, window_m);
    EXPECT_EQ(score.true_positions, 8);
    EXPECT_GT(score.prior_error_m, 5);
    for (const Score* one : {&score.soft, &score.sampled}) {
      EXPECT_NEAR(one->posterior_error_m, score.prior_error_m, 1e-12);
      EXPECT_NEAR(*one->error_reduction, 0, 1e-12);
      EXPECT_NEAR(one->interval_95->low, 0, 1e-12);
      EXPECT_NEAR(one->interval_95->high, 0, 1e-12);
    }
  }
}

TEST(EvaluateNetworks, NetworksThatNameEveryPositionLeaveNoError) {
  const NetworkEvaluation e =
      EvaluateNetworks(NetworksThatNameEveryPosition(), FivePositions(), {.nearest = 1});
  for (const double window_m : {10.0, 50.0, 89.0, kGlobal}) {
    const WindowScore& score = In(e, window_m);
    EXPECT_GT(score.prior_error_m, 5);
    EXPECT_GT(*score.soft.error_reduction, 1 - 1e-6);
    EXPECT_GT(*score.sampled.error_reduction, 1 - 1e-6);
    EXPECT_LE(score.soft.interval_95->high, 1);
  }
  // Where the position is known beforehand there is nothing to reduce.
  EXPECT_EQ(In(e, 5).prior_error_m, 0);
  EXPECT_FALSE(In(e, 5).soft.error_reduction);
}

// One network, g(s) = s(0) = 1/2 for whatever is sensed; training samples at 0 and 1 m say 0.9 and 0.2; a
// truth at 0 m, another at 1 m. With k = 1: E(1) is 0.2 / 1.1 and E(0) is 0.8 / 0.9 at 0 m, 0.9 / 1.1 and 0.1
// / 0.9 at 1 m.
TEST(EvaluateNetworks, TheErrorsOfATinyWorldByHand) {
  const Blob nets = NetworksFile({{}}, {0, 1}, {0.9F, 0.2F});
  const NetworkEvaluation e = EvaluateNetworks(nets, SamplesFile({{"a", {0, 1}, {5, 6}}}), {.nearest = 1});
  EXPECT_EQ(e.networks, 1);
  EXPECT_EQ(e.training_samples, 2);
  EXPECT_EQ(e.trained_window_m, 2);
  for (const WindowScore& score : e.windows) {
    EXPECT_EQ(score.true_positions, 2);
    EXPECT_DOUBLE_EQ(score.prior_error_m, 0.5);
    const double at_0 = 0.5 * (0.2 / 1.1) + 0.5 * (0.8 / 0.9), at_1 = 0.5 * (0.9 / 1.1) + 0.5 * (0.1 / 0.9);
    EXPECT_NEAR(score.soft.posterior_error_m, (at_0 + at_1) / 2, 1e-7);
    EXPECT_NEAR(*score.soft.error_reduction, 1 - (at_0 + at_1), 1e-7);
  }
  // The two nearest are both: every position looks the same.
  const auto blurred = EvaluateNetworks(nets, SamplesFile({{"a", {0, 1}, {5, 6}}}), {.nearest = 2});
  EXPECT_NEAR(*In(blurred, kGlobal).soft.error_reduction, 0, 1e-12);
}

TEST(EvaluateNetworks, SamplingsComeToTheExpectation) {
  const Blob nets = NetworksFile({{}}, {0, 1}, {0.9F, 0.2F}), samples = SamplesFile({{"a", {0, 1}, {5, 6}}});
  const WindowScore many = In(EvaluateNetworks(nets, samples, {.nearest = 1, .samplings = 20000}), kGlobal);
  EXPECT_GT(many.sampled_sd, 0.1);
  EXPECT_NEAR(*many.sampled.error_reduction, *many.soft.error_reduction,
              5 * many.sampled_sd / std::sqrt(20000));
  EXPECT_NE(*many.sampled.error_reduction, *many.soft.error_reduction);
}

TEST(EvaluateNetworks, TruePositionsWithoutTrainingSamplesInTheWindowAreLeftOutAndCounted) {
  const Blob samples = SamplesFile({{"a", {0, 10, 60, 500}, {0, 1, 2, 3}}, {"b", {600}, {0}}});
  const NetworkEvaluation e = EvaluateNetworks(NetworksThatTellNothing(), samples);
  EXPECT_EQ(In(e, 10).true_positions, 2);
  EXPECT_EQ(In(e, 10).left_out, 3);
  EXPECT_EQ(In(e, 50).true_positions, 3);
  EXPECT_EQ(In(e, kGlobal).left_out, 0);
  // At 0 m a window of 10 m holds 0 and 10 m, at 10 m also 20 m.
  EXPECT_DOUBLE_EQ(In(e, 10).prior_error_m, (5 + 20.0 / 3) / 2);
  EXPECT_EQ(In(e, 50).interval_over, "blocks");
  EXPECT_EQ(In(e, 50).clusters, 3);
  EXPECT_EQ(In(e, kGlobal).interval_over, "runs");
  EXPECT_EQ(In(e, kGlobal).clusters, 2);
}

TEST(EvaluateNetworks, AWindowThatReachesNobodyHasNoScore) {
  const NetworkEvaluation e =
      EvaluateNetworks(NetworksThatTellNothing(), SamplesFile({{"a", {60, 61}, {0, 1}}}));
  EXPECT_EQ(In(e, 1).true_positions, 0);
  EXPECT_EQ(In(e, 1).left_out, 2);
  EXPECT_FALSE(In(e, 1).soft.error_reduction);
  EXPECT_FALSE(In(e, 1).soft.interval_95);
  const auto json = nlohmann::json::parse(MakeScores(e).ToJson());
  EXPECT_TRUE(json["windows"][0]["prior_error_m"].is_null());
  EXPECT_TRUE(json["windows"][0]["posterior_error_m"].is_null());
  EXPECT_TRUE(json["windows"][0]["sampled"]["posterior_error_m"].is_null());
  ExpectContains(MakeScores(e).ToText(),
                 "1.000     0               2         unknown        unknown            unknown ");
}

TEST(EvaluateNetworks, ARunOfManySamplesIsCutIntoTenBlocks) {
  std::vector<double> x_m;
  for (int k = 0; k < 95; ++k) x_m.push_back(0.4 * k);
  const auto e = EvaluateNetworks(NetworksThatTellNothing(),
                                  SamplesFile({{"a", x_m, std::vector<float>(x_m.size(), 1)}}));
  EXPECT_EQ(In(e, kGlobal).interval_over, "blocks");
  EXPECT_EQ(In(e, kGlobal).clusters, 10);
}

TEST(EvaluateNetworks, CopiesOfWhatWasTrainedOnAreLeftOutWhateverTheirName) {
  std::vector<double> x_m;
  std::vector<float> input, other, output;
  for (int k = 0; k < 40; ++k) {
    x_m.push_back(k);
    input.push_back(0.1F * static_cast<float>(k));
    other.push_back(input.back() + 0.05F);
    output.push_back(1 / (1 + std::exp(-2 / (1 + std::exp(-input.back())))));
  }
  const Blob nets = NetworksFile({{.slope = 1, .weight = 2}}, x_m, output);
  const RunByHand copy{"copy", x_m, input}, real{"real", x_m, other};
  const NetworkEvaluation e = EvaluateNetworks(nets, SamplesFile({copy, real}));
  EXPECT_EQ(e.trained_on, std::vector<std::string>{"copy"});
  ASSERT_EQ(e.runs.size(), 1U);
  EXPECT_EQ(e.runs[0].name, "real") << "at the same places, but it senses other things";
}

TEST(EvaluateNetworks, RunsThatNetworksBeforeTheseWereTrainedOnAreLeftOut) {
  const RunByHand old{"old", {5, 15, 25}, {7, 8, 9}}, other{"other", {0, 10}, {0, 1}};
  const Blob samples = SamplesFile({old, other});
  Blob nets = NetworksThatNameEveryPosition();
  nets.Put("ancestry/hash", Array::Texts({std::string(32, '0')}));
  nets.Put("ancestry/options", Array::Texts({""}));
  nets.PutVector<std::int64_t>("ancestry/steps", {1});
  nets.PutVector<double>("ancestry/training_error_m", {1});
  nets.PutVector<double>("ancestry/prior_error_m", {2});
  nets.PutVector("ancestry/sample_hash", SampleHashes(Read<kinds::Samples>(samples).run[0], 1));
  const NetworkEvaluation e = EvaluateNetworks(nets, samples, {.nearest = 1});
  EXPECT_EQ(e.trained_on, std::vector<std::string>{"old"});
  ASSERT_EQ(e.runs.size(), 1U);
  EXPECT_EQ(e.runs[0].name, "other");
}

TEST(EvaluateNetworks, RunsThatWereTrainedOnAreLeftOut) {
  const RunByHand trained{"trained", {0, 10, 20, 30, 40}, {0, 1, 2, 3, 4}}, other{"other", {0, 10}, {0, 1}};
  const Blob nets = NetworksThatNameEveryPosition();
  const NetworkEvaluation e = EvaluateNetworks(nets, SamplesFile({trained, other}), {.nearest = 1});
  EXPECT_EQ(e.trained_on, std::vector<std::string>{"trained"});
  ASSERT_EQ(e.runs.size(), 1U);
  EXPECT_EQ(e.runs[0].name, "other");
  EXPECT_EQ(In(e, kGlobal).true_positions, 2);
  ExpectContains(MakeScores(e).ToText(), "trained: left out, as trained on");
  ExpectContains(InputErrorOf([&] { EvaluateNetworks(nets, SamplesFile({trained})); }),
                 "the networks were trained on every run");
  // Another run that happens to have the name.
  const RunByHand namesake{"trained", {0, 10.5, 20, 30, 40}, {0, 1, 2, 3, 4}};
  EXPECT_EQ(EvaluateNetworks(nets, SamplesFile({namesake})).runs.size(), 1U);
}

// The networks name it, but their map has no sample of it.
TEST(EvaluateNetworks, ARunThatDecidedWhenToStopCountsWithACaution) {
  Blob nets = NetworksThatNameEveryPosition();
  nets.Put("runs", Array::Texts({"trained", "back"}));
  const NetworkEvaluation e = EvaluateNetworks(nets, FivePositions());
  EXPECT_EQ(e.stopped_by, std::vector<std::string>{"back"});
  EXPECT_EQ(e.runs.size(), 2U);
  ExpectContains(MakeScores(e).ToText(), "back: not wholly unseen, as training stopped by it");
  EXPECT_TRUE(EvaluateNetworks(NetworksThatNameEveryPosition(), FivePositions()).stopped_by.empty());
}

TEST(EvaluateNetworks, IsTheSameEveryTimeAndSamplesBySeed) {
  const Blob nets =
      NetworksFile({{.slope = 1, .weight = 2, .bias = -1}}, {0, 1, 2, 3, 4}, {.1F, .3F, .5F, .6F, .8F});
  const auto score = [&](std::uint64_t seed) {
    return MakeScores(EvaluateNetworks(nets, FivePositions(), {.nearest = 2, .seed = seed})).ToJson();
  };
  EXPECT_EQ(score(1), score(1));
  EXPECT_NE(score(1), score(2));
}

TEST(EvaluateNetworks, JsonHasEveryField) {
  const auto json = nlohmann::json::parse(
      MakeScores(EvaluateNetworks(NetworksThatNameEveryPosition(), FivePositions(), {.nearest = 2}))
          .ToJson());
  EXPECT_EQ(json["networks"], 4);
  EXPECT_EQ(json["nearest"], 2);
  EXPECT_EQ(json["trained_window_m"], 2.0);
  EXPECT_EQ(json["runs"][1]["samples"], 3);
  ASSERT_EQ(json["windows"].size(), 7U);
  EXPECT_EQ(json["windows"][1]["window_m"], 2.0);
  EXPECT_TRUE(json["windows"][6]["window_m"].is_null());
  const auto& global = json["windows"][6];
  for (const char* name :
       {"true_positions", "left_out", "prior_error_m", "posterior_error_m", "error_reduction", "clusters"})
    EXPECT_TRUE(global[name].is_number()) << name;
  EXPECT_EQ(global["interval_over"], "runs");
  EXPECT_LE(global["error_reduction_95"][0], global["error_reduction"]);
  EXPECT_GE(global["error_reduction_95"][1], global["error_reduction"]);
  for (const char* name : {"posterior_error_m", "error_reduction", "error_reduction_sd"})
    EXPECT_TRUE(global["sampled"][name].is_number()) << name;
}

// Five positions, every other one seen on the way back; the run that is held out faces forward.
TEST(EvaluateNetworks, LooksAtHeadingsWhereSamplesDoNotAllFaceOneWay) {
  Blob nets = NetworksThatTellNothing(), samples = FivePositions();
  const auto rows = samples.Get<double>("run/1/x_m").size();
  samples.PutVector("run/0/heading_rad", std::vector<double>(samples.Get<double>("run/0/x_m").size(), 0.0));
  samples.PutVector("run/1/heading_rad", std::vector<double>(rows, 0.0));
  EXPECT_FALSE(EvaluateNetworks(nets, samples, {.nearest = 1}).headings);  // the map has none
  nets.PutVector<double>("map/heading_rad", {0.0, 0.2, -0.2, 0.1, 0.0});
  EXPECT_FALSE(EvaluateNetworks(nets, samples, {.nearest = 1}).headings);  // all face one way
  nets.PutVector<double>("map/heading_rad", {0.0, 3.1, 0.0, 3.1, 0.0});
  const NetworkEvaluation does_not_know = EvaluateNetworks(nets, samples, {.nearest = 1});
  EXPECT_TRUE(does_not_know.headings);
  nets.PutScalar("heading_window_deg", 90.0);
  const NetworkEvaluation knows = EvaluateNetworks(nets, samples, {.nearest = 1});
  EXPECT_NE(knows.windows.back().prior_error_m, does_not_know.windows.back().prior_error_m);
  EXPECT_EQ(EvaluateNetworks(nets, samples, {.nearest = 1, .heading_window_deg = 180.0})
                .windows.back()
                .prior_error_m,
            does_not_know.windows.back().prior_error_m);
  ExpectContains(MakeScores(knows).ToText(), "90.00 degrees: the robot knows its heading as well");
  ExpectContains(MakeScores(does_not_know).ToText(), "the robot does not know its heading");
  ExpectContains(MakeScores(knows).ToJson(), "\"heading_window_deg\": 90");
  ExpectContains(InputErrorOf([&] { EvaluateNetworks(nets, FivePositions(), {.nearest = 1}); }),
                 "--heading-window-deg 180 leaves them out");
}

// What is wrong with the networks' file, and what is said of it.
TEST(EvaluateNetworks, RefusesNetworksThatAreNotWhole) {
  const Blob good = NetworksThatTellNothing();
  const auto refused = [&](const std::vector<std::string>& names, const Shape& shape) {
    Blob bad = good;
    for (const std::string& name : names)
      bad.Put(name, Array::Of<double>(shape, std::vector<double>(static_cast<std::size_t>(shape[0]), 0)));
    return InputErrorOf([&] { EvaluateNetworks(bad, FivePositions()); });
  };
  ExpectContains(refused({"networks/hidden_weight"}, {0, 1, 1}), "0 networks; allowed: 1 to 12");
  ExpectContains(refused({"networks/hidden_weight"}, {13, 1, 1}), "13 networks; allowed: 1 to 12");
  ExpectContains(refused({"map/x_m"}, {0}), "no training samples");
  for (const auto& [name, array] : good.fields()) {
    if (name == "window_m" || name == "map/along_m") continue;
    const Blob without = good.Without(name);
    ExpectContains(InputErrorOf([&] { EvaluateNetworks(without, FivePositions()); }), name);
  }
}

TEST(EvaluateNetworks, RefusesSamplesThatTheNetworksCannotTake) {
  const auto refused = [](const std::string& name, const Array& array) {
    Blob bad = FivePositions();
    bad.Put(name, array);
    return InputErrorOf([&] { EvaluateNetworks(NetworksThatTellNothing(), bad); });
  };
  ExpectContains(refused("input_name", Array::Texts({"input0", "more"})),
                 "the samples: 2 inputs, the networks have 1");
  ExpectContains(refused("input_name", Array::Texts({"sonar"})),
                 "the samples: input 0 is 'sonar', in the networks 'input0'");
  const auto empty = [](const std::vector<RunByHand>& runs) {
    return InputErrorOf([&] { EvaluateNetworks(NetworksThatTellNothing(), SamplesFile(runs)); });
  };
  ExpectContains(empty({}), "the samples: there are no samples");
  ExpectContains(empty({{"a", {}, {}}}), "the samples: there are no samples");
}

TEST(EvaluateNetworks, RefusesANumberOfNearestThatThereIsNot) {
  for (const int nearest : {-1, 0, 6}) {
    ExpectContains(InputErrorOf([&] {
                     EvaluateNetworks(NetworksThatTellNothing(), FivePositions(), {.nearest = nearest});
                   }),
                   "allowed: from 1 to 5");
  }
}

}  // namespace
}  // namespace cairn::datasets
