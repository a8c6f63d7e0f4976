#include "pipelines/local_map/traces/profile.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn::local_map {
namespace {

Profile Bell(double at_m, double sd_m, double height) {
  Profile profile(0.04, 1);
  for (int step = -profile.reach(); step <= profile.reach(); ++step) {
    const double off = (step * profile.step_m() - at_m) / sd_m;
    profile[step] = height * -0.5 * off * off;
  }
  return profile;
}

TEST(Profile, FindsAPeakBetweenItsSteps) {
  const Peak peak = Bell(0.217, 0.1, 1).FindPeak(1);
  EXPECT_NEAR(peak.at_m, 0.217, 1e-9);
  EXPECT_TRUE(peak.inside);
}

TEST(Profile, SpreadIsThatOfTheDistributionThatItStandsFor) {
  EXPECT_NEAR(Bell(0.2, 0.1, 1).FindPeak(1).sd_m, 0.1, 1e-3);
  EXPECT_NEAR(Bell(0.2, 0.1, 1).FindPeak(0.25).sd_m, 0.2, 1e-3);
}

TEST(Profile, FlatOneDeterminesNothingAndItsPeakIsTheAssumedPosition) {
  const Peak peak = Profile(0.04, 1).FindPeak(1);
  EXPECT_TRUE(std::isinf(peak.sd_m));
  EXPECT_EQ(peak.at_m, 0);
}

TEST(Profile, PeakAtTheEndIsSaidToBeOne) { EXPECT_FALSE(Bell(1.5, 0.3, 1).FindPeak(1).inside); }

TEST(Profile, ReachesNoFurtherThanItsRoom) { EXPECT_EQ(Profile(0.04, 100).reach(), Profile::kReach); }

}  // namespace
}  // namespace cairn::local_map
