#include "datasets/verdicts/local_map_verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "schema/kinds/local_map.h"

namespace cairn::datasets {
namespace {

// Of one robot's trace: loops from the first time to the second.
Blob LocalMapOf(const std::vector<std::pair<double, double>>& loops, std::size_t contradicted = 0) {
  kinds::LocalMap map;
  map.robots = std::vector<std::string>{"robot"};
  map.robot.resize(1);
  map.traces.robot = std::vector<std::int32_t>{0};
  std::vector<std::int32_t> trace(loops.size(), 0), kind(loops.size(), 2);
  std::vector<double> from_s, to_s;
  std::vector<std::uint8_t> used(loops.size(), 1);
  for (const auto& [from, to] : loops) {
    from_s.push_back(from);
    to_s.push_back(to);
  }
  for (std::size_t i = 0; i < contradicted; ++i) used[i] = 0;
  map.connections.from = map.connections.to = trace;
  map.connections.kind = kind;
  map.connections.from_s = from_s;
  map.connections.to_s = to_s;
  map.connections.used = used;
  return BlobOf(map);
}

std::vector<std::pair<double, double>> Loops(int count, double from_s, double to_s) {
  std::vector<std::pair<double, double>> loops;
  for (int i = 0; i < count; ++i) loops.emplace_back(from_s, to_s);
  return loops;
}

TEST(LocalMapVerdict, ManyLoopsThatAgreeAreTrusted) {
  EXPECT_EQ(LocalMapVerdict(LocalMapOf(Loops(20, 1, 9))).Text(), "high: the path closes all of 20 loops");
  EXPECT_EQ(LocalMapVerdict(LocalMapOf(Loops(19, 9, 1))).trust, Confidence::kFair);
  EXPECT_EQ(LocalMapVerdict(LocalMapOf(Loops(4, 1, 9))).trust, Confidence::kLow);
  EXPECT_EQ(LocalMapVerdict(LocalMapOf(Loops(100, 1, 9), 2)).trust, Confidence::kHigh);
  EXPECT_EQ(LocalMapVerdict(LocalMapOf(Loops(100, 1, 9), 3)).trust, Confidence::kFair);
  EXPECT_EQ(LocalMapVerdict(LocalMapOf(Loops(100, 1, 9), 21)).Text(),
            "low: 21 of 100 loops contradict the path");
}

TEST(LocalMapVerdict, AMetreOfOdometryThatTheScansContradictIsSaid) {
  const auto of = [](const std::vector<double>& scale) {
    auto map = Read<kinds::LocalMap>(LocalMapOf(Loops(20, 1, 9)));
    map.robot.resize(1);
    map.robot[0].metre = {std::vector<double>(scale.size(), 1), scale};
    return LocalMapVerdict(BlobOf(map));
  };
  EXPECT_EQ(of({}).trust, Confidence::kHigh);
  EXPECT_EQ(
      of({0.8}).Text(),
      "fair: the path closes all of 20 loops; what odometry calls a metre is 0.80 m by the scans: are both "
      "in metres and calibrated? The map has the scale of the scans");
  EXPECT_EQ(of({0.95}).trust, Confidence::kHigh);
  EXPECT_EQ(of({0.3048}).trust, Confidence::kLow);
  EXPECT_EQ(of({0.97, 1.03}).trust, Confidence::kFair);
  EXPECT_NE(of({0.97, 1.03}).why.find("0.97 to 1.03 m by the scans: its scale drifts"), std::string::npos);
}

Verdict OfLasers(std::int64_t looked, double share, std::int64_t moved_looked, double moved_share,
                 double moved_m, double moved_rad) {
  auto map = Read<kinds::LocalMap>(LocalMapOf(Loops(20, 1, 9)));
  kinds::LocalMap::Lasers& lasers = map.robot[0].lasers;
  lasers.first = std::vector<std::string>{"laser"};
  lasers.second = std::vector<std::string>{"laser2"};
  lasers.looked = std::vector<std::int64_t>{looked};
  lasers.share = std::vector<double>{share};
  lasers.moved_looked = std::vector<std::int64_t>{moved_looked};
  lasers.moved_share = std::vector<double>{moved_share};
  lasers.moved_m = std::vector<double>{moved_m};
  lasers.moved_rad = std::vector<double>{moved_rad};
  return LocalMapVerdict(BlobOf(map));
}

TEST(LocalMapVerdict, LasersThatSeeWallsInDifferentPlacesAreNamed) {
  EXPECT_EQ(
      OfLasers(2000, 0.5, 3000, 0.96, 0.62, 0.19).Text(),
      "low: the path closes all of 20 loops; 'laser' and 'laser2' see walls in different places, about "
      "0.6 m and 11 degrees apart: 50% of what the second meets stands where the first met something, and "
      "96% would if one of them sat elsewhere. Is a mount wrong? Cairn has it from the log, of a bag from "
      "tf or `--mount`");
  EXPECT_EQ(OfLasers(2000, 0.98, 2000, 0.98, 0, 0).trust, Confidence::kHigh);
  EXPECT_EQ(OfLasers(2000, 0.5, 2000, 0.55, 0.6, 0.2).trust, Confidence::kHigh) << "no mount explains it";
  EXPECT_EQ(OfLasers(2447, 0.106, 2162, 0.75, 0.38, 0).trust, Confidence::kHigh)
      << "nor this: before each wall stands something that is too low for one of them";
  EXPECT_EQ(OfLasers(2000, 0.7, 2000, 0.9, 0.1, 0.02).trust, Confidence::kHigh) << "too little to matter";
  EXPECT_EQ(OfLasers(317, 0.498, 517, 0.979, 0.5, 0).trust, Confidence::kHigh) << "of too few";
  EXPECT_EQ(OfLasers(800, 0.5, 3000, 0.98, 0.4, 3).trust, Confidence::kHigh)
      << "they look elsewhere, and walls are alike";
  EXPECT_EQ(OfLasers(1648, 0.859, 3029, 0.994, 0.28, 0).trust, Confidence::kLow)
      << "half of what stands too far off is behind walls";
}

TEST(LocalMapVerdict, ATimeThatFewLoopsGoOverIsNamed) {
  auto loops = Loops(30, 1, 50);
  const auto later = Loops(30, 60, 100);
  loops.insert(loops.end(), later.begin(), later.end());
  const Verdict untied = LocalMapVerdict(LocalMapOf(loops));
  EXPECT_EQ(untied.trust, Confidence::kLow);
  EXPECT_NE(untied.why.find("what comes after 50 s hangs on 0 of them"), std::string::npos) << untied.why;
  for (int i = 0; i < 5; ++i) loops.emplace_back(100, 1);
  EXPECT_EQ(LocalMapVerdict(LocalMapOf(loops)).trust, Confidence::kFair);
  for (int i = 0; i < 15; ++i) loops.emplace_back(40, 61);
  EXPECT_EQ(LocalMapVerdict(LocalMapOf(loops)).trust, Confidence::kHigh);
  // Those that the others contradict tie nothing.
  std::ranges::rotate(loops, loops.end() - 20);
  EXPECT_EQ(LocalMapVerdict(LocalMapOf(loops, 1)).trust, Confidence::kFair);
}

// Also where as many go over it as there are, of a log whose first time is not 0.
TEST(LocalMapVerdict, FewLoopsHangOnATimeOfTheLog) {
  EXPECT_EQ(LocalMapVerdict(LocalMapOf(Loops(6, 1000, 1090))).Text(),
            "fair: the path closes all of 6 loops; what comes after 1009 s hangs on 6 of them, and where a "
            "robot slipped or was carried nothing else says so");
}

// Up and down a blank corridor: all loops tell the distance to its walls, few how far along it they are.
TEST(LocalMapVerdict, LoopsThatTellTheDistanceAcrossAloneTieNothingAlong) {
  for (const char* axis : {"connections/tells_x", "connections/tells_y"}) {
    Blob map = LocalMapOf(Loops(100, 1, 50));
    for (const char* other : {"connections/tells_x", "connections/tells_y"})
      map.PutVector<std::uint8_t>(other, std::vector<std::uint8_t>(100, 1));
    EXPECT_EQ(LocalMapVerdict(map).trust, Confidence::kHigh);
    std::vector<std::uint8_t> tells(100, 0);
    map.PutVector<std::uint8_t>(axis, tells);
    EXPECT_EQ(LocalMapVerdict(map).Text(),
              "fair: the path closes all of 100 loops; along one direction, as of a blank corridor, what "
              "comes after "
              "6 s hangs on 0 of them, and where a robot slipped that way nothing else says so");
    for (std::size_t i = 0; i < 9; ++i) tells[i] = 1;
    map.PutVector<std::uint8_t>(axis, tells);
    EXPECT_EQ(LocalMapVerdict(map).trust, Confidence::kFair);
    tells[9] = 1;
    map.PutVector<std::uint8_t>(axis, tells);
    EXPECT_EQ(LocalMapVerdict(map).trust, Confidence::kHigh);
  }
}

TEST(LocalMapVerdict, ALongWayAlongWhichNoLoopTellsIsNotTrusted) {
  const auto verdict_of = [](double open_m) {
    Blob map = LocalMapOf(Loops(100, 1, 50));
    std::vector<std::uint8_t> tells(100, 1);
    std::vector<double> from_s(100, 1), to_s(100, 50);
    std::fill_n(to_s.begin(), 40, 20);           // before that way
    std::fill_n(from_s.begin() + 40, 40, 30.0);  // after it
    std::fill_n(tells.begin() + 80, 20, 0);      // over it, but of the other axis
    map.PutVector("connections/from_s", from_s);
    map.PutVector("connections/to_s", to_s);
    map.PutVector("connections/tells_x", tells);
    map.PutVector<std::uint8_t>("connections/tells_y", std::vector<std::uint8_t>(100, 1));
    kinds::PoseTable poses;
    poses.Set({0, 20, 30, 51},
              {Pose{0, 0, 0}, Pose{30, 0, 0}, Pose{30 + open_m, 0, 0}, Pose{60 + open_m, 0, 0}});
    map.PutAll("robot/0/poses/", BlobOf(poses));
    return LocalMapVerdict(map);
  };
  EXPECT_EQ(verdict_of(7).trust, Confidence::kFair);
  EXPECT_EQ(verdict_of(9).trust, Confidence::kLow);
  EXPECT_NE(verdict_of(9).why.find("over 9 m no loop tells how far along one direction the robot is"),
            std::string::npos)
      << verdict_of(9).why;
}

// Of a hundred passes so many are of a corridor that is drawn 2 m aside, about x 30.
TEST(LocalMapVerdict, PlacesThatAreDrawnTwiceAreNamedAndNotTrusted) {
  const auto verdict_of = [](std::size_t doubled, std::size_t passes = 100) {
    auto map = Read<kinds::LocalMap>(LocalMapOf(Loops(100, 1, 50)));
    map.robot.resize(1);
    std::vector<double> time_s, x_m, from_s(passes, 20), to_s(passes, 40), through(passes, 0.1),
        none(passes, 0);
    for (int k = 0; k <= 50; ++k) {
      time_s.push_back(k);
      x_m.push_back(k);
    }
    map.robot[0].poses = {time_s, x_m, std::vector<double>(51, 0), std::vector<double>(51, 0)};
    std::vector<std::uint8_t> is(passes, 0);
    std::vector<double> off_y_m = none;
    for (std::size_t k = 0; k < doubled; ++k) {
      is[k] = 1;
      off_y_m[k] = k % 2 == 0 ? 2 : -2;
      from_s[k] = k == 0 ? 5 : 30;
    }
    map.robot[0].passes = {from_s, to_s, through, none, off_y_m, is};
    return LocalMapVerdict(BlobOf(map));
  };
  EXPECT_EQ(verdict_of(0).trust, Confidence::kHigh);
  EXPECT_EQ(verdict_of(6).trust, Confidence::kHigh);
  EXPECT_EQ(verdict_of(19, 60).trust, Confidence::kHigh) << "so few are chance";
  EXPECT_EQ(verdict_of(24, 240).trust, Confidence::kFair);
  EXPECT_NE(verdict_of(24, 240).why.find("some places are drawn twice"), std::string::npos);
  EXPECT_EQ(verdict_of(25).Text(),
            "low: the path closes all of 100 loops; the same places are drawn twice, up to 2.0 m apart, most "
            "around x 30, y 0 m: 25% of the scans see through walls that those of another pass hit there");
}

// A hall's walls are further away than the local grids reach.
TEST(LocalMapVerdict, AWayWithoutAWallInTheGridsIsNotTrustedAndTheRemedyNamed) {
  const auto verdict_of = [](double blind_m) {
    Blob map = LocalMapOf(Loops(100, 1, 50));
    kinds::PoseTable poses;
    const std::vector<double> time_s{0, 20, 30, 51};
    poses.Set(time_s, {Pose{0, 0, 0}, Pose{10, 0, 0}, Pose{10 + blind_m, 0, 0}, Pose{20 + blind_m, 0, 0}});
    map.PutAll("robot/0/poses/", BlobOf(poses));
    map.PutVector("robot/0/walls/time_s", time_s);
    map.PutVector<double>("robot/0/walls/angle_rad", {0, 0, 0, 0});
    map.PutVector<double>("robot/0/walls/strength", {1, 1, 0, 1});
    map.PutVector<std::uint8_t>("robot/0/walls/locked", {1, 1, 1, 1});
    map.PutVector<std::uint8_t>("robot/0/walls/other_area", {0, 0, 0, 0});
    return LocalMapVerdict(map);
  };
  EXPECT_EQ(verdict_of(19).trust, Confidence::kHigh);
  EXPECT_EQ(verdict_of(30).trust, Confidence::kLow);
  EXPECT_NE(
      verdict_of(30).why.find("on 60% of the way, 30 m at a stretch, no wall lies within the local grids: "
                              "a greater 'half_cells' lets them see further"),
      std::string::npos)
      << verdict_of(30).why;
}

TEST(LocalMapVerdict, ALongWayAfterTheLastLoopIsNamed) {
  const auto verdict_of = [](double after_m) {
    Blob map = LocalMapOf(Loops(30, 1, 50));
    kinds::PoseTable poses;
    poses.Set({0, 50, 60}, {Pose{0, 0, 0}, Pose{100, 0, 0}, Pose{100 + after_m, 0, 0}});
    map.PutAll("robot/0/poses/", BlobOf(poses));
    return LocalMapVerdict(map);
  };
  EXPECT_EQ(verdict_of(15).trust, Confidence::kHigh);
  EXPECT_EQ(verdict_of(30).Text(),
            "fair: the path closes all of 30 loops; from 50 to 60 s, over 30 m, no place is recognised, and "
            "nothing "
            "checks the path");
}

// A long drive whose second half a few loops tie, ten metres before its end: a tenth of it is more.
TEST(LocalMapVerdict, OfALongDriveTheEndsAreShort) {
  auto loops = Loops(100, 1, 950);
  const auto later = Loops(100, 951, 1000);
  loops.insert(loops.end(), later.begin(), later.end());
  Blob map = LocalMapOf(loops);
  EXPECT_EQ(LocalMapVerdict(map).trust, Confidence::kHigh);
  kinds::PoseTable poses;
  std::vector<double> time_s;
  std::vector<Pose> at;
  for (int k = 0; k <= 1000; ++k) {
    time_s.push_back(k);
    at.push_back({0.4 * k, 0, 0});
  }
  poses.Set(time_s, at);
  map.PutAll("robot/0/poses/", BlobOf(poses));
  EXPECT_EQ(LocalMapVerdict(map).trust, Confidence::kLow);
  EXPECT_NE(LocalMapVerdict(map).why.find("what comes after 950 s hangs on 0"), std::string::npos)
      << LocalMapVerdict(map).why;
}

// A robot stands for long before its first way, amid it or after its last: loops go over its way, and none
// over where it stands at an end.
TEST(LocalMapVerdict, ARobotThatStandsMakesNoEndLonger) {
  const auto verdict_of = [](double stands_from_s, double stands_until_s) {
    const auto after_stand = [&](double moved_s) {
      return moved_s <= stands_from_s ? moved_s : moved_s + stands_until_s - stands_from_s;
    };
    auto loops = Loops(30, after_stand(4), after_stand(96));
    loops.emplace_back(0, stands_until_s - stands_from_s + 100);  // recorded while it stood
    Blob map = LocalMapOf(loops);
    std::vector<std::uint8_t> tells(loops.size(), 1);
    map.PutVector("connections/tells_x", tells);
    map.PutVector("connections/tells_y", tells);
    std::vector<double> time_s;
    std::vector<Pose> at;
    for (int k = 0; k <= 200; ++k) {
      if (k / 2.0 == stands_from_s) {
        time_s.push_back(stands_from_s);
        at.push_back({0.4 * stands_from_s, 0, 0});
      }
      time_s.push_back(k / 2.0 < stands_from_s ? k / 2.0 : k / 2.0 + stands_until_s - stands_from_s);
      at.push_back({0.2 * k, 0, 0});
    }
    kinds::PoseTable poses;
    poses.Set(time_s, at);
    map.PutAll("robot/0/poses/", BlobOf(poses));
    return LocalMapVerdict(map).Text();
  };
  const std::string high = "high: the path closes all of 31 loops";
  EXPECT_EQ(verdict_of(0, 0), high);
  EXPECT_EQ(verdict_of(0, 200), high);
  EXPECT_EQ(verdict_of(50, 250), high);
  EXPECT_EQ(verdict_of(100, 300), high);
}

// Along an axis that loops tell from half-way on alone, nothing ties the first half.
TEST(LocalMapVerdict, AnAxisIsJudgedOverTheWholeDrive) {
  auto loops = Loops(50, 1, 100);
  const auto later = Loops(50, 60, 100);
  loops.insert(loops.end(), later.begin(), later.end());
  Blob map = LocalMapOf(loops);
  std::vector<std::uint8_t> all(100, 1), tells(100, 0);
  std::fill(tells.begin() + 50, tells.end(), 1);
  map.PutVector("connections/tells_x", all);
  map.PutVector("connections/tells_y", tells);
  EXPECT_EQ(LocalMapVerdict(map).trust, Confidence::kFair);
  EXPECT_NE(
      LocalMapVerdict(map).why.find("along one direction, as of a blank corridor, what comes after 11 s"),
      std::string::npos)
      << LocalMapVerdict(map).why;
}

Blob WithFit(Blob map, double scans_turn_rad, double apart_m, bool hole) {
  kinds::LocalMap::Fit fit;
  fit.from_s = std::vector<double>{20, 149.6};
  fit.until_s = std::vector<double>{21, 153};
  fit.scans_turn_rad = std::vector<double>{0.7, scans_turn_rad};  // the path follows the first
  fit.odometry_turn_rad = std::vector<double>{0.1, 0.03};
  fit.path_turn_rad = std::vector<double>{0.7, -0.001};
  fit.apart_m = std::vector<double>{0.1, apart_m};
  fit.hole = std::vector<std::uint8_t>{0, hole};
  map.PutAll("robot/0/fit/", BlobOf(fit));
  return map;
}

TEST(LocalMapVerdict, WhereTheScansShowAnotherMotionIsNamed) {
  const Blob map = LocalMapOf(Loops(30, 1, 200));
  EXPECT_EQ(LocalMapVerdict(WithFit(map, 1.536, 0.2, false)).Text(),
            "low: the path closes all of 30 loops; from 150 to 153 s the scans show a turn by 88 degrees "
            "and odometry one by 2; the path has one by 0");
  Blob follows = WithFit(map, 1.536, 0.8, false);
  follows.PutVector("robot/0/fit/path_turn_rad", std::vector<double>{0.7, 1.57});
  EXPECT_EQ(LocalMapVerdict(follows).Text(),
            "fair: the path closes all of 30 loops; from 20 to 21 s the scans show a turn by 40 degrees "
            "and odometry one by 6; the path follows the scans");
  EXPECT_EQ(
      LocalMapVerdict(WithFit(map, 0, 3.14, false)).Text(),
      "low: the path closes all of 30 loops; from 150 to 153 s the scans show another way than the path "
      "has, 3.1 m apart: the wheels slipped, or the robot was carried");
  Blob made_good = WithFit(map, 0, 0.2, false);
  for (const char* turn : {"scans_turn_rad", "odometry_turn_rad", "path_turn_rad"})
    made_good.PutVector(std::string("robot/0/fit/") + turn, std::vector<double>{0, 0});
  made_good.PutVector("robot/0/fit/odometry_apart_m", std::vector<double>{0.6, 3.14});
  EXPECT_EQ(
      LocalMapVerdict(made_good).Text(),
      "fair: the path closes all of 30 loops; from 20 to 21 s the scans show another way than odometry, "
      "0.6 m apart: the wheels slipped, or the robot was carried; the path follows the scans");
  EXPECT_EQ(
      LocalMapVerdict(WithFit(map, 0, 0, true)).Text(),
      "low: the path closes all of 30 loops; from 150 to 153 s the robot was moved, and odometry did not "
      "count it: the scans before and after do not meet");
  EXPECT_EQ(LocalMapVerdict(WithFit(LocalMapOf({}), 1.536, 0.2, false)).trust, Confidence::kLow);
}

// A path made straight along a corridor that bends: nothing was recognised, and odometry turned all along.
TEST(LocalMapVerdict, WithoutALoopAPathThatContradictsOdometryIsNotTrusted) {
  const auto verdict_of = [](double turns_rad_per_m) {
    Blob map = LocalMapOf({});
    std::vector<double> time_s, angle_rad;
    std::vector<Pose> at;
    for (int k = 0; k <= 200; ++k) {
      time_s.push_back(k);
      at.push_back({0.2 * k, 0, 0});
      const double turned = std::remainder(turns_rad_per_m * 0.2 * k, std::numbers::pi / 2);
      angle_rad.push_back(turned < 0 ? turned + std::numbers::pi / 2 : turned);
    }
    kinds::PoseTable poses;
    poses.Set(time_s, at);
    map.PutAll("robot/0/poses/", BlobOf(poses));
    map.PutAll("robot/0/walls/", BlobOf(kinds::LocalMap::Walls{time_s, angle_rad, std::vector<double>(201, 1),
                                                               std::vector<std::uint8_t>(201, 1),
                                                               std::vector<std::uint8_t>(201, 0)}));
    return LocalMapVerdict(map);
  };
  EXPECT_EQ(verdict_of(0.01).trust, Confidence::kNone);
  EXPECT_EQ(
      verdict_of(0.07).Text(),
      "low: no place was recognised twice, so nothing checks the path; walls were taken to stand at right "
      "angles, for which odometry would have to drift by 159 degrees in all");
}

TEST(LocalMapVerdict, ARobotWithoutALoopIsNamedBesideOneWithMany) {
  Blob map = LocalMapOf(Loops(30, 1, 50));
  map.Put("robots", Array::Texts({"a", "b"}));
  kinds::PoseTable poses;
  poses.Set({3, 9}, {Pose{0, 0, 0}, Pose{40, 0, 0}});
  map.PutAll("robot/1/poses/", BlobOf(poses));
  EXPECT_EQ(LocalMapVerdict(map).trust, Confidence::kFair);
  EXPECT_NE(LocalMapVerdict(map).why.find("from 3 to 9 s, over 40 m"), std::string::npos)
      << LocalMapVerdict(map).why;
}

TEST(LocalMapVerdict, WithoutALoopNothingIsKnown) {
  EXPECT_EQ(LocalMapVerdict(LocalMapOf({})).Text(),
            "not known: no place was recognised twice, so nothing checks the path");
}

}  // namespace
}  // namespace cairn::datasets
