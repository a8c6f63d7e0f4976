#include "pipelines/local_map/path/lost_beams.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace cairn::local_map {
namespace {

std::vector<Pose> Beams(int count, double view_deg) {
  std::vector<Pose> beams;
  for (int b = 0; b < count; ++b)
    beams.push_back({0, 0, WrapAngle((b * view_deg / (count - 1) - view_deg / 2) * std::numbers::pi / 180)});
  return beams;
}

// Which are lost where these do not answer.
std::vector<int> LostOf(const std::vector<Pose>& beams, const std::vector<int>& silent) {
  std::vector<bool> answered(beams.size(), true);
  for (const int b : silent) answered[static_cast<std::size_t>(b)] = false;
  const std::vector<bool> lost = LostBeams(beams, answered);
  std::vector<int> all;
  for (std::size_t b = 0; b < lost.size(); ++b)
    if (lost[b]) all.push_back(static_cast<int>(b));
  return all;
}

using Ints = std::vector<int>;

TEST(LostBeams, AreFewAmongNeighboursThatAnswer) {
  const std::vector<Pose> fan = Beams(181, 180);
  EXPECT_EQ(LostOf(fan, {}), Ints());
  EXPECT_EQ(LostOf(fan, {90}), Ints{90});
  EXPECT_EQ(LostOf(fan, {20, 90, 91, 92, 94}), (Ints{20, 90, 91, 92, 94}));
  // Half a degree apart there are more of them in the same gap.
  EXPECT_EQ(LostOf(Beams(361, 180), {50, 51, 52, 53, 54, 55, 56}), (Ints{50, 51, 52, 53, 54, 55, 56}));
}

TEST(LostBeams, ABlockWasNotSeen) {
  EXPECT_EQ(LostOf(Beams(181, 180), {90, 91, 92, 93}), Ints());
  EXPECT_EQ(LostOf(Beams(181, 180), {30, 90, 91, 92, 93, 94, 95, 96, 97}), Ints{30});
  std::vector<int> all(181);
  for (int b = 0; b < 181; ++b) all[static_cast<std::size_t>(b)] = b;
  EXPECT_EQ(LostOf(Beams(181, 180), all), Ints());
}

TEST(LostBeams, BeyondAFansEndNothingAnswers) {
  EXPECT_EQ(LostOf(Beams(181, 180), {0, 1, 180}), Ints());
  // A closed ring has no end.
  EXPECT_EQ(LostOf(Beams(360, 359), {0, 359}), (Ints{0, 359}));
}

TEST(LostBeams, OfBeamsThatStandFarApartOneMayBeLost) {
  EXPECT_EQ(LostOf(Beams(31, 180), {4, 10, 11}), Ints{4});
}

}  // namespace
}  // namespace cairn::local_map
