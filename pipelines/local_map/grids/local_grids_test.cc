#include "pipelines/local_map/grids/local_grids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "pipelines/local_map/testing/room.h"
#include "schema/allocations_testing.h"
#include "schema/error.h"

namespace cairn::local_map {
namespace {

LocalGrids Sonars(const GridOptions& options = {}) {
  return {options, {SensorRing(RingBeams(), kTestOpeningRad, 6)}};
}

// How well the walls' direction is known once locked: where no direction is dominant, the last one holds.
struct Judged {
  int scans = 0, right = 0, locks = 0, realigned = 0, other = 0, back = 0;
  std::optional<double> told;

  // Takes the scan's result, with the walls' true direction in the odometric frame.
  void Take(const LocalGrids& grids, Alignment event, double true_rad) {
    locks += event == Alignment::kLocked;
    realigned += event == Alignment::kRealigned;
    other += event == Alignment::kOtherArea;
    back += event == Alignment::kBack;
    if (grids.walls_rad()) told = grids.walls_rad()->angle_rad;
    if (!grids.locked()) return;
    ++scans;
    right += std::abs(DegOf(ModuloAngle(*told - true_rad, WallOrientation::kPeriodRad))) < 2;
  }
};

Judged DriveRooms(const GridOptions& options, std::uint64_t first, std::uint64_t last, int scans) {
  Judged judged;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const TestRoom room(seed);
    TestDrive drive(room, seed);
    LocalGrids grids = Sonars(options);
    judged.told.reset();
    for (int k = 0; k < scans; ++k) {
      const RingScan scan = drive.Next();
      const Alignment event = grids.Update(drive.odometry(), std::span(&scan, 1));
      judged.Take(grids, event, room.turned_rad + drive.TurnedRad());
    }
  }
  return judged;
}

// The parameters were chosen on rooms 1 to 50.
TEST(LocalGrids, KnowTheWallsOfFiftyRoomsToTwoDegrees) {
  const Judged judged = DriveRooms({}, 101, 150, 1500);
  EXPECT_EQ(judged.locks, 50);
  EXPECT_GT(judged.scans, 50 * 1400);
  EXPECT_GE(judged.right, 0.95 * judged.scans);
  RecordProperty("share_under_2_deg", std::to_string(static_cast<double>(judged.right) / judged.scans));
}

// [DM98] section 2.2: the same results, in quality, with cells of any size; the grids reach equally far.
TEST(LocalGrids, CellsOfAnySizeTellTheSame) {
  struct Cells {
    double cell_m;
    int half;
  };
  for (const Cells cells : {Cells{0.07, 33}, {0.15, 15}, {0.3, 8}, {0.6, 4}}) {
    GridOptions options;
    options.cell_m = cells.cell_m;
    options.half_cells = cells.half;
    const Judged judged = DriveRooms(options, 101, 110, 1000);
    EXPECT_EQ(judged.locks, 10) << cells.cell_m;
    EXPECT_GE(judged.right, 0.9 * judged.scans) << cells.cell_m;
  }
}

// A corridor 2 m wide along x, a piece of it at 30 degrees, and along x again, by way of `drift` a metre.
struct Bent {
  static constexpr double kStretchM = 12, kBendRad = 0.5236;
  std::vector<TestWall> walls;
  Pose truth, odometry;
  double drift_rad_per_m;
  int steps = 0;
  Rng rng{9};
  std::vector<double> ranges;

  explicit Bent(double bend_rad, double drift) : drift_rad_per_m(drift) {
    std::vector<Pose> axis{{-1, 0, 0}, {kStretchM, 0, bend_rad}};
    axis.push_back(Compose(axis[1], {kStretchM, 0, -bend_rad}));
    axis.push_back(Compose(axis[2], {kStretchM, 0, 0}));
    for (const double side_m : {-1.0, 1.0}) {
      for (std::size_t k = 0; k + 1 < axis.size(); ++k) {
        const auto beside = [&](std::size_t at) {  // where both stretches' walls meet
          const double half = at == 1 ? bend_rad / 2 : at == 2 ? -bend_rad / 2 : 0;
          const double travelled = at == 1 ? half : at == 2 ? bend_rad + half : 0;
          const double across = side_m / std::cos(half);
          return Point{axis[at].x_m - across * std::sin(travelled),
                       axis[at].y_m + across * std::cos(travelled)};
        };
        walls.push_back({beside(k), beside(k + 1)});
      }
    }
  }

  bool Done() const { return steps * 0.08 > 3 * kStretchM - 1; }
  // The direction of the stretch that the robot is in.
  double WallsRad() const {
    const double travelled = steps * 0.08;
    return travelled > kStretchM && travelled < 2 * kStretchM ? truth_bend() : 0;
  }
  double truth_bend() const {
    return std::atan2(walls[1].b.y_m - walls[1].a.y_m, walls[1].b.x_m - walls[1].a.x_m);
  }
  RingScan Next() {
    const double before = WallsRad();
    ++steps;
    const double turn = WallsRad() - before;
    truth = Compose(Compose(truth, {0, 0, turn}), {0.08, 0, 0});
    odometry = Compose(Compose(odometry, {0, 0, turn + 0.08 * drift_rad_per_m}), {0.08, 0, 0});
    const double turret = 0.7 * std::sin(0.15 * steps);
    ranges = SonarScan(walls, truth, turret, rng);
    return {0.2 * steps, turret, ranges};
  }
};

TEST(LocalGrids, AnAreaThatIsOrientedDifferentlyIsRecognisedAndNotCorrected) {
  Bent world(Bent::kBendRad, 0);
  LocalGrids grids = Sonars();
  Judged judged;
  int in_bend = 0, flagged = 0, flagged_else = 0;
  double frame_rad = 0;
  while (!world.Done()) {
    const RingScan scan = world.Next();
    judged.Take(grids, grids.Update(world.odometry, std::span(&scan, 1)), world.WallsRad());
    if (judged.locks == 1 && frame_rad == 0) frame_rad = grids.frame_rad();
    const double into_m = std::fmod(world.steps * 0.08, Bent::kStretchM);  // judged well inside a stretch
    if (into_m < 5 || into_m > 10) continue;
    (world.WallsRad() > 0.1 ? in_bend : flagged_else) += world.WallsRad() > 0.1 || grids.other_area();
    flagged += world.WallsRad() > 0.1 && grids.other_area();
  }
  EXPECT_GT(in_bend, 50);
  EXPECT_EQ(flagged, in_bend);
  EXPECT_EQ(flagged_else, 0);
  EXPECT_EQ(judged.other, 1);
  EXPECT_EQ(judged.back, 1);
  EXPECT_EQ(judged.realigned, 0);
  EXPECT_EQ(grids.frame_rad(), frame_rad);  // the old orientation holds again
}

TEST(LocalGrids, DriftIsDetectedAndFollowedInStepsOfFiveAndAHalfDegreesAndMore) {
  Bent world(0, RadOf(0.5));  // 17.5 degrees in all
  LocalGrids grids = Sonars();
  Judged judged;
  double worst = 0;
  while (!world.Done()) {
    const RingScan scan = world.Next();
    const double before = DegOf(grids.frame_rad());
    const Alignment event = grids.Update(world.odometry, std::span(&scan, 1));
    const double drifted = world.odometry.heading_rad - world.truth.heading_rad;
    judged.Take(grids, event, drifted);
    const double turned = DegOf(grids.frame_rad()) - before;
    EXPECT_NEAR(turned, DegOf(grids.turned_rad()), 1e-9);
    if (event == Alignment::kRealigned) {
      EXPECT_GE(std::abs(turned), LocalGrids::kMinRealignDeg);
      EXPECT_LE(std::abs(turned), LocalGrids::kMaxRealignDeg);
    } else if (event != Alignment::kLocked) {
      EXPECT_EQ(turned, 0);
    }
    if (grids.locked()) worst = std::max(worst, std::abs(DegOf(drifted - grids.frame_rad())));
  }
  EXPECT_GE(judged.realigned, 2);
  EXPECT_LE(judged.realigned, 3);
  EXPECT_EQ(judged.other, 0);
  // Drift goes on at 0.2 degrees a second while it lasts out its 5 s and while the histogram, whose memory is
  // 1 / (1 - kept) scans of 0.2 s, lags behind; half a degree for the noise of its peak.
  const double memory_s = 0.2 / (1 - GridOptions{}.walls_kept);
  EXPECT_LT(worst, LocalGrids::kMinRealignDeg + 0.2 * (5 + memory_s) + 0.5);
  EXPECT_GE(judged.right, 0.95 * judged.scans);
}

// The pose stays where it is when the frame is turned, and what the grids hold turns about it.
TEST(LocalGrids, AlignmentTurnsTheContentsAboutTheRobot) {
  const double turned = RadOf(30);
  TestDrive drive(TestBox(5, 5, {0, 0, turned}), {0.3, -0.4, 0.2}, 0.4, 0.4, 3);
  LocalGrids grids = Sonars();
  int locked = 0;
  for (int k = 0; k < 100 && locked == 0; ++k) {
    const RingScan scan = drive.Next();
    const Pose before = Between(grids.frame(), drive.odometry());
    locked += grids.Update(drive.odometry(), std::span(&scan, 1)) == Alignment::kLocked;
    EXPECT_LT(std::hypot(grids.pose().x_m - before.x_m, grids.pose().y_m - before.y_m), 1e-9);
    const Pose again = Compose(grids.frame(), grids.pose());
    EXPECT_NEAR(again.x_m, drive.odometry().x_m, 1e-9);
    EXPECT_NEAR(again.heading_rad, drive.odometry().heading_rad, 1e-9);
  }
  ASSERT_EQ(locked, 1);
  ASSERT_FALSE(grids.current_edges().empty());
  for (const Edge& edge : grids.current_edges())
    EXPECT_LT(std::abs(DegOf(ModuloAngle(edge.angle_rad, WallOrientation::kPeriodRad))), 6);
}

// An open door: once the wall was seen, its direction stays in cells that nothing hits any more.
TEST(LocalGrids, AnOpenDoorKeepsItsWallsOrientation) {
  std::vector<TestWall> closed = TestBox(8, 2.4, {}), open = closed;
  open[2] = {{4, 1.2}, {0.7, 1.2}};  // the wall at y = 1.2, without a door of 1.4 m
  open.push_back({{-0.7, 1.2}, {-4, 1.2}});
  GridOptions options;
  options.align = false;
  LocalGrids grids = Sonars(options);
  Rng rng(5);
  for (int k = 0; k < 120; ++k) {
    const Pose robot{-1.2 + 0.02 * k, 0, 0};
    const double turret = 0.7 * std::sin(0.15 * k);
    const auto ranges = SonarScan(k < 50 ? closed : open, robot, turret, rng);
    const RingScan scan{0.2 * k, turret, ranges};
    grids.Update(robot, std::span(&scan, 1));
  }
  int cells = 0;
  for (int i = CellOf(-0.3, 0.15); i <= CellOf(0.3, 0.15); ++i) {
    for (int j = CellOf(1.2, 0.15) - 1; j <= CellOf(1.2, 0.15) + 1; ++j) {
      EXPECT_FALSE(grids.occupancy().Occupied(i, j));
      const auto edge = grids.edges().Dominant(i, j);
      if (!edge) continue;
      ++cells;
      EXPECT_LT(std::abs(DegOf(edge->angle_rad)), 8);
    }
  }
  EXPECT_GE(cells, 5);
}

TEST(LocalGrids, InfraredStandsBesideSonar) {
  const auto walls = TestBox(1.6, 1.6, {});
  LocalGrids grids({}, {SensorRing(RingBeams(), kTestOpeningRad, 6), SensorRing(RingBeams(16), 0, 0.8)});
  Rng rng(1);
  for (int k = 0; k < 10; ++k) {
    const std::vector<double> sonar(24, std::nan(""));
    std::vector<double> infrared;
    for (const Pose& beam : RingBeams(16)) infrared.push_back(InConeM(walls, beam, 1e-6));
    const RingScan scans[] = {{0.2 * k, 0, sonar}, {0.2 * k, 0, infrared}};
    grids.Update({}, scans);
    EXPECT_GE(grids.hits().size(), 12U);
    const RingScan none[] = {{0.2 * k, 0, {}}, {0.2 * k, 0, {}}};
    grids.Update({}, none);
    EXPECT_TRUE(grids.hits().empty());
  }
  EXPECT_GT(grids.occupancy().Frequency(CellOf(0.8, 0.15), 0), 0.08);
}

TEST(LocalGrids, MissingSensorsDoNoHarm) {
  const TestRoom room(101);
  TestDrive drive(room, 101);
  LocalGrids grids = Sonars();
  Judged judged;
  for (int k = 0; k < 1000; ++k) {
    RingScan scan = drive.Next();
    std::vector<double> ranges(scan.range_m.begin(), scan.range_m.end());
    for (std::size_t b = 0; b < ranges.size(); b += 5) ranges[b] = std::nan("");
    if (k % 7 == 0) ranges.assign(24, std::nan(""));
    scan.range_m = ranges;
    judged.Take(grids, grids.Update(drive.odometry(), std::span(&scan, 1)),
                room.turned_rad + drive.TurnedRad());
  }
  EXPECT_GT(judged.scans, 800);
  EXPECT_GE(judged.right, 0.9 * judged.scans);
}

TEST(LocalGrids, AllocateNothingOnceTheyAreMade) {
  const TestRoom room(102);
  TestDrive drive(room, 102);
  LocalGrids grids = Sonars();
  long in_updates = 0;
  int turned = 0;
  const long before = Allocations();
  for (int k = 0; k < 1500; ++k) {
    const RingScan scan = drive.Next();
    const long at = Allocations();
    grids.Update(drive.odometry(), std::span(&scan, 1));
    in_updates += Allocations() - at;
    turned += grids.turned_rad() != 0;
  }
  EXPECT_EQ(in_updates, 0);
  EXPECT_GT(Allocations(), before + 1500);  // the drive's: they are counted
  EXPECT_GT(turned, 0);
}

TEST(LocalGrids, BadInputIsNamed) {
  LocalGrids grids = Sonars();
  const std::vector<double> ranges(24, 1.0), few(3, 1.0);
  RingScan scan{0, 0, ranges};
  EXPECT_THROW(grids.Update({std::nan(""), 0, 0}, std::span(&scan, 1)), InputError);
  EXPECT_THROW(grids.Update({1e9, 0, 0}, std::span(&scan, 1)), InputError);
  EXPECT_THROW(grids.Update({0, 0, 0}, {}), InputError);
  scan.turret_rad = INFINITY;
  EXPECT_THROW(grids.Update({0, 0, 0}, std::span(&scan, 1)), InputError);
  scan = {0, 0, few};
  EXPECT_THROW(grids.Update({0, 0, 0}, std::span(&scan, 1)), InputError);
  scan = {0, 0, ranges};
  EXPECT_EQ(grids.Update({0, 0, 0}, std::span(&scan, 1)), Alignment::kNone);
  EXPECT_EQ(grids.hits().size(), 24U);
}

}  // namespace
}  // namespace cairn::local_map
