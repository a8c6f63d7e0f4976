#include "pipelines/localization/localization.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "pipelines/landmark_learning/landmark_learning.h"
#include "pipelines/landmark_learning/testing.h"
#include "pipelines/localization/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::localization {
namespace {

std::map<std::string, BlobPtr> InputsOf(const Blob& samples, const BlobPtr& networks = nullptr) {
  std::map<std::string, BlobPtr> inputs = {{"samples", std::make_shared<const Blob>(samples)}};
  if (networks != nullptr) inputs["networks"] = networks;
  return inputs;
}

BlobPtr Locate(const Blob& samples, const Options& options, const BlobPtr& networks = nullptr) {
  return RunInProcess(Localization(options, 11), InputsOf(samples, networks));
}

// Mean distance between truth and the mean of the belief, over the traverses' steps with `low_m` <= way <
// `high_m`.
double MeanError(const Blob& samples, const Blob& result, double low_m, double high_m) {
  const auto travelled = result.Get<double>("step/travelled_m"), x = result.Get<double>("step/mean_x_m");
  const auto run = result.Get<std::int32_t>("step/run"), sample = result.Get<std::int32_t>("step/sample");
  double sum = 0.0;
  int count = 0;
  for (std::size_t k = 0; k < travelled.size(); ++k) {
    if (travelled[k] < low_m || travelled[k] >= high_m) continue;
    const auto truth = samples.Get<double>("run/" + std::to_string(run[k]) + "/x_m");
    sum += std::abs(x[k] - truth[static_cast<std::size_t>(sample[k])]);
    ++count;
  }
  return sum / count;
}

TEST(Localization, FindsARobotThatKnowsNothingByHandMadeFeatures) {
  const Blob samples = CorridorWithFeatures().Make();
  for (const char* belief : {"samples", "grid"}) {
    for (const char* sensing : {"soft", "sampled"}) {
      const BlobPtr result =
          Locate(samples, {.runs = "run 1", .belief = belief, .sensing = sensing, .travelled_m = 25.0});
      EXPECT_GT(MeanError(samples, *result, 0.0, 0.1), 8.0) << belief << sensing;
      EXPECT_LT(MeanError(samples, *result, 15.0, 30.0), 1.0) << belief << sensing;
    }
  }
}

double ForetoldRatio(const Blob& result) {
  double lead = 0.0, expected = 0.0;
  for (const double nats : result.Get<double>("step/lead_nats")) lead += nats;
  for (const double nats : result.Get<double>("step/expected_lead_nats")) expected += nats;
  return lead / expected;
}

// Where features come as often as the map says, what is foretold comes as well as the belief expects; in a
// run whose features are those of other places, it does not.
TEST(Localization, ForetellsAsWellAsItBelievesToInItsOwnCorridorOnly) {
  Blob samples = CorridorWithFeatures{.runs = 4}.Make();
  const Options options = {
      .runs = "run 1", .prior_count = 0.01, .sensing = "sampled", .trust = 1.0, .travelled_m = 25.0};
  EXPECT_NEAR(ForetoldRatio(*Locate(samples, options)), 1.0, 0.15);
  const std::span<const float> honest = samples.Get<float>("run/1/feature");
  std::vector<float> feature(honest.begin(), honest.end());
  std::ranges::rotate(feature, feature.begin() + static_cast<std::ptrdiff_t>(feature.size() / 9 * 3));
  std::ranges::reverse(feature);
  samples.Put("run/1/feature", Array::Of<float>(samples.at("run/1/feature").shape(), feature));
  EXPECT_LT(ForetoldRatio(*Locate(samples, options)), 0.5);
}

// Driven both ways: of a robot that comes back, in a map of both ways. Seen from the other side every feature
// is turned round, so that who mixes them up finds nothing.
TEST(Localization, FindsARobotThatComesBackWhetherItKnowsItsHeadingOrNot) {
  const Blob samples = CorridorWithFeatures{.runs = 6, .both_ways = true}.Make();
  std::map<std::string, double> error;
  for (const char* belief : {"samples", "grid"}) {
    for (const char* heading : {"known", "unknown", "ignored"}) {
      const BlobPtr result = Locate(
          samples, {.runs = "run 4, run 5", .heading = heading, .belief = belief, .travelled_m = 25.0});
      error[heading] = MeanError(samples, *result, 20.0, 30.0);
      EXPECT_EQ(result->Has("position/heading_rad"), std::string(heading) != "ignored");
    }
    EXPECT_LT(error["known"], 1.0) << belief;
    EXPECT_LT(error["unknown"], 1.5) << belief;
    EXPECT_GT(error["ignored"], 4.0) << belief;
  }
}

// It starts by believing in both ways alike, and ends by facing as it does.
TEST(Localization, FindsOutWhichWayItFaces) {
  const Blob samples = CorridorWithFeatures{.runs = 6, .both_ways = true}.Make();
  const BlobPtr result =
      Locate(samples, {.runs = "run 4, run 5", .heading = "unknown", .traverses = 20, .travelled_m = 25.0});
  const auto heading = result->Get<double>("position/heading_rad");
  const auto run = result->Get<std::int32_t>("step/run"),
             position = result->Get<std::int32_t>("belief/position");
  const auto travelled = result->Get<double>("step/travelled_m");
  const auto entries = result->Get<std::int64_t>("step/entries");
  const auto probability = result->Get<float>("belief/probability");
  double at_start = 0.0, at_end = 0.0, starts = 0.0, ends = 0.0;
  std::size_t at = 0;
  for (std::size_t k = 0; k < travelled.size(); ++k) {
    double right = 0.0;
    for (std::int64_t i = 0; i < entries[k]; ++i, ++at) {
      const bool back = std::abs(heading[static_cast<std::size_t>(position[at])]) > 1.5;
      if (back == (run[k] == 5)) right += probability[at];
    }
    if (travelled[k] == 0.0) at_start += right, ++starts;
    if (travelled[k] > 24.0) at_end += right, ++ends;
  }
  EXPECT_NEAR(at_start / starts, 0.5, 0.02);
  EXPECT_GT(at_end / ends, 0.97);
}

TEST(Localization, HeadingsThatAllFaceOneWayChangeNothing) {
  const Blob samples = CorridorWithFeatures().Make();
  Blob facing = samples;
  for (const char* run : {"run/0/", "run/1/", "run/2/"}) {
    const std::size_t count = samples.Get<double>(std::string(run) + "x_m").size();
    std::vector<double> heading;
    for (std::size_t k = 0; k < count; ++k) heading.push_back(2.5 + 0.8 * std::sin(static_cast<double>(k)));
    facing.PutVector(std::string(run) + "heading_rad", heading);
  }
  for (const char* belief : {"samples", "grid"}) {
    const Options options{.runs = "run 1", .belief = belief, .traverses = 5};
    const BlobPtr without = Locate(samples, options), with = Locate(facing, options);
    EXPECT_EQ(with->Without("samples_hash").ContentHash(), without->Without("samples_hash").ContentHash());
  }
}

// Odometry that says nothing moved leaves a robot where it was known to be; the labels do not.
TEST(Localization, MovesByTheSamplesOdometryWhereThereIsSome) {
  Blob samples = CorridorWithFeatures{.both_ways = true}.Make();
  const std::size_t count = samples.Get<double>("run/2/x_m").size();
  samples.PutVector("run/2/odometry/turn_rad", std::vector<double>(count, 0.0));
  samples.PutVector("run/2/odometry/forward_m", std::vector<double>(count, 0.0));
  Options options{.runs = "run 2", .trust = 0.001, .window_m = 1.0, .traverses = 3, .travelled_m = 10.0};
  EXPECT_GT(MeanError(samples, *Locate(samples, options), 9.0, 10.0), 5.0);
  options.odometry = "labels";
  EXPECT_LT(MeanError(samples, *Locate(samples, options), 9.0, 10.0), 2.0);
}

TEST(Localization, KeepsTrackOfARobotThatIsKnownToBeNear) {
  const Blob samples = CorridorWithFeatures().Make();
  const BlobPtr result = Locate(samples, {.runs = "run 0,run 2", .window_m = 1.0, .traverses = 20});
  EXPECT_LT(MeanError(samples, *result, 0.0, 50.0), 0.5);
}

TEST(Localization, FindsARobotByLearnedFeaturesInARunThatWasHeldOut) {
  const Blob samples = landmark_learning::CorridorSamples{.runs = 4, .samples = 200}.Make();
  const landmark_learning::Options learning{.networks = 3, .window_m = 5.0, .steps = 300, .holdout = "run 3"};
  const BlobPtr networks = RunInProcess(landmark_learning::LandmarkLearning(learning, 3), InputsOf(samples));
  const BlobPtr result = Locate(samples, {.travelled_m = 15.0}, networks);
  EXPECT_EQ(result->Texts("feature_name").size(), 3U);
  for (const std::int32_t run : result->Get<std::int32_t>("step/run")) EXPECT_EQ(run, 3);
  EXPECT_GT(MeanError(samples, *result, 0.0, 0.1), 5.0);
  EXPECT_LT(MeanError(samples, *result, 10.0, 20.0), 1.0);
}

// Three sensors that see something at some positions each; together, or looked at wisely, they find the
// robot.
TEST(Localization, SeveralNetworksAreSensedTogetherInTurnOrWhereItPays) {
  const Blob samples = landmark_learning::CorridorSamples{.runs = 4, .samples = 200}.Make();
  auto inputs = InputsOf(samples);
  for (const char* name : {"networks", "networks_2", "networks_3"}) {
    const landmark_learning::Options learning{
        .networks = 2, .window_m = 5.0, .steps = 300, .holdout = "run 3"};
    inputs[name] =
        RunInProcess(landmark_learning::LandmarkLearning(learning, inputs.size()), InputsOf(samples));
  }
  std::map<std::string, double> error;
  for (const char* look : {"all", "turn", "active"}) {
    const Options options{.belief = "grid", .cell_m = 0.5, .look = look, .travelled_m = 15.0};
    const BlobPtr result = RunInProcess(Localization(options, 11), inputs);
    EXPECT_EQ(result->Texts("feature_name").size(), 6U);
    error[look] = MeanError(samples, *result, 10.0, 20.0);
  }
  EXPECT_LT(error["all"], 2.0);
  EXPECT_LT(error["all"], error["active"]);
  EXPECT_LT(error["active"], error["turn"]);
}

TEST(Localization, BeliefsAddUpAndSayWhereTheyEnd) {
  const BlobPtr result = Locate(CorridorWithFeatures().Make(), {.runs = "run 1", .traverses = 5});
  const auto entries = result->Get<std::int64_t>("step/entries");
  const auto position = result->Get<std::int32_t>("belief/position");
  const auto probability = result->Get<float>("belief/probability");
  const auto x = result->Get<double>("position/x_m"), mean = result->Get<double>("step/mean_x_m");
  std::size_t at = 0;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    double sum = 0.0, mean_x = 0.0;
    for (std::int64_t i = 0; i < entries[k]; ++i, ++at) {
      sum += probability[at];
      mean_x += probability[at] * x[static_cast<std::size_t>(position[at])];
    }
    EXPECT_NEAR(sum, 1.0, 1e-4);
    EXPECT_NEAR(mean_x, mean[k], 0.05);  // what is too small is not kept
  }
  EXPECT_EQ(at, probability.size());
  EXPECT_GT(entries.size(), 200U);
}

TEST(Localization, KeepsWhatItsNetworksAreWorthAndHowFarOffItIs) {
  const Blob samples = landmark_learning::CorridorSamples().Make();
  Blob networks = *RunInProcess(landmark_learning::LandmarkLearning({.steps = 3, .holdout = "run 1"}, 3),
                                InputsOf(samples));
  networks.Put("input_doubts", Array::Texts({"input 'door' only grows"}));
  const BlobPtr result = Locate(samples, {.traverses = 2}, std::make_shared<const Blob>(networks));
  EXPECT_EQ(result->Texts("extractors"), std::vector<std::string>{"networks"});
  EXPECT_EQ(result->Texts("extractor/0/input_doubts"), networks.Texts("input_doubts"));
  EXPECT_TRUE(result->Has("extractor/0/held_out_reduction"));
  EXPECT_EQ(result->Scalar<std::int64_t>("extractor/0/held_out/samples"), 80);
  const auto off_m = result->Get<double>("step/off_label_m"), mean_x_m = result->Get<double>("step/mean_x_m"),
             mean_y_m = result->Get<double>("step/mean_y_m"), x_m = samples.Get<double>("run/1/x_m"),
             y_m = samples.Get<double>("run/1/y_m");
  const auto sample = result->Get<std::int32_t>("step/sample");
  for (std::size_t k = 0; k < off_m.size(); ++k) {
    const auto at = static_cast<std::size_t>(sample[k]);
    EXPECT_NEAR(off_m[k], std::hypot(mean_x_m[k] - x_m[at], mean_y_m[k] - y_m[at]), 1e-9);
  }
  EXPECT_FALSE(Locate(CorridorWithFeatures().Make(), {.runs = "run 1", .traverses = 1})->Has("extractors"));
}

std::string Complaint(const Blob& samples, const Options& options, const BlobPtr& networks = nullptr) {
  try {
    Locate(samples, options, networks);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Localization, SaysWhatIsWrongWithItsInputs) {
  const Blob good = CorridorWithFeatures().Make();
  const auto with = [&](const char* name, Array array) {
    Blob bad = good;
    bad.Put(name, std::move(array));
    return bad;
  };
  const auto rows = static_cast<std::int64_t>(good.at("run/1/x_m").size());
  std::vector<float> feature(static_cast<std::size_t>(rows) * 3, 0.5F);
  EXPECT_EQ(Complaint(good, {.runs = "run 1", .traverses = 1}), "");
  EXPECT_EQ(Complaint(good, {}), "runs: without networks, which runs to localise in must be said");
  EXPECT_EQ(Complaint(good, {.runs = "run 7"}), "runs: there is no run 'run 7' among the samples");
  EXPECT_EQ(Complaint(good, {.runs = "run 0, run 1, run 2"}), "runs: no run is left to make the map of");
  EXPECT_EQ(Complaint(good, {.runs = "run 1", .features = "door"}),
            "features: there is no 'door' among half, quarter, stripe");
  EXPECT_NE(Complaint(good, {.runs = "run 1", .belief = "grid", .cell_m = 1e-4})
                .find("at most 1000000 are allowed"),
            std::string::npos);
  feature[7] = 1.5F;
  EXPECT_NE(Complaint(with("run/1/feature", Array::Of<float>({rows, 3}, feature)), {.runs = "run 1"})
                .find("'run/1/feature', entry 7: 1.5"),
            std::string::npos);
  feature[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(Complaint(with("run/1/feature", Array::Of<float>({rows, 3}, feature)), {.runs = "run 1"})
                .find("'run/1/feature', entry 7: nan"),
            std::string::npos);
  EXPECT_NE(Complaint(good, {.runs = "run 1", .nearest = 100000}).find("the map has only"),
            std::string::npos);
  EXPECT_EQ(Complaint(good, {.runs = "run 1", .heading = "unknown"}),
            "heading=unknown: run 'run 1' has no headings ('heading_rad') to turn by");
  const Blob both = CorridorWithFeatures{.runs = 2, .both_ways = true}.Make();
  EXPECT_NE(
      Complaint(both, {.runs = "run 1"}).find("no position that it may be at was seen facing as it does"),
      std::string::npos);
  Blob moved = both;
  moved.PutVector<double>("run/1/odometry/turn_rad", {0.0});
  moved.PutVector<double>("run/1/odometry/forward_m", {0.0});
  EXPECT_NE(Complaint(moved, {.runs = "run 1"}).find("'run/1/odometry/turn_rad' has the shape [1]"),
            std::string::npos);
  const std::size_t moves = both.Get<double>("run/1/x_m").size();
  moved.PutVector("run/1/odometry/turn_rad", std::vector<double>(moves, 0.0));
  moved.PutVector("run/1/odometry/forward_m", std::vector<double>(moves, std::nan("")));
  EXPECT_EQ(Complaint(moved, {.runs = "run 1"}), "run 'run 1', sample 1: its odometry is not finite");
  moved.PutVector("run/1/odometry/forward_m", std::vector<double>(moves, 0.1));
  EXPECT_EQ(
      Complaint(moved.Without("run/1/heading_rad"), {.runs = "run 1"}),
      "run 'run 1': its odometry says nothing without headings ('heading_rad'); odometry=labels does not "
      "look at it");
  std::vector<float> certain(static_cast<std::size_t>(rows) * 3, 1.0F);
  std::vector<float> never(static_cast<std::size_t>(good.at("run/0/x_m").size()) * 3, 0.0F);
  Blob other = with("run/1/feature", Array::Of<float>({rows, 3}, certain));
  other.Put("run/0/feature", Array::Of<float>({good.at("run/0/x_m").size(), 3}, never));
  EXPECT_EQ(Complaint(other, {.runs = "run 1,run 2", .prior_count = 0.0, .traverses = 0}),
            "run 'run 1', sample 3: what it senses is impossible wherever it may be (prior_count = 0)");
}

TEST(Localization, SaysWhatIsWrongWithTheNetworks) {
  const Blob samples = landmark_learning::CorridorSamples().Make();
  const BlobPtr networks = RunInProcess(
      landmark_learning::LandmarkLearning({.steps = 1, .holdout = "run 1"}, 3), InputsOf(samples));
  EXPECT_EQ(Complaint(samples, {.traverses = 1}, networks), "");
  EXPECT_EQ(Complaint(samples, {.runs = "run 0"}, networks), "runs: the networks were trained on 'run 0'");
  Blob other = samples;
  other.Put("input_name", Array::Texts({"a", "b", "c", "d", "e"}));
  EXPECT_EQ(Complaint(other, {}, networks), "the networks' input 'door' is not among the samples'");
  auto inputs = InputsOf(samples, networks);
  Blob elsewhere = *networks;
  elsewhere.PutVector<double>("map/y_m", std::vector<double>(elsewhere.Get<double>("map/y_m").size(), 3.0));
  inputs["networks_2"] = std::make_shared<const Blob>(elsewhere);
  EXPECT_THROW(RunInProcess(Localization({}, 1), inputs), InputError);
  Blob cut = *networks;
  cut.PutVector<double>("networks/output_bias", {0.0});
  EXPECT_NE(Complaint(samples, {}, std::make_shared<const Blob>(cut))
                .find("'networks/output_bias' has the shape [1]"),
            std::string::npos);
}

}  // namespace
}  // namespace cairn::localization
