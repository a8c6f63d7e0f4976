#include "pipelines/landmark_learning/held_out_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pipelines/landmark_learning/testing.h"

namespace cairn::landmark_learning {
namespace {

constexpr std::size_t kSamples = 80, kInputs = 5;

// Run 2 is held out; the networks are not trained.
kinds::Networks::HeldOut Checked(const Blob& samples, const Options& options = {}) {
  const TrainingData data = TrainingData::Of(samples, "run 2");
  Rng rng(1);
  return CheckHeldOut(options, data, RandomParameters<float>({2, kInputs, 6}, 1.0, rng));
}

template <class T>
std::vector<T> Column(const Blob& blob, const std::string& name) {
  const auto values = blob.Get<T>(name);
  return {values.begin(), values.end()};
}

void PutInputs(int run, const std::vector<float>& input, Blob* samples) {
  samples->Put("run/" + std::to_string(run) + "/input", Array::Of<float>({kSamples, kInputs}, input));
}

TEST(CheckHeldOut, OfARunOfItsOwnFindsThatItGoesWithTheOthers) {
  const auto check = Checked(CorridorSamples().Make());
  EXPECT_EQ(check.samples.Scalar(), 80);
  EXPECT_EQ(check.in_reach.Scalar(), 80);
  EXPECT_LT(check.same_share.Scalar(), 0.05);
  EXPECT_GT(check.agreement_sigmas.Scalar(), 3.0);
}

TEST(CheckHeldOut, WhatDriftsGoesWithTheOthersByChance) {
  int above_2 = 0;
  constexpr int kTrials = 40;
  for (int trial = 0; trial < kTrials; ++trial) {
    Rng rng(static_cast<std::uint64_t>(trial));
    Blob samples = CorridorSamples().Make();
    for (int run = 0; run < 3; ++run) {
      std::vector<float> input(kSamples * kInputs);
      for (std::size_t k = 0; k < input.size(); ++k)
        input[k] = (k < kInputs ? 0.0F : input[k - kInputs]) + static_cast<float>(rng.Normal());
      PutInputs(run, input, &samples);
    }
    above_2 += Checked(samples).agreement_sigmas.Scalar() > 2.0 ? 1 : 0;
  }
  EXPECT_LE(above_2, kTrials / 10);
}

TEST(CheckHeldOut, CountsThoseThatLieWhereTheOthersHaveBeen) {
  Blob samples = CorridorSamples().Make();
  std::vector<double> x_m = Column<double>(samples, "run/2/x_m");
  for (std::size_t k = 5; k < x_m.size(); ++k) x_m[k] += 100;
  samples.PutVector("run/2/x_m", x_m);
  EXPECT_EQ(Checked(samples).in_reach.Scalar(), 5);
  EXPECT_EQ(Checked(samples, {.window_m = 0.0}).in_reach.Scalar(), 80) << "knows nothing before";
}

TEST(CheckHeldOut, KnowsACopyByWhatWasSensed) {
  Blob samples = CorridorSamples().Make();
  std::vector<float> input = Column<float>(samples, "run/0/input");
  std::vector<double> x_m = Column<double>(samples, "run/0/x_m");
  for (float& value : input) value = std::round(1000 * value) / 1000;
  for (std::size_t k = 0; k < x_m.size(); ++k) x_m[k] += 0.02 * std::sin(static_cast<double>(k));
  PutInputs(2, input, &samples);
  samples.PutVector("run/2/x_m", x_m);
  EXPECT_GT(Checked(samples).same_share.Scalar(), 0.95);
}

// Detectors say yes or no: that two samples agree is no sign that one is copied.
TEST(CheckHeldOut, WhatIsTheSameByChanceIsNoCopy) {
  Blob samples = CorridorSamples().Make();
  Rng rng(5);
  for (int run = 0; run < 3; ++run) {
    std::vector<float> input(kSamples * kInputs);
    for (float& value : input) value = rng.Uniform() < 0.5 ? 0.0F : 1.0F;
    PutInputs(run, input, &samples);
  }
  EXPECT_LT(Checked(samples).same_share.Scalar(), 0.1);
}

TEST(CheckHeldOut, SaysNothingWhereNoRunIsHeldOut) {
  const TrainingData data = TrainingData::Of(CorridorSamples().Make(), "");
  EXPECT_FALSE(CheckHeldOut({}, data, Parameters<float>({1, kInputs, 2})).samples);
}

}  // namespace
}  // namespace cairn::landmark_learning
