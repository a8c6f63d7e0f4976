#include "pipelines/landmark_learning/landmark_learning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "pipelines/landmark_learning/state/round_sum.h"
#include "pipelines/landmark_learning/state/state.h"
#include "pipelines/landmark_learning/tasks/block_task.h"
#include "pipelines/landmark_learning/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::landmark_learning {
namespace {

BlobPtr Learn(const Blob& samples, const Options& options, int* rounds = nullptr) {
  return RunInProcess(LandmarkLearning(options, 7), {{"samples", std::make_shared<const Blob>(samples)}},
                      [&](const proto::Step&) {
                        if (rounds != nullptr) ++*rounds;
                      });
}

double Reduction(const Blob& result) {
  return 1.0 - result.Get<double>("history/training_error_m").back() / result.Scalar<double>("prior_error_m");
}

TEST(LandmarkLearning, LearnsFeaturesThatLocaliseInARunThatItHasNotSeen) {
  const BlobPtr result =
      Learn(CorridorSamples().Make(), {.steps = 400, .holdout = "run 1", .patience = 1000});
  EXPECT_GT(Reduction(*result), 0.4);
  const auto held_out = result->Get<double>("history/validation_error_m");
  EXPECT_GT(1.0 - held_out[380] / result->Scalar<double>("validation_prior_error_m"), 0.35);
  EXPECT_TRUE(std::isnan(held_out[381]));
  EXPECT_EQ(result->Get<double>("map/x_m").size(), 160U);
  EXPECT_EQ(result->Get<float>("map/output").size(), 4U * 160U);
}

// Of long trainings every so many steps.
TEST(LandmarkLearning, ShowsWhatTheNetworksSeeWhileTheyLearn) {
  const auto samples = std::make_shared<const Blob>(CorridorSamples().Make());
  const LandmarkLearning pipeline({.rate = 0.02, .init_width = 0.5, .steps = 60}, 7);
  const std::vector<BlobPtr> shown = MapsSoFar(pipeline, {{"samples", samples}});
  ASSERT_GT(shown.size(), 30U);
  EXPECT_LT(shown.size(), 60U);
  EXPECT_EQ(shown.front()->Text("so_far/what"), "step 1");
  const auto along = shown.back()->Get<double>("so_far/map/along_m");
  EXPECT_TRUE(std::ranges::is_sorted(along));
  EXPECT_EQ(shown.back()->at("so_far/map/output").shape(), (Shape{std::ssize(along), 4}));
  const auto spread = [](const Blob& map) {
    const auto output = map.Get<float>("so_far/map/output");
    return std::ranges::max(output) - std::ranges::min(output);
  };
  EXPECT_GT(spread(*shown.back()), spread(*shown.front())) << "they come to tell places apart";
}

TEST(LandmarkLearning, EachWayToTrainLowersTheError) {
  for (const char* method : {"gradient", "momentum", "adam", "conjugate", "pseudo"}) {
    const std::string name = method;
    const double rate = name == "adam" ? 0.02 : name == "gradient" || name == "momentum" ? 2.0 : 0.0;
    const std::int64_t steps = name == "pseudo" ? 40 : name == "conjugate" ? 100 : 400;
    const BlobPtr result =
        Learn(CorridorSamples().Make(),
              {.networks = 2, .method = method, .rate = rate, .init_width = 0.5, .steps = steps});
    EXPECT_GT(Reduction(*result), 0.15) << method;
    EXPECT_EQ(result->Get<double>("history/training_error_m").size(), static_cast<std::size_t>(steps))
        << method;
  }
}

TEST(LandmarkLearning, EachWayToTrainLowersTheErrorOfTwoHiddenLayers) {
  const std::pair<const char*, Options> ways[] = {
      {"gradient", {.method = "gradient", .rate = 16.0, .steps = 600}},
      {"momentum", {.method = "momentum", .rate = 8.0, .steps = 600}},
      {"adam", {.method = "adam", .rate = 0.02, .steps = 300}},
      {"conjugate", {.method = "conjugate", .steps = 150}},
      {"pseudo", {.method = "pseudo", .steps = 40}},
      {"sequential", {.rate = 0.02, .steps = 300, .sequential = true}},
      {"batch", {.rate = 0.02, .steps = 300, .batch = 64}},
      {"cells", {.cell_m = 0.25, .rate = 0.02, .steps = 300}},
      {"noise", {.rate = 0.02, .input_noise = 0.2, .steps = 300}}};
  for (auto [name, options] : ways) {
    options.networks = 2;
    options.hidden_2 = 5;
    options.init_width = 1.0;
    EXPECT_GT(Reduction(*Learn(CorridorSamples().Make(), options)), 0.15) << name;
  }
}

// Of 160 samples one stretch, not all.
TEST(LandmarkLearning, ABatchOfOneStretchIsOneStretch) {
  const MapInputs inputs({{"samples", std::make_shared<const Blob>(CorridorSamples().Make())}});
  const Step step = LandmarkLearning({.batch = 10}, 7).Start(inputs);
  ASSERT_EQ(step.plan.tasks_size(), 1);
  EXPECT_EQ(step.plan.tasks(0).params().at("end").i(), 1);
}

TEST(LandmarkLearning, BlocksSeeTheSameNoise) {
  const TrainingData data = TrainingData::Of(CorridorSamples().Make(), "");
  const Options options{.window_m = 5.0};
  Rng rng(3);
  const auto networks = RandomParameters<float>({4, static_cast<int>(data.mean.size()), 6}, 2.0, rng);
  const InputNoise noise{1.0, 5, 17};
  const int count = data.training.size();
  const auto whole = GradientOfStretches(options, PlanSum(options, data.training.positions), data.training,
                                         networks, {{0, count}}, 1.0, noise);
  const auto clean = GradientOfStretches(options, PlanSum(options, data.training.positions), data.training,
                                         networks, {{0, count}}, 1.0);
  EXPECT_GT(std::abs(whole.error - clean.error), 1e-3);
  double error = 0.0;
  std::vector<double> gradient(whole.gradient.size(), 0.0);
  for (const IndexRange& block : {IndexRange{0, 70}, IndexRange{70, 71}, IndexRange{71, count}}) {
    const auto part = GradientOfStretches(options, PlanSum(options, data.training.positions), data.training,
                                          networks, {block}, 1.0, noise);
    error += part.error;
    for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] += part.gradient[i];
  }
  EXPECT_NEAR(error, whole.error, 1e-5);
  for (std::size_t i = 0; i < gradient.size(); ++i) EXPECT_NEAR(gradient[i], whole.gradient[i], 1e-5) << i;
}

TEST(LandmarkLearning, LearnsFromMiniBatches) {
  const BlobPtr result =
      Learn(CorridorSamples().Make(), {.rate = 0.02, .init_width = 0.5, .steps = 600, .batch = 64});
  const auto errors = result->Get<double>("history/training_error_m");
  double last = 0.0;  // a batch's error is that of the true positions it drew
  for (std::size_t s = errors.size() - 100; s < errors.size(); ++s) last += errors[s] / 100;
  EXPECT_GT(1.0 - last / result->Scalar<double>("prior_error_m"), 0.3);
}

TEST(LandmarkLearning, TrainsNetworksOneAfterAnotherAndEachHelps) {
  const BlobPtr result =
      Learn(CorridorSamples().Make(),
            {.networks = 3, .rate = 0.02, .init_width = 0.5, .steps = 600, .sequential = true});
  const auto errors = result->Get<double>("history/training_error_m");
  EXPECT_LT(errors[399], 0.95 * errors[199]);
  EXPECT_LT(errors[599], errors[399]);
  EXPECT_LT(errors[199], errors[0]);
}

TEST(LandmarkLearning, LearnsOnCells) {
  for (const char* method : {"adam", "pseudo"}) {
    const BlobPtr result =
        Learn(CorridorSamples().Make(), {.cell_m = 0.25,
                                         .method = method,
                                         .rate = std::string(method) == "adam" ? 0.02 : 0.0,
                                         .init_width = 0.5,
                                         .steps = std::string(method) == "adam" ? 300 : 20});
    EXPECT_GT(Reduction(*result), 0.4) << method;
  }
}

TEST(LandmarkLearning, SaysThatImagesAreNotLookedAt) {
  Blob samples = CorridorSamples().Make();
  EXPECT_FALSE(Learn(samples, {.steps = 2})->Has("warnings"));
  samples.Put("run/1/image", Array::Of({80, 2, 2, 3}, std::vector<std::uint8_t>(80 * 12)));
  const auto warnings = Learn(samples, {.steps = 2})->Texts("warnings");
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(
      warnings[0],
      "the samples' images are not looked at, only their 5 other inputs: `cairn run image_features` makes "
      "inputs of images");
}

TEST(LandmarkLearning, KeepsWhichInputsTellTheTime) {
  Blob samples = CorridorSamples().Make();
  EXPECT_FALSE(Learn(samples, {.steps = 2})->Has("input_doubts"));
  for (int run = 0; run < 3; ++run) {
    const std::string name = "run/" + std::to_string(run) + "/input";
    const auto values = samples.Get<float>(name);
    std::vector<float> input(values.begin(), values.end());
    for (std::size_t k = 0; k < 80; ++k) input[5 * k + 4] = static_cast<float>(k);
    samples.Put(name, Array::Of<float>({80, 5}, input));
  }
  const auto doubts = Learn(samples, {.steps = 2})->Texts("input_doubts");
  ASSERT_EQ(doubts.size(), 1U);
  EXPECT_EQ(doubts[0].find("input 'constant' only grows along every run"), 0U) << doubts[0];
}

// There and back it sees different things at a position. A robot that knows which way it faces compares with
// what was seen facing that way alone: it errs as much before, and less after.
TEST(LandmarkLearning, WhoKnowsItsHeadingIsNotMisledByWhatItSawOnTheWayBack) {
  const Blob samples = CorridorSamples{.runs = 4, .both_ways = true}.Make();
  const BlobPtr knows = Learn(samples, {.heading_window_deg = 90.0, .rate = 0.02, .steps = 400});
  const BlobPtr does_not = Learn(samples, {.rate = 0.02, .steps = 400});
  EXPECT_NEAR(knows->Scalar<double>("prior_error_m"), does_not->Scalar<double>("prior_error_m"), 0.02);
  EXPECT_GT(Reduction(*knows), Reduction(*does_not) + 0.05);
  EXPECT_EQ(knows->Scalar<double>("heading_window_deg"), 90.0);
  const auto heading = knows->Get<double>("map/heading_rad");
  const auto run = knows->Get<std::int32_t>("map/run");
  ASSERT_EQ(heading.size(), 320U);
  for (std::size_t k = 0; k < 320; ++k) EXPECT_EQ(heading[k] > 2.0, run[k] % 2 == 1) << k;
}

TEST(LandmarkLearning, HeadingsThatAllLieWithinTheWindowChangeNothing) {
  const Blob samples = CorridorSamples{.runs = 3}.Make();
  Blob with = samples;
  for (int r = 0; r < 3; ++r)
    with.PutVector("run/" + std::to_string(r) + "/heading_rad", std::vector<double>(80, 3.1));
  const BlobPtr without_them = Learn(samples, {.steps = 20});
  for (const double window_deg : {180.0, 60.0}) {
    const BlobPtr result = Learn(with, {.heading_window_deg = window_deg, .steps = 20});
    for (const char* name : {"networks/hidden_weight", "networks/output_weight"}) {
      const auto expected = without_them->Get<double>(name), found = result->Get<double>(name);
      ASSERT_FALSE(expected.empty());
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(found[i], expected[i], 1e-3) << window_deg;
    }
  }
}

TEST(LandmarkLearning, RefusesMixturesThatMeanNothing) {
  EXPECT_THROW(Learn(CorridorSamples().Make(), {.cell_m = 1.0, .batch = 64}), InputError);
  EXPECT_THROW(Learn(CorridorSamples().Make(), {.cell_m = 1.0, .method = "conjugate"}), InputError);
  EXPECT_THROW(Learn(CorridorSamples{.both_ways = true}.Make(), {.heading_window_deg = 90.0, .cell_m = 1.0}),
               InputError);
  for (const char* method : {"conjugate", "pseudo"}) {
    EXPECT_THROW(Learn(CorridorSamples().Make(), {.method = method, .batch = 64}), InputError);
    EXPECT_THROW(Learn(CorridorSamples().Make(), {.method = method, .sequential = true}), InputError);
  }
}

// Nothing is known before: the two ends of the corridor must be told apart too.
TEST(LandmarkLearning, LearnsUnderGlobalUncertainty) {
  const BlobPtr result = Learn(CorridorSamples().Make(), {.window_m = 0.0, .init_width = 0.5, .steps = 1500});
  EXPECT_GT(Reduction(*result), 0.35);
  EXPECT_NEAR(result->Scalar<double>("prior_error_m"), 40.0 / 3.0, 0.5);
}

TEST(LandmarkLearning, NoiseAloneTeachesNothingAboutARunThatItHasNotSeen) {
  CorridorSamples samples{.noise = 100.0};
  const BlobPtr result = Learn(samples.Make(), {.steps = 200, .holdout = "run 1", .patience = 3});
  const auto held_out = result->Get<double>("history/validation_error_m");
  EXPECT_GT(held_out.back(), 0.95 * result->Scalar<double>("validation_prior_error_m"));
}

TEST(LandmarkLearning, StopsWhereTheHeldOutRunGetsNoBetterAndKeepsTheBest) {
  int rounds = 0;
  const BlobPtr result = Learn(
      CorridorSamples{.samples = 20, .noise = 1.0}.Make(),
      {.rate = 0.1, .init_width = 0.5, .steps = 5000, .holdout = "run 2", .validate_every = 5, .patience = 4},
      &rounds);
  const auto held_out = result->Get<double>("history/validation_error_m");
  EXPECT_LT(held_out.size(), 5000U);
  EXPECT_EQ(rounds, static_cast<int>(held_out.size()) + 1);
  const std::size_t last = held_out.size() - 1;
  for (std::size_t look = 0; look < 4; ++look)
    EXPECT_GE(held_out[last - 5 * look], held_out[last - 20]) << look;  // four looks without a better one
}

// So many features that blocks of true positions would compute all outputs over and over: three rounds a
// step, or two before patterns are fitted, and the same E and gradient as in one piece.
TEST(LandmarkLearning, AStepInPhasesIsTheStep) {
  const Blob samples = CorridorSamples{.samples = 160}.Make();
  const TrainingData data = TrainingData::Of(samples, "");
  Options options{.networks = 10, .window_m = 0.0, .steps = 3};
  Rng rng(7);
  const auto parameters =
      RandomParameters<double>(ShapeOf(options, data.mean.size()), options.init_width, rng);
  const GradientShare whole =
      GradientOfBlock(options, PlanSum(options, data.training.positions), data.training,
                      InFloat(parameters.shape, parameters.values), {0, data.training.size()});
  const double norm = Norm({whole.gradient.begin(), whole.gradient.end()});
  for (const auto& [method, rounds] : {std::pair("adam", 3 * 3 + 1), std::pair("pseudo", 2 * 3 + 2 + 1)}) {
    int made = 0;
    options.method = method;
    const BlobPtr result = Learn(samples, options, &made);
    EXPECT_EQ(made, rounds) << method;
    const auto error = result->Get<double>("history/training_error_m");
    EXPECT_NEAR(error[0], whole.error, 1e-5 * whole.error) << method;
    EXPECT_NE(error[0], error[1]) << method;
    if (options.method == "adam") {
      EXPECT_NEAR(result->Get<double>("history/gradient_norm")[0], norm, 1e-4 * norm);
    }
  }
}

// The whole of a gradient from its blocks, under a window and under none.
TEST(GradientOfBlock, BlocksAddUpToOneGradient) {
  const TrainingData data = TrainingData::Of(CorridorSamples().Make(), "");
  Rng rng(3);
  const auto parameters = RandomParameters<float>({3, 5, 4}, 1.0, rng);
  const int count = data.training.size();
  for (const double window_m : {1.5, 0.0}) {
    const Options options{.window_m = window_m};
    const GradientShare whole = GradientOfBlock(options, PlanSum(options, data.training.positions),
                                                data.training, parameters, {0, count});
    std::vector<double> sum(whole.gradient.size(), 0.0);
    double error = 0.0;
    for (int first = 0; first < count; first += 50) {
      const GradientShare share =
          GradientOfBlock(options, PlanSum(options, data.training.positions), data.training, parameters,
                          {first, std::min(count, first + 50)});
      error += share.error;
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += share.gradient[i];
    }
    EXPECT_NEAR(error, whole.error, 1e-5 * whole.error);
    double largest = 0.0;
    for (const float slope : whole.gradient)
      largest = std::max(largest, std::abs(static_cast<double>(slope)));
    for (std::size_t i = 0; i < sum.size(); ++i) EXPECT_NEAR(sum[i], whole.gradient[i], 1e-4 * largest) << i;
  }
}

std::string Complaint(const Blob& samples, const Options& options) {
  try {
    Learn(samples, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LandmarkLearning, SaysWhatIsWrongWithTheSamples) {
  const Blob good = CorridorSamples().Make();
  const auto with = [&](const char* name, Array array) {
    Blob bad = good;
    bad.Put(name, std::move(array));
    return bad;
  };
  const Options few{.steps = 1};
  EXPECT_EQ(Complaint(good, few), "");
  EXPECT_EQ(Complaint(good, {.steps = 1, .holdout = "x"}), "holdout: there is no run 'x' among the samples");
  EXPECT_EQ(Complaint(with("run/1/x_m", Array::Vector<double>({1.0})), few),
            "input 'samples': 'run/1/x_m' has the shape [1], where [K] is needed: K is 80 by 'run/1/time_s'");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> x(80, 0.0);
  x[3] = nan;
  EXPECT_EQ(Complaint(with("run/1/x_m", Array::Vector(x)), few),
            "input 'samples': 'run/1/x_m', entry 3: nan, where -1e+09 to 1e+09 is needed");
  std::vector<float> input(400, 0.0F);
  input[12] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(Complaint(with("run/2/input", Array::Of<float>({80, 5}, input)), few),
            "input 'samples': 'run/2/input', entry 12: inf, where a finite number is needed");
  EXPECT_NE(Complaint(good, {.window_m = 1e-9, .steps = 1}).find("reaches no other position"),
            std::string::npos);
  EXPECT_EQ(Complaint(CorridorSamples{.runs = 1, .samples = 1}.Make(), few),
            "run 'run 0' has 1 samples; two are the least");
  EXPECT_EQ(Complaint(CorridorSamples{.runs = 1}.Make(), {.steps = 1, .holdout = "run 0"}),
            "no run is left to train on");
  EXPECT_EQ(Complaint(good, {.heading_window_deg = 90.0, .steps = 1}),
            "heading_window_deg: it takes samples whose headings are known, 'heading_rad' of each run");
  EXPECT_EQ(Complaint(with("run/1/heading_rad", Array::Vector<double>({1.0})), few),
            "input 'samples': 'run/1/heading_rad' has the shape [1], where [K] is needed: K is 80 by "
            "'run/1/time_s'");
}

}  // namespace
}  // namespace cairn::landmark_learning
