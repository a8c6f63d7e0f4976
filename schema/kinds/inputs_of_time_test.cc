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

TEST(InputsOfTime, OthersAreNone) {
  EXPECT_TRUE(InputsOfTimeOf(SamplesOf([](int run, int k) { return run == 0 ? k : 20.0F - k; })).empty())
      << "the range to a wall, there and back";
  EXPECT_TRUE(InputsOfTimeOf(SamplesOf([](int, int k) { return k == 9 ? 7.0F : k; })).empty());
  EXPECT_TRUE(InputsOfTimeOf(SamplesOf([](int, int k) { return k < 10 ? 0.0F : 1.0F; })).empty())
      << "a light that is switched on";
  EXPECT_TRUE(InputsOfTimeOf(SamplesOf([](int, int k) { return k; }, 19)).empty());
  EXPECT_TRUE(InputsOfTimeOf(Blob()).empty());
}

}  // namespace
}  // namespace cairn
