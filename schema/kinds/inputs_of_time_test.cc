#include "schema/kinds/inputs_of_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace cairn {
namespace {

using Sensed = std::function<float(int run, int sample)>;

// Runs of `count` samples, of a range beside the other input.
Blob SamplesOf(const Sensed& input, int count = 20) {
  Blob samples;
  samples.Put("runs", Array::Texts({"monday", "tuesday"}));
  samples.Put("input_name", Array::Texts({"range", "seq"}));
  for (int run = 0; run < 2; ++run) {
    std::vector<float> values;
    for (int k = 0; k < count; ++k) {
      values.push_back(std::sin(static_cast<float>(k)));
      values.push_back(input(run, k));
    }
    samples.Put("run/" + std::to_string(run) + "/input", Array::Of({count, 2}, values));
  }
  return samples;
}

TEST(InputsOfTime, OnlyGrowOrOnlyFallAlongEveryRun) {
  const auto counter = InputsOfTimeOf(SamplesOf([](int, int k) { return static_cast<float>(k); }));
  ASSERT_EQ(counter.size(), 1U);
  EXPECT_EQ(counter[0].find("input 'seq' only grows along every run: is it a clock"), 0U) << counter[0];
  const auto battery = InputsOfTimeOf(SamplesOf([](int run, int k) { return 24 - 0.1F * k - run; }));
  ASSERT_EQ(battery.size(), 1U);
  EXPECT_EQ(battery[0].find("input 'seq' only falls along every run"), 0U) << battery[0];
}

TEST(InputsOfTime, AreKnownThroughRoundingAndNoise) {
  const auto seconds = InputsOfTimeOf(SamplesOf([](int, int k) { return std::floor(0.2F * k); }, 200));
  ASSERT_EQ(seconds.size(), 1U);
  EXPECT_EQ(seconds[0].find("input 'seq' only grows along every run"), 0U) << seconds[0];
  const auto battery = [](int, int k) { return std::round(240 - 0.1F * k) / 10; };
  EXPECT_EQ(InputsOfTimeOf(SamplesOf(battery, 200)).size(), 1U);
  const auto noisy = InputsOfTimeOf(
      SamplesOf([](int, int k) { return 24 - 0.01F * k + (k * k % 7 < 3 ? 0.02F : -0.02F); }, 200));
  ASSERT_EQ(noisy.size(), 1U);
  EXPECT_EQ(noisy[0].find("input 'seq' mostly falls along every run"), 0U) << noisy[0];
}

TEST(InputsOfTime, OthersAreNone) {
  EXPECT_TRUE(InputsOfTimeOf(SamplesOf([](int run, int k) { return run == 0 ? k : 20.0F - k; })).empty())
      << "the range to a wall, there and back";
  EXPECT_TRUE(InputsOfTimeOf(SamplesOf([](int, int k) { return std::sin(0.2F * k); }, 40)).empty());
  EXPECT_TRUE(InputsOfTimeOf(SamplesOf([](int, int k) { return k < 10 ? 0.0F : 1.0F; })).empty())
      << "a light that is switched on";
  EXPECT_TRUE(InputsOfTimeOf(SamplesOf([](int, int k) { return k; }, 19)).empty());
  EXPECT_TRUE(InputsOfTimeOf(Blob()).empty());
}

}  // namespace
}  // namespace cairn
