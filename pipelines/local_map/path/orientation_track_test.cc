#include "pipelines/local_map/path/orientation_track.h"

#include <gtest/gtest.h>

#include <cmath>

#include "schema/rng.h"

namespace cairn::local_map {
namespace {

struct SightedDrive {
  std::vector<OrientationSight> sights;
  std::vector<double> true_rad;  // of walls in the odometric frame
};

// 80 m, a scan each 0.1 m, a quarter turn each 10 m, by odometry that drifts; half a metre of wall aside of
// other things is seen in most scans. From `turned_from` on, for 4 m, all walls stand 30 degrees askew.
SightedDrive Sights(double drift_rad_per_m, double turn_scale, double walk, int turned_from = -1) {
  Rng rng(5);
  SightedDrive drive;
  double angle = 0.3, heading = 0;
  for (int s = 0; s < 800; ++s) {
    const double turn = s % 100 == 99 ? M_PI / 2 : 0;
    heading += turn;
    angle += drift_rad_per_m * 0.1 + turn_scale * turn + walk * std::sqrt(0.1) * rng.Normal();
    OrientationSight sight;
    sight.path_m = 0.1 * s;
    sight.heading_rad = heading;
    const bool turned = turned_from >= 0 && s >= turned_from && s < turned_from + 40;
    if (rng.Uniform() < 0.8)
      AddEdge(angle + (turned ? M_PI / 6 : 0) + 0.03 * rng.Normal(), 1.5, &sight.edges_m);
    AddEdge(rng.Uniform(0, M_PI), 0.5, &sight.edges_m);
    drive.sights.push_back(sight);
    drive.true_rad.push_back(angle);
  }
  return drive;
}

double MeanErrorDeg(const SightedDrive& drive, const OrientationTrack& track) {
  double sum = 0;
  for (std::size_t s = 0; s < drive.sights.size(); ++s)
    sum += std::abs(track.at[s].angle_rad - drive.true_rad[s]) * 180 / M_PI;
  return sum / static_cast<double>(drive.sights.size());
}

TEST(OrientationTrack, FollowsADriftOfSeveralQuarterTurnsAndSaysHowLargeItIs) {
  const SightedDrive drive = Sights(0.06, 0.03, 0.01);
  const OrientationTrack track = TrackOrientation(drive.sights, {});
  EXPECT_TRUE(track.seen);
  EXPECT_LT(MeanErrorDeg(drive, track), 1);
  EXPECT_NEAR(track.drift_rad_per_m, 0.06, 0.01);
}

TEST(OrientationTrack, IsNotLedAstrayByAnAreaThatIsOrientedOtherwise) {
  const SightedDrive drive = Sights(0.001, 0.01, 0.008, 400);
  const OrientationTrack track = TrackOrientation(drive.sights, {});
  EXPECT_LT(MeanErrorDeg(drive, track), 1);
  int there = 0, elsewhere = 0;
  for (std::size_t s = 0; s < track.at.size(); ++s)
    (s >= 400 && s < 440 ? there : elsewhere) += track.at[s].other;
  EXPECT_GT(there, 25);
  EXPECT_LT(elsewhere, 200);  // where no wall was seen, but other things
}

TEST(OrientationTrack, WithoutEdgesHasSeenNothing) {
  std::vector<OrientationSight> sights(20);
  for (std::size_t s = 0; s < sights.size(); ++s) sights[s].path_m = 0.1 * static_cast<double>(s);
  const OrientationTrack track = TrackOrientation(sights, {});
  EXPECT_FALSE(track.seen);
  ASSERT_EQ(track.at.size(), 20U);
  EXPECT_TRUE(TrackOrientation({}, {}).at.empty());
}

TEST(EdgeHistogram, TurnsModuloAQuarterTurn) {
  EdgeHistogram histogram{};
  AddEdge(10 * kBin_rad, 2, &histogram);
  AddEdge(80 * kBin_rad, 1, &histogram);
  const EdgeHistogram turned = Turned(histogram, M_PI + 20 * kBin_rad);
  EXPECT_NEAR(turned[30], 2, 1e-5);
  EXPECT_NEAR(turned[10], 1, 1e-5);
  EXPECT_NEAR(turned[80], 0, 1e-5);
}

TEST(EdgeHistogram, KeepsTheMeanOfAnAngle) {
  EdgeHistogram histogram{};
  AddEdge(0.0123, 2, &histogram);
  double metres = 0, mean = 0;
  for (std::size_t b = 0; b < kBins; ++b) {
    metres += histogram[b];
    mean += histogram[b] * kBin_rad * static_cast<double>(b);
  }
  EXPECT_NEAR(metres, 2, 1e-6);
  EXPECT_NEAR(mean / metres, 0.0123, 1e-6);
}

}  // namespace
}  // namespace cairn::local_map
