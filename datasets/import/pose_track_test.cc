#include "datasets/import/pose_track.h"

#include <cmath>

#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

class PoseTrackTest : public testing::Test {
 protected:
  TestFolder folder_;
  BadLines strict_{false};

  PoseTracks Read(const std::string& text, double smooth_s = 0) {
    return {folder_.Put("track.csv", text), smooth_s, &strict_};
  }
  std::string Failure(const std::string& text) {
    return InputErrorOf([&] { Read(text); });
  }
};

TEST_F(PoseTrackTest, LiesBetweenItsRowsAndNowhereElse) {
  const PoseTracks track = Read("y_m,time_s,x_m\n0,1,10\n4,2,12\n5,6,12\n");
  EXPECT_FALSE(track.has_heading());
  EXPECT_DOUBLE_EQ(track.At("any", 1.25, 2)->x_m, 10.5);
  EXPECT_DOUBLE_EQ(track.At("any", 1.25, 2)->y_m, 1);
  EXPECT_DOUBLE_EQ(track.At("any", 1, 2)->x_m, 10);
  EXPECT_DOUBLE_EQ(track.At("any", 6, 2)->y_m, 5);
  EXPECT_FALSE(track.At("any", 0.99, 2));
  EXPECT_FALSE(track.At("any", 6.01, 2));
  EXPECT_FALSE(track.At("any", 3, 2)) << "in a gap of 4 s";
  EXPECT_TRUE(track.At("any", 3, 4));
}

TEST_F(PoseTrackTest, RunsHaveTracksOfTheirOwn) {
  const PoseTracks tracks = Read("run,time_s,x_m,y_m\na,0,0,0\nb,0,7,0\na,1,1,0\nb,1,8,0\n");
  EXPECT_DOUBLE_EQ(tracks.At("a", 0.5, 2)->x_m, 0.5);
  EXPECT_DOUBLE_EQ(tracks.At("b", 0.5, 2)->x_m, 7.5);
  EXPECT_FALSE(tracks.At("c", 0.5, 2));
}

TEST_F(PoseTrackTest, HeadingsTurnTheShortWay) {
  const PoseTracks track = Read("time_s,x_m,y_m,heading_rad\n0,0,0,3.04\n1,0,0,-3.04\n", 0);
  EXPECT_NEAR(std::abs(track.At("", 0.5, 2)->heading_rad), M_PI, 1e-12);
}

// A mean over 2 s: of rows within a second to either side, at the ends of fewer.
TEST_F(PoseTrackTest, IsSmoothedOverTime) {
  const PoseTracks track = Read("time_s,x_m,y_m\n0,0,0\n1,3,0\n2,0,0\n3,9,0\n", 2);
  EXPECT_DOUBLE_EQ(track.At("", 0, 2)->x_m, 1.5);
  EXPECT_DOUBLE_EQ(track.At("", 1, 2)->x_m, 1);
  EXPECT_DOUBLE_EQ(track.At("", 2, 2)->x_m, 4);
  EXPECT_DOUBLE_EQ(track.At("", 3, 2)->x_m, 4.5);
}

TEST_F(PoseTrackTest, RefusesWhatIsNoTrack) {
  ExpectContains(Failure("time_s,x_m\n"), "track.csv:1: the header lacks columns");
  ExpectContains(Failure("time_s,x_m,y_m\n"), "track.csv: there is no track in it");
  ExpectContains(Failure("time_s,x_m,y_m\n0,0,0\n"), "track.csv: a track has two rows or more; it has one");
  ExpectContains(Failure("run,time_s,x_m,y_m\na,0,0,0\n"), "that of 'a' has one");
  ExpectContains(Failure("time_s,x_m,y_m\n0,0,0\n0,1,0\n"), "track.csv:3: time does not run forward");
  ExpectContains(Failure("time_s,x_m,y_m\n5,0,0\n5,1,0\n"), "are times rounded to whole seconds?");
  EXPECT_EQ(Failure("time_s,x_m,y_m\n5.5,0,0\n5.5,1,0\n").find("rounded"), std::string::npos);
  ExpectContains(Failure("time_s,x_m,y_m\n0,nan,0\n"), "track.csv:2: not finite");
}

}  // namespace
}  // namespace cairn::datasets
