#include "datasets/common/motion_doubts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/simulate/office/office.h"
#include "schema/rng.h"

namespace cairn::datasets {
namespace {

kinds::Log Office(std::uint64_t seed) {
  return Read<kinds::Log>(SimulateOffice({.minutes = 4, .seed = seed}));
}

// `change` of each of the values.
template <class F>
std::vector<double> Each(const Column<double>& column, const F& change) {
  std::vector<double> values;
  for (const double value : column) values.push_back(change(value));
  return values;
}

std::string All(const std::vector<std::string>& doubts) {
  std::string text;
  for (const std::string& doubt : doubts) text += doubt + "\n";
  return text;
}

TEST(MotionDoubts, ThereAreNoneOfLogsThatAreRight) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
    EXPECT_EQ(All(FindMotionDoubts(Office(seed))), "") << "office " << seed;
}

struct Mistaken {
  const char* name;
  void (*make)(kinds::Log::Robot* robot);
  const char* says;
};

class MotionDoubt : public testing::TestWithParam<Mistaken> {};

TEST_P(MotionDoubt, IsRaisedOfEachMistakeOnEachSeed) {
  for (std::uint64_t seed = 11; seed <= 14; ++seed) {
    kinds::Log log = Office(seed);
    GetParam().make(&log.robot[0]);
    const std::string doubts = All(FindMotionDoubts(log));
    EXPECT_NE(doubts.find(GetParam().says), std::string::npos) << "seed " << seed << ": " << doubts;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, MotionDoubt,
    testing::Values(
        Mistaken{"turns", [](auto* r) { r->odometry.turn_rad = Each(r->odometry.turn_rad, std::negate()); },
                 "are turns, or the directions in which it sees, clockwise?"},
        Mistaken{"backwards",
                 [](auto* r) { r->odometry.forward_m = Each(r->odometry.forward_m, std::negate()); },
                 "is forward negative"},
        Mistaken{"feet",
                 [](auto* r) {
                   r->odometry.forward_m = Each(r->odometry.forward_m, [](double d) { return d * 0.7; });
                 },
                 "1.4 times what odometry says"},
        Mistaken{"a_fifth",
                 [](auto* r) {
                   r->odometry.forward_m = Each(r->odometry.forward_m, [](double d) { return d * 1.2; });
                 },
                 "0.8 of what odometry says"},
        Mistaken{"metres_called_feet",
                 [](auto* r) {
                   r->odometry.forward_m = Each(r->odometry.forward_m, [](double d) { return d * 0.3048; });
                 },
                 "is the sensor in feet?"},
        Mistaken{"twice",
                 [](auto* r) {
                   r->odometry.forward_m = Each(r->odometry.forward_m, [](double d) { return d * 2; });
                 },
                 "by half of what odometry says"},
        Mistaken{"clock",
                 [](auto* r) {
                   for (auto& s : r->sensors) s.time_s = Each(s.time_s, [](double t) { return t + 2; });
                 },
                 " s earlier better: do both have the same clock?"}),
    [](const auto& test) { return std::string(test.param.name); });

kinds::Log OfOneRobot(const kinds::Log::Robot& robot) {
  kinds::Log log;
  log.robots = std::vector<std::string>{"anna"};
  log.robot = {robot};
  return log;
}

// A robot on a circle among four poles, which sees each that is ahead of it twice a second; bearings count
// `sees` times, and from `mount_rad` on.
kinds::Log Circle(bool named, double sees, double mount_rad = 0) {
  constexpr double kTurn_rad = 0.05, kForward_m = 0.1, kReach_m = 6;
  const std::vector<Point> poles = {{3, 1}, {-2, 4}, {0, -3}, {-4, -1}};
  kinds::Log::Robot robot;
  std::vector<double> time_s, turn_rad, forward_m, seen_s, range_m, bearing_rad;
  std::vector<std::int32_t> landmark;
  Pose pose;
  for (int i = 0; i < 600; ++i) {
    pose = Compose(Compose(pose, {0, 0, kTurn_rad}), {kForward_m, 0, 0});
    time_s.push_back(0.25 * i);
    turn_rad.push_back(kTurn_rad);
    forward_m.push_back(kForward_m);
    for (std::size_t k = 0; k < poles.size() && i % 2 == 0; ++k) {
      const Pose seen = Between(pose, {poles[k].x_m, poles[k].y_m, 0});
      if (seen.x_m <= 0 || std::hypot(seen.x_m, seen.y_m) > kReach_m) continue;
      seen_s.push_back(time_s.back());
      range_m.push_back(std::hypot(seen.x_m, seen.y_m));
      bearing_rad.push_back(WrapAngle(sees * std::atan2(seen.y_m, seen.x_m) - mount_rad));
      landmark.push_back(named ? static_cast<std::int32_t>(k) : -1);
    }
  }
  robot.odometry = {time_s, turn_rad, forward_m};
  robot.observations = {seen_s, range_m, bearing_rad, landmark, std::vector<std::int32_t>(seen_s.size(), -1)};
  return OfOneRobot(robot);
}

TEST(MotionDoubts, BearingsThatAreMirroredShowWithNamesAndWithout) {
  for (const bool named : {true, false}) {
    EXPECT_EQ(All(FindMotionDoubts(Circle(named, 1))), "");
    const std::string doubts = All(FindMotionDoubts(Circle(named, -1)));
    EXPECT_NE(doubts.find("directions in which it sees, clockwise?"), std::string::npos) << doubts;
  }
}

TEST(MotionDoubts, BearingsThatCountFromElsewhereShowWithNamesAndWithout) {
  for (const bool named : {true, false})
    for (const int degrees : {180, 90, -90}) {
      const std::string doubts = All(FindMotionDoubts(Circle(named, 1, degrees * std::numbers::pi / 180)));
      EXPECT_NE(doubts.find("--sensor-mount=0,0," + std::to_string(degrees)), std::string::npos) << doubts;
    }
}

// A robot on a circle of 4 m, a little off the middle of a round room of 6 m, with a ring of 36 beams.
kinds::Log RoundRoom() {
  constexpr double kRoom_m = 6, kStep_m = 0.1, kCircle_m = 4;
  constexpr int kBeams = 36;
  kinds::Log::Robot robot;
  kinds::Log::RangeSensor ring;
  std::vector<double> time_s, turn_rad, forward_m, range_m;
  std::vector<double> headings;
  for (int b = 0; b < kBeams; ++b) headings.push_back(2 * std::numbers::pi * b / kBeams);
  ring.beam_heading_rad = headings;
  ring.beam_x_m = ring.beam_y_m = std::vector<double>(kBeams, 0.0);
  Pose pose{0.5, -kCircle_m, 0};
  for (int i = 0; i < 1500; ++i) {
    pose = Compose(Compose(pose, {0, 0, kStep_m / kCircle_m}), {kStep_m, 0, 0});
    time_s.push_back(0.2 * i);
    turn_rad.push_back(kStep_m / kCircle_m);
    forward_m.push_back(kStep_m);
    for (int b = 0; b < kBeams; ++b) {
      const double heading = pose.heading_rad + 2 * std::numbers::pi * b / kBeams;
      const double along = pose.x_m * std::cos(heading) + pose.y_m * std::sin(heading);
      range_m.push_back(
          -along + std::sqrt(along * along + kRoom_m * kRoom_m - pose.x_m * pose.x_m - pose.y_m * pose.y_m));
    }
  }
  ring.time_s = time_s;
  ring.range_m = range_m;
  robot.odometry = {time_s, turn_rad, forward_m};
  robot.sensors.push_back(ring);
  return OfOneRobot(robot);
}

TEST(MotionDoubts, AlongACurveWhatIsAheadNeedNotComeNearer) {
  EXPECT_EQ(All(FindMotionDoubts(RoundRoom())), "");
}

// In bends to either side, by odometry whose heading drifts, among a lattice of poles.
kinds::Log Slalom(double drift_rad_per_m, double delay_s, double noise_rad_per_sqrt_m, std::uint64_t seed) {
  constexpr double kReach_m = 8, kStep_s = 0.1, kStep_m = 0.1;
  Rng rng(seed);
  kinds::Log::Robot robot;
  std::vector<double> time_s, turn_rad, forward_m, seen_s, range_m, bearing_rad;
  std::vector<std::int32_t> landmark;
  Pose pose;
  for (int i = 0; i < 2000; ++i) {
    const double turn = 0.06 * std::sin(0.02 * i) + 0.02 * std::sin(0.007 * i);
    pose = Compose(Compose(pose, {0, 0, turn}), {kStep_m, 0, 0});
    time_s.push_back(kStep_s * i);
    turn_rad.push_back(turn + drift_rad_per_m * kStep_m +
                       noise_rad_per_sqrt_m * std::sqrt(kStep_m) * rng.Normal());
    forward_m.push_back(kStep_m);
    if (i % 10 != 0) continue;
    for (int x = -20; x <= 20; ++x) {
      for (int y = -20; y <= 20; ++y) {
        const Pose seen = Between(pose, {7.0 * x, 7.0 * y, 0});
        if (seen.x_m <= 0 || std::hypot(seen.x_m, seen.y_m) > kReach_m) continue;
        seen_s.push_back(time_s.back() + delay_s);
        range_m.push_back(std::hypot(seen.x_m, seen.y_m) + 0.1 * rng.Normal());
        bearing_rad.push_back(std::atan2(seen.y_m, seen.x_m) + 0.02 * rng.Normal());
        landmark.push_back(41 * x + y + 1000);
      }
    }
  }
  robot.odometry = {time_s, turn_rad, forward_m};
  robot.observations = {seen_s, range_m, bearing_rad, landmark, std::vector<std::int32_t>(seen_s.size(), -1)};
  return OfOneRobot(robot);
}

// A drift of 1.5 or 2.5 degrees a metre is neither taken for another clock, nor hides one.
TEST(MotionDoubts, AStrongDriftIsToldFromAnotherClock) {
  for (const double drift : {-2.5, -1.5, 0.0, 1.5, 2.5}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const double drift_rad_per_m = drift * std::numbers::pi / 180;
      EXPECT_EQ(All(FindMotionDoubts(Slalom(drift_rad_per_m, 0, 0.01, seed))), "") << drift << ' ' << seed;
      for (const double delay_s : {-1.0, 1.0}) {
        const std::string doubts = All(FindMotionDoubts(Slalom(drift_rad_per_m, delay_s, 0.01, seed)));
        EXPECT_NE(doubts.find("do both have the same clock?"), std::string::npos)
            << drift << ' ' << delay_s << ' ' << seed;
      }
    }
  }
}

// Of a robot one wheel of which is a tenth larger than the other. It hides no mirror.
TEST(MotionDoubts, AVeryStrongDriftIsToldFromTurnsTheWrongWay) {
  for (const double drift : {-20.0, -13.0, 13.0, 20.0}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      kinds::Log log = Slalom(drift * std::numbers::pi / 180, 0, 0.01, seed);
      EXPECT_EQ(All(FindMotionDoubts(log)), "") << drift << ' ' << seed;
      log = Slalom(0, 0, 0.01, seed);
      log.robot[0].observations.bearing_rad = Each(log.robot[0].observations.bearing_rad, std::negate());
      EXPECT_NE(All(FindMotionDoubts(log)).find("clockwise?"), std::string::npos) << seed;
    }
  }
}

// The number before " s earlier"; none is said: 0.
double EarlierByS(const std::string& doubts) {
  const std::size_t end = doubts.find(" s earlier");
  return end == std::string::npos ? 0 : std::stod(doubts.substr(doubts.rfind(' ', end - 1) + 1));
}

// By how much is said, and only of observations that an import of a CSV can take it off.
TEST(MotionDoubts, OfAnotherClockItIsSaidByHowMuch) {
  for (const double late_s : {1.35, 2.0}) {
    for (std::uint64_t seed = 11; seed <= 14; ++seed) {
      kinds::Log log = Office(seed);
      for (auto& sensor : log.robot[0].sensors)
        sensor.time_s = Each(sensor.time_s, [&](double t) { return t + late_s; });
      const std::string scans = All(FindMotionDoubts(log));
      EXPECT_NEAR(EarlierByS(scans), late_s, 0.1) << scans;
      EXPECT_NE(scans.find(" off the times of the scans"), std::string::npos) << scans;
      EXPECT_EQ(scans.find("CSV"), std::string::npos) << scans;
    }
  }
  const std::string seen = All(FindMotionDoubts(Slalom(0, 0.7, 0.01, 1)));
  EXPECT_EQ(EarlierByS(seen), 0.7) << seen;
  EXPECT_NE(seen.find("`--sensor-late-s=0.7` takes that off a CSV"), std::string::npos) << seen;
}

// Of each `every` rows of odometry one, which goes where they went.
kinds::Log Coarse(kinds::Log log, std::size_t every) {
  kinds::Log::Odometry& odometry = log.robot[0].odometry;
  std::vector<double> time_s, turn_rad, forward_m;
  for (std::size_t i = 0; i < odometry.time_s.size(); ++i) {
    if (i % every == 0) {
      turn_rad.push_back(0);
      forward_m.push_back(0);
      time_s.push_back(0);
    }
    time_s.back() = odometry.time_s[i];
    turn_rad.back() += odometry.turn_rad[i];
    forward_m.back() += odometry.forward_m[i];
  }
  odometry = {time_s, turn_rad, forward_m};
  return log;
}

// A second that is less than a row of odometry is no clock's.
TEST(MotionDoubts, OdometryOfFewRowsIsNoOtherClock) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    EXPECT_EQ(All(FindMotionDoubts(Coarse(Slalom(0, 1, 0.01, seed), 50))), "") << seed;
    EXPECT_NE(All(FindMotionDoubts(Slalom(0, 1, 0.01, seed))), "") << seed;
  }
}

TEST(MotionDoubts, OfTablesThatDoNotFitThereIsNothingToSay) {
  kinds::Log log = Office(1);
  log.robot[0].odometry.turn_rad = std::vector<double>{1.0};
  EXPECT_EQ(All(FindMotionDoubts(log)), "");
  EXPECT_EQ(All(FindMotionDoubts(kinds::Log())), "");
}

}  // namespace
}  // namespace cairn::datasets
