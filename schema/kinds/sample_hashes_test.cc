#include "schema/kinds/sample_hashes.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

kinds::Samples::Run RunOfThree(float last_input) {
  kinds::Samples::Run run;
  run.x_m = std::vector<double>{1, 1, 2};
  run.y_m = std::vector<double>{0, 0, 0};
  run.input = {{3, 2}, std::vector<float>{5, 6, 5, 6, 7, last_input}};
  return run;
}

TEST(SampleHashes, AreOfPlaceAndInputs) {
  const std::vector<std::int64_t> one = SampleHashes(RunOfThree(8), 2),
                                  other = SampleHashes(RunOfThree(9), 2);
  ASSERT_EQ(one.size(), 3U);
  EXPECT_EQ(one[0], one[1]);
  EXPECT_EQ(one[0], other[0]);
  EXPECT_NE(one[2], other[2]);
}

TEST(SampleHashes, MoreThanHalfOfThoseThatDifferMakeACopy) {
  const std::vector<std::int64_t> samples = {1, 1, 1, 2, 3};
  EXPECT_EQ(InCommon(samples, {1, 7}).known, 1U);
  EXPECT_EQ(InCommon(samples, {1, 7}).all, 3U);
  EXPECT_FALSE(InCommon(samples, {1, 7}).AreACopy());
  EXPECT_TRUE(InCommon(samples, {1, 3}).AreACopy());
  EXPECT_FALSE(InCommon({}, {1}).AreACopy());
}

}  // namespace
}  // namespace cairn
