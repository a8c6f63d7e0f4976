#include "pipelines/landmark_learning/data/training_data.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipelines/landmark_learning/testing.h"

namespace cairn::landmark_learning {
namespace {

TEST(TrainingData, IsNormalisedByTheTrainingSamplesAlone) {
  const TrainingData data = TrainingData::Of(CorridorSamples().Make(), "run 1");
  EXPECT_EQ(data.training.size(), 160);
  EXPECT_EQ(data.held_out.size(), 80);
  for (std::size_t input = 0; input < 5; ++input) {
    double sum = 0.0, squares = 0.0;
    for (std::size_t k = 0; k < 160; ++k) {
      const double x = data.training.inputs()[5 * k + input];
      sum += x;
      squares += x * x;
    }
    EXPECT_NEAR(sum / 160, 0.0, 1e-6) << input;
    EXPECT_NEAR(squares / 160, input == 4 ? 0.0 : 1.0, 1e-5) << input;  // the last one never changes
  }
  EXPECT_TRUE(std::ranges::all_of(data.held_out.run, [](std::int32_t run) { return run == 1; }));
}

TEST(TrainingData, IsSortedInSpaceWithEachSamplesOwnInputsAndWay) {
  const CorridorSamples corridor;
  const Blob samples = corridor.Make();
  const TrainingData data = TrainingData::Of(samples, "");
  EXPECT_TRUE(std::ranges::is_sorted(data.training.positions.x_m));
  const auto x = samples.Get<double>("run/2/x_m");
  const auto inputs = samples.Get<float>("run/2/input");
  const auto found = std::ranges::find(data.training.positions.x_m, x[33]);
  ASSERT_NE(found, data.training.positions.x_m.end());
  const auto at = static_cast<std::size_t>(found - data.training.positions.x_m.begin());
  EXPECT_EQ(data.training.run[at], 2);
  EXPECT_NEAR(data.training.inputs()[5 * at] * data.scale[0] + data.mean[0], inputs[5 * 33], 1e-5);
  EXPECT_NEAR(data.training.positions.along_m[at], x[33] - x[0], 0.5);  // the way, which wobbles
}

TEST(TrainingData, ComesBackAsItWasStored) {
  const TrainingData data = TrainingData::Of(CorridorSamples().Make(), "run 0");
  EXPECT_EQ(BlobOf(Read<TrainingData>(BlobOf(data))).ContentHash(), BlobOf(data).ContentHash());
  const TrainingData facing = TrainingData::Of(CorridorSamples{.both_ways = true}.Make(), "run 0");
  const TrainingData back = Read<TrainingData>(BlobOf(facing));
  EXPECT_EQ(back.training.heading_rad, facing.training.heading_rad);
  EXPECT_EQ(back.held_out.positions.cos_heading, facing.held_out.positions.cos_heading);
  EXPECT_EQ(back.training.positions.sin_heading.size(), 160U);
}

TEST(TrainingData, ARunThatIsACopyOfOneThatIsTrainedOnIsNotHeldOut) {
  Blob samples = CorridorSamples{.runs = 3}.Make();
  for (const char* column : {"x_m", "y_m", "input"})
    samples.Put(std::string("run/2/") + column, samples.at(std::string("run/0/") + column));
  std::string refusal;
  try {
    TrainingData::Of(samples, "run 2");
  } catch (const InputError& error) {
    refusal = error.what();
  }
  EXPECT_EQ(refusal.find("holdout: 80 of 80 samples of run 'run 2' are row by row those of run 'run 0'"), 0U)
      << refusal;
  EXPECT_EQ(TrainingData::Of(samples, "run 1").held_out.size(), 80) << "that one is another";
  EXPECT_EQ(TrainingData::Of(samples, "run 2", nullptr, {"run 0"}).training.size(), 80);
}

TEST(TrainingData, OfUnseenRunsNothingIsLeft) {
  const Blob samples = CorridorSamples{.runs = 3}.Make();
  const TrainingData without = TrainingData::Of(samples, "run 2", nullptr, {"run 0"});
  EXPECT_EQ(without.runs, (std::vector<std::string>{"run 1", "run 2"}));
  EXPECT_EQ(without.training.size(), 80);
  EXPECT_EQ(without.training.run.front(), 0);
  EXPECT_EQ(without.held_out.run.front(), 1);
  EXPECT_NE(without.mean, TrainingData::Of(samples, "run 2").mean);
  EXPECT_THROW(TrainingData::Of(samples, "", nullptr, {"run 7"}), InputError);
  EXPECT_THROW(TrainingData::Of(samples, "run 1", nullptr, {"run 1"}), InputError);
  EXPECT_THROW(TrainingData::Of(samples, "run 1", nullptr, {"run 0", "run 2"}), InputError);
}

}  // namespace
}  // namespace cairn::landmark_learning
