#include "datasets/evaluate/track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace cairn::datasets {
namespace {

const Track kTrack = {{1, 2, 5, 5.5}, {{0, 0, 3.1}, {2, 4, -3.1}, {10, 4, 0}, {10, 5, 1}}};

TEST(PoseAt, GivesTheSamplesThemselvesToTheEnds) {
  for (std::size_t i = 0; i < kTrack.time_s.size(); ++i) {
    const auto pose = PoseAt(kTrack, kTrack.time_s[i]);
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->x_m, kTrack.poses[i].x_m);
    EXPECT_EQ(pose->heading_rad, kTrack.poses[i].heading_rad);
  }
}

TEST(PoseAt, InterpolatesTheHeadingAlongTheShorterArc) {
  const auto pose = PoseAt(kTrack, 1.25);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x_m, 0.5, 1e-12);
  EXPECT_NEAR(pose->y_m, 1, 1e-12);
  EXPECT_NEAR(pose->heading_rad, 3.1 + 0.25 * (2 * std::numbers::pi - 6.2), 1e-12);
}

TEST(PoseAt, DoesNotGoBeyondTheEndsNorOverLongGaps) {
  EXPECT_FALSE(PoseAt(kTrack, 0.999));
  EXPECT_FALSE(PoseAt(kTrack, 5.501));
  EXPECT_FALSE(PoseAt(kTrack, 3));  // between 2 s and 5 s
  EXPECT_TRUE(PoseAt(kTrack, 5.25));
  EXPECT_FALSE(PoseAt({}, 0));
}

Blob Columns(const std::vector<double>& time, const std::vector<double>& x) {
  Blob blob;
  blob.PutVector("p/time_s", time);
  blob.PutVector("p/mode_x_m", x);
  blob.PutVector("p/mode_y_m", x);
  blob.PutVector("p/mode_heading_rad", x);
  return blob;
}

TEST(ReadTrack, ReadsColumns) {
  EXPECT_EQ(TrackOf(kinds::LikeliestPoses("p/", Columns({0, 1}, {2, 3}))).poses[1].x_m, 3);
  EXPECT_TRUE(ReadTrack(Blob(), "p/").time_s.empty());
  EXPECT_THROW(ReadTrack(Columns({0, 1}, {2, 3}), "p/"), InputError);
}

}  // namespace
}  // namespace cairn::datasets
