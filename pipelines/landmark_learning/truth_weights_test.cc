#include "pipelines/landmark_learning/truth_weights.h"

#include <gtest/gtest.h>

#include <numeric>

#include "pipelines/landmark_learning/testing.h"
#include "schema/kinds/kind.h"

namespace cairn::landmark_learning {
namespace {

// A run of three samples, two of them within a half metre.
Blob Three() {
  Blob samples;
  samples.Put("runs", Array::Texts({"a"}));
  samples.Put("input_name", Array::Texts({"s"}));
  samples.PutVector<double>("run/0/time_s", {0, 1, 2});
  samples.PutVector<double>("run/0/x_m", {5.1, 0.1, 5.2});
  samples.PutVector<double>("run/0/y_m", {0, 0, 0});
  samples.Put("run/0/input", Array::Of<float>({3, 1}, std::vector<float>{1, 2, 3}));
  return samples;
}

std::vector<double> Weights(const Blob& samples, const char* true_positions) {
  TrainingData data = TrainingData::Of(samples, "");
  WeighTruePositions({.true_positions = true_positions}, &data);
  return data.training.weight;  // sorted by x: those of samples 1, 0, 2
}

TEST(TruthWeights, CountSamplesOrSpaceAlike) {
  for (const double w : Weights(Three(), "samples")) EXPECT_DOUBLE_EQ(w, 1.0 / 3);
  const auto space = Weights(Three(), "space");
  EXPECT_DOUBLE_EQ(space[0], 0.5);
  EXPECT_DOUBLE_EQ(space[1], 0.25);
  EXPECT_DOUBLE_EQ(space[2], 0.25);
}

TEST(TruthWeights, ComeFromTheFileAndStayWithTheirSamples) {
  Blob samples = Three();
  samples.PutVector<double>("run/0/weight", {3, 1, 0});
  const auto weights = Weights(samples, "file");
  EXPECT_DOUBLE_EQ(weights[0], 0.25);
  EXPECT_DOUBLE_EQ(weights[1], 0.75);
  EXPECT_DOUBLE_EQ(weights[2], 0.0);
}

TEST(TruthWeights, ThatAreMissingOrNoWeightsAreRefused) {
  EXPECT_THROW(Weights(Three(), "file"), InputError);
  Blob samples = Three();
  samples.PutVector<double>("run/0/weight", {0, 0, 0});
  EXPECT_THROW(Weights(samples, "file"), InputError);
  samples.PutVector<double>("run/0/weight", {1, -1, 0});
  try {
    CheckInput(samples, "samples");  // as before a job starts
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "input 'samples': 'run/0/weight', entry 1: -1, where 0 or more is needed");
  }
}

}  // namespace
}  // namespace cairn::landmark_learning
