#include "pipelines/local_map/path/motion_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "pipelines/local_map/testing/corridor.h"

namespace cairn::local_map {
namespace {

// A robot drives along a corridor, turns round and drives back, five scans a second.
class WatchedDrive {
 public:
  WatchedDrive() = default;
  // Of a laser that sees no more than so much to either side of ahead.
  explicit WatchedDrive(double sees_rad) : sees_rad_(sees_rad) {}
  // Of another sensor, elsewhere.
  WatchedDrive(std::vector<Pose> beams, double reach_m, bool exact, std::vector<TestWall> walls)
      : walls_(std::move(walls)), beams_(std::move(beams)), reach_m_(reach_m), exact_(exact) {}
  // The robot moves so, and odometry says so of it.
  void Move(const Pose& by, const Pose& odometry) {
    truth_ = Compose(truth_, by);
    dead_ = Compose(dead_, odometry);
    time_s_ += kStep_s;
    if (!reads_) return;
    std::vector<double> ranges = RayScan(walls_, beams_, reach_m_, truth_, rng_, exact_);
    for (std::size_t b = 0; b < ranges.size(); ++b)
      if (std::abs(WrapAngle(beams_[b].heading_rad)) > sees_rad_) ranges[b] = NAN;
    const RingScan scan{time_s_, 0, ranges};
    watch_.Update(static_cast<std::int64_t>(scans_.size()), time_s_, dead_, false, {&scan, 1}, true);
    scans_.push_back({.time_s = time_s_, .pose = dead_});
  }
  void Ahead(double way_m, double odometry_ratio = 1, double slips_ratio = 1) {
    for (double gone_m = 0; gone_m < way_m; gone_m += 0.08)
      Move({0.08 * slips_ratio, 0, 0}, {0.08 * odometry_ratio, 0, 0.002});
  }
  void Turn(double turn_rad, double odometry_ratio) {
    for (int k = 0; k < 20; ++k) Move({0, 0, turn_rad / 20}, {0, 0, odometry_ratio * turn_rad / 20});
  }
  void Read(bool reads) { reads_ = reads; }
  std::vector<Disagreement> Found() const { return Disagreements(watch_.found(), scans_); }

 private:
  static constexpr double kStep_s = 0.2;
  std::vector<TestWall> walls_ = NichedCorridor();
  Rng rng_{5};
  Pose truth_{-4, 0, 0}, dead_;
  double time_s_ = 0;
  bool reads_ = true;
  std::vector<Pose> beams_ = LaserBeams();
  double reach_m_ = 10, sees_rad_ = M_PI;
  bool exact_ = false;
  MotionWatch watch_{{{beams_, 0, reach_m_}}};
  std::vector<Scan> scans_;
};

constexpr double kQuarter_rad = M_PI / 2;

TEST(MotionWatch, SaysNothingOfADriveThatOdometryTells) {
  WatchedDrive drive;
  drive.Ahead(7);
  drive.Turn(2 * kQuarter_rad, 1.05);
  drive.Ahead(7, 0.98);
  EXPECT_TRUE(drive.Found().empty());
}

TEST(MotionWatch, SaysWhereOdometryMissesATurn) {
  WatchedDrive drive;
  drive.Ahead(3);
  drive.Turn(kQuarter_rad, 0);
  drive.Turn(-kQuarter_rad, 1);
  const std::vector<Disagreement> found = drive.Found();
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(DegOf(found.front().scans_turn_rad), 90, 25);
  EXPECT_NEAR(DegOf(found.front().odometry_turn_rad), 0, 5);
  EXPECT_NEAR(found.front().from_s, 3 / 0.4, 2);
}

TEST(MotionWatch, SaysWhereOdometryCountsATurnThatIsNone) {
  WatchedDrive drive;
  drive.Ahead(3);
  for (int k = 0; k < 20; ++k) drive.Move({}, {0, 0, kQuarter_rad / 20});
  drive.Ahead(3);
  const std::vector<Disagreement> found = drive.Found();
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(DegOf(found.front().scans_turn_rad), 0, 10);
  EXPECT_NEAR(DegOf(found.front().odometry_turn_rad), 90, 25);
}

TEST(MotionWatch, SaysWhereWheelsTurnInPlaceAndWhereTheRobotIsCarried) {
  for (const auto& [odometry, slips] : {std::pair{1.0, 0.0}, {0.0, 1.0}}) {
    WatchedDrive drive;
    drive.Ahead(4);
    drive.Ahead(3, odometry, slips);
    drive.Ahead(1);
    const std::vector<Disagreement> found = drive.Found();
    ASSERT_FALSE(found.empty()) << odometry;
    double most_m = 0;
    for (const Disagreement& one : found) most_m = std::max(most_m, one.apart_m);
    EXPECT_GT(most_m, 1) << odometry;
    EXPECT_LT(most_m, 4) << odometry;
  }
}

TEST(MotionWatch, SaysWhereTheRecorderWasPausedAndTheRobotDroveOn) {
  for (const bool drives : {false, true}) {
    WatchedDrive drive;
    drive.Ahead(3);
    drive.Read(false);
    for (int k = 0; k < 20; ++k) drive.Move(drives ? Pose{0, 0, kQuarter_rad / 20} : Pose(), {});
    drive.Read(true);
    drive.Ahead(0.5);
    const std::vector<Disagreement> found = drive.Found();
    ASSERT_EQ(found.size(), drives ? 1U : 0U);
    for (const Disagreement& one : found) EXPECT_TRUE(one.hole);
  }
}

// From one end of the corridor to a niche at the other, in no time or while nothing was read for a minute:
// odometry goes on as if nothing had been.
TEST(MotionWatch, SaysWhereTheRobotWasCarriedToAnotherPlace) {
  for (const bool pauses : {false, true}) {
    for (const double carried_m : {0.0, 5.5}) {
      WatchedDrive drive;
      drive.Ahead(3);
      drive.Read(false);
      for (int k = 0; pauses && k < 300; ++k) drive.Move({}, {});
      drive.Read(true);
      drive.Move({carried_m, 0, carried_m > 0 ? -kQuarter_rad : 0}, {});
      drive.Turn(kQuarter_rad / 2, 1);
      const std::vector<Disagreement> found = drive.Found();
      ASSERT_EQ(found.size(), carried_m > 0 ? 1U : 0U) << pauses;
      for (const Disagreement& one : found) {
        EXPECT_TRUE(one.hole);
        EXPECT_NEAR(one.from_s, 3 / 0.4, 1);
      }
    }
  }
}

// It turns away from what it saw, as odometry says, and sees other things.
TEST(MotionWatch, ANarrowLaserThatTurnsIsNotCarried) {
  for (const double sees_rad : {M_PI, kQuarter_rad / 4}) {
    WatchedDrive drive(sees_rad);
    drive.Ahead(3);
    for (int k = 0; k < 2; ++k) {
      drive.Move({0, 0, 0.42 * kQuarter_rad}, {0, 0, 0.42 * kQuarter_rad});
      drive.Ahead(1);
    }
    for (const Disagreement& one : drive.Found()) EXPECT_FALSE(one.hole) << sees_rad;
  }
}

// What it still sees of a wall agrees with another motion, too: odometry is right all the same.
TEST(MotionWatch, ANarrowLaserThatTurnsBearsNoWitnessAgainstOdometry) {
  for (const double sees_deg : {20, 29}) {
    for (const double way_m : {2, 3, 4}) {
      WatchedDrive drive(RadOf(sees_deg));
      drive.Ahead(way_m);
      for (const double turns : {2, -1, 2, 1, -2, -2}) {
        drive.Turn(turns * kQuarter_rad, 1);
        drive.Ahead(0.5);
      }
      EXPECT_TRUE(drive.Found().empty()) << sees_deg << " " << way_m;
    }
  }
}

TEST(MotionWatch, ANarrowLaserSaysWhereOdometryCountsATurnThatIsNone) {
  WatchedDrive drive(RadOf(29));
  drive.Ahead(4);
  for (int k = 0; k < 20; ++k) drive.Move({}, {0, 0, kQuarter_rad / 20});
  const std::vector<Disagreement> found = drive.Found();
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(DegOf(found.front().scans_turn_rad), 0, 10);
  EXPECT_NEAR(DegOf(found.front().odometry_turn_rad), 90, 25);
}

// Of a few rays of a short reach (infra-red), which meet a wall so far apart that most of it lies between
// them: had the robot stood, each would meet what it met before.
TEST(MotionWatch, FewRaysAlongABlankCorridorBearNoWitnessAgainstOdometry) {
  for (const int beams : {30, 36, 60}) {
    for (const double reach_m : {2.0, 3.0, 4.0}) {
      for (const bool exact : {false, true}) {
        for (const double step_m : {0.06, 0.11, 0.2}) {
          WatchedDrive drive(RingBeams(beams, 0.1), reach_m, exact, TestBox(40, 2.3, {14, 0.15, 0}));
          for (double gone_m = 0; gone_m < 16; gone_m += step_m) drive.Move({step_m, 0, 0}, {step_m, 0, 0});
          EXPECT_TRUE(drive.Found().empty())
              << beams << " rays, " << reach_m << " m, " << (exact ? "exact, " : "") << step_m << " m a scan";
        }
      }
    }
  }
}

// Persons stand before the laser for one scan.
TEST(MotionWatch, OneScanThatIsSpoiltIsNotACarriedRobot) {
  WatchedDrive drive;
  drive.Ahead(3);
  drive.Move({3, 0, kQuarter_rad}, {});
  drive.Move({-3, 0, -kQuarter_rad}, {});
  drive.Ahead(2);
  for (const Disagreement& one : drive.Found()) EXPECT_FALSE(one.hole);
}

// Five scans, of each pair of which this was seen where odometry stood still.
struct Told {
  explicit Told(const Pose& seen) {
    for (std::int64_t s = 0; s < 5; ++s) {
      scans.emplace_back().time_s = 0.4 * static_cast<double>(s);
      if (s > 0) found.push_back({0, s - 1, s, seen, {}, false, false});
    }
  }
  std::vector<Contradiction> found;
  std::vector<Scan> scans;
};

// In a path that dead reckoning drew to the side.
TEST(MotionWatch, WaysAreMadeGoodAndSaidAllTheSame) {
  Told told({0.2, 0.1, 0});
  for (Scan& scan : told.scans) scan.pose.heading_rad = kQuarter_rad;
  const auto expect_apart = [&](double path_m) {
    const std::vector<Disagreement> said = Disagreements(told.found, told.scans);
    ASSERT_EQ(said.size(), 1U);
    EXPECT_NEAR(said[0].apart_m, path_m, 1e-9);
    EXPECT_NEAR(said[0].odometry_apart_m, 4 * std::hypot(0.2, 0.1), 1e-9);
  };
  expect_apart(4 * std::hypot(0.2, 0.1));
  MakeWaysGood(told.found, &told.scans);
  for (std::size_t s = 0; s < told.scans.size(); ++s) {
    EXPECT_NEAR(told.scans[s].pose.x_m, -0.1 * static_cast<double>(s), 1e-9);
    EXPECT_NEAR(told.scans[s].pose.y_m, 0.2 * static_cast<double>(s), 1e-9);
    EXPECT_EQ(told.scans[s].slipped, s > 0);
  }
  expect_apart(0);
}

TEST(MotionWatch, AWayThatHarmsNoMapStaysOdometrys) {
  Told told({0.1, 0, 0});
  MakeWaysGood(told.found, &told.scans);
  for (const Scan& scan : told.scans) EXPECT_TRUE(scan.pose.x_m == 0 && !scan.slipped);
}

TEST(MotionWatch, ATurnThatThePathMakesGoodIsSaidAllTheSame) {
  Told told({0, 0, 0.4});
  for (std::size_t s = 0; s < told.scans.size(); ++s)
    told.scans[s].pose.heading_rad = 0.4 * static_cast<double>(s);
  const std::vector<Disagreement> said = Disagreements(told.found, told.scans);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_NEAR(said[0].scans_turn_rad, 1.6, 1e-9);
  EXPECT_NEAR(said[0].path_turn_rad, 1.6, 1e-9);
  EXPECT_NEAR(said[0].odometry_turn_rad, 0, 1e-9);
}

TEST(MotionWatch, AHoleWhoseSidesMeetWhereThePathHasThemIsNone) {
  for (const bool follows : {false, true}) {
    Told told({0, 0, 0.4});
    told.found.assign(1, {0, 1, 2, {0.2, 0, 0.8}, {}, true, true});
    for (std::size_t s = 2; follows && s < told.scans.size(); ++s) told.scans[s].pose = {0.2, 0, 0.8};
    EXPECT_EQ(Disagreements(told.found, told.scans).size(), follows ? 0U : 1U);
    EXPECT_TRUE(MissedTurns(told.found, told.scans).empty());
  }
}

TEST(MotionWatch, TwoScansAloneAreNotBelieved) {
  Told told({0, 0, 1});
  told.found.resize(1);
  EXPECT_TRUE(Disagreements(told.found, told.scans).empty());
  EXPECT_TRUE(MissedTurns(told.found, told.scans).empty());
}

TEST(MotionWatch, MissedTurnsAreSummedOverTheScans) {
  Told told({0, 0, 0.4});
  const std::vector<double> missed = MissedTurns(told.found, told.scans);
  ASSERT_EQ(missed.size(), 5U);
  for (std::size_t s = 0; s < 5; ++s) EXPECT_NEAR(missed[s], 0.4 * static_cast<double>(s), 1e-9) << s;
  EXPECT_TRUE(MissedTurns(Told({0.5, 0, 0}).found, told.scans).empty());
}

TEST(MotionWatch, WithoutALaserSeesNothing) {
  MotionWatch watch({{RingBeams(), kTestOpeningRad, 6}});
  Rng rng(1);
  const std::vector<double> ranges = SonarScan(NichedCorridor(), {}, 0, rng);
  const RingScan scan{0, 0, ranges};
  for (std::int64_t s = 0; s < 9; ++s) watch.Update(s, static_cast<double>(s), {}, false, {&scan, 1}, true);
  EXPECT_TRUE(watch.found().empty());
}

}  // namespace
}  // namespace cairn::local_map
