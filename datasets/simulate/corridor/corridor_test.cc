#include "datasets/simulate/corridor/corridor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "datasets/testing.h"
#include "schema/geometry.h"

namespace cairn::datasets {
namespace {

SimulateCorridorOptions Small(const std::string& set, std::uint64_t seed = 3) {
  return {.set = set, .runs = 2, .snapshots = 60, .length_m = 40, .seed = seed};
}

TEST(SimulateCorridor, HoldsWhatTheFormatSays) {
  const Blob samples = SimulateCorridor(Small("d1"));
  EXPECT_EQ(samples.Texts("runs"), (std::vector<std::string>{"d1 run 1", "d1 run 2"}));
  EXPECT_EQ(samples.Texts("feature_name"), (std::vector<std::string>{"door", "door detected"}));
  EXPECT_EQ(samples.Texts("input_name").size(), 164U);
  EXPECT_EQ(samples.Texts("input_name")[140], "sonar 0");
  EXPECT_EQ(samples.Scalar<double>("label_error_m"), 0.1);
  for (const char* run : {"run/0/", "run/1/"}) {
    EXPECT_EQ(samples.at(std::string(run) + "input").shape(), (Shape{60, 164}));
    EXPECT_EQ(samples.at(std::string(run) + "feature").shape(), (Shape{60, 2}));
    const auto x = samples.Get<double>("truth/" + std::string(run) + "x_m");
    EXPECT_EQ(x.front(), 0);
    EXPECT_NEAR(x.back(), 40, 1e-9);
    // [Thr98] 5.1.2: about 15 cm/s.
    EXPECT_NEAR(samples.Get<double>(std::string(run) + "time_s").back(), 40 / 0.15, 1e-6);
    for (const float value : samples.Get<float>(std::string(run) + "input"))
      ASSERT_TRUE(std::isfinite(value));
  }
  EXPECT_EQ(SimulateCorridor(Small("d3")).Texts("feature_name"),
            (std::vector<std::string>{"light", "light detected"}));
}

TEST(SimulateCorridor, IsDecidedByItsSeed) {
  const auto hash = [](const SimulateCorridorOptions& options) {
    return SimulateCorridor(options).ContentHash();
  };
  EXPECT_EQ(hash(Small("d2")), hash(Small("d2")));
  EXPECT_NE(hash(Small("d2")), hash(Small("d2", 4)));
  EXPECT_NE(SimulateCorridor(Small("d1")).Sub("run/0/").ContentHash(),
            SimulateCorridor(Small("d1")).Sub("run/1/").ContentHash());
}

TEST(SimulateCorridor, MoreRunsLeaveTheFirstOnesAsTheyWere) {
  SimulateCorridorOptions more = Small("d1");
  more.runs = 3;
  EXPECT_EQ(SimulateCorridor(more).Sub("run/1/").ContentHash(),
            SimulateCorridor(Small("d1")).Sub("run/1/").ContentHash());
}

// A label's error is as large as it is said to be, and changes slowly.
TEST(SimulateCorridor, LabelsErrAsStated) {
  SimulateCorridorOptions options = Small("d3");
  options.runs = 12;
  options.snapshots = 40;
  options.label_error_m = 0.3;
  const Blob samples = SimulateCorridor(options);
  double squares = 0, steps = 0, count = 0;
  for (int run = 0; run < options.runs; ++run) {
    const std::string prefix = "run/" + std::to_string(run) + "/";
    double last = 0;
    for (const char* axis : {"x_m", "y_m"}) {
      const auto label = samples.Get<double>(prefix + axis),
                 truth = samples.Get<double>("truth/" + prefix + axis);
      for (std::size_t k = 0; k < label.size(); ++k) {
        const double error = label[k] - truth[k];
        squares += error * error;
        if (k > 0) steps += (error - last) * (error - last);
        last = error;
        ++count;
      }
    }
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.3, 0.04);
  // Labels a metre apart: 2 (1 - e^(-1/3)) = 0.57; of independent ones 2.
  EXPECT_NEAR(steps / squares, 0.57, 0.15);
  options.label_error_m = 0;
  const Blob exact = SimulateCorridor(options);
  EXPECT_TRUE(std::ranges::equal(exact.Get<double>("run/0/x_m"), exact.Get<double>("truth/run/0/x_m")));
}

TEST(SimulateCorridor, ComesBackOnTheOtherSide) {
  SimulateCorridorOptions both = Small("d1");
  both.both_ways = true;
  const Blob there = SimulateCorridor(Small("d1")), back = SimulateCorridor(both);
  EXPECT_EQ(back.Sub("run/0/").ContentHash(), there.Sub("run/0/").ContentHash());
  EXPECT_EQ(back.Texts("runs")[1], "d1 run 2 back");
  const auto x = there.Get<double>("truth/run/1/x_m"), x_back = back.Get<double>("truth/run/1/x_m");
  const auto y = there.Get<double>("truth/run/1/y_m"), y_back = back.Get<double>("truth/run/1/y_m");
  const auto heading = there.Get<double>("truth/run/1/heading_rad"),
             heading_back = back.Get<double>("truth/run/1/heading_rad");
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_EQ(x_back[k], 40 - x[k]);
    EXPECT_EQ(y_back[k], -y[k]);
    EXPECT_NEAR(std::cos(heading_back[k]), -std::cos(heading[k]), 1e-12);
  }
  EXPECT_NE(back.Sub("run/1/").ContentHash(), there.Sub("run/1/").ContentHash());
}

// First the turn, then the way: from pose to pose it leads where the robot truly was, and slowly goes astray.
TEST(SimulateCorridor, GivesOdometryThatErrsALittle) {
  SimulateCorridorOptions options = Small("d1");
  const Blob without = SimulateCorridor(options);
  options.odometry = options.both_ways = true;
  const Blob samples = SimulateCorridor(options);
  EXPECT_EQ(samples.Without("run/0/odometry/").Sub("run/0/").ContentHash(),
            without.Sub("run/0/").ContentHash());
  for (const std::string prefix : {"run/0/", "run/1/"}) {
    const auto x = samples.Get<double>("truth/" + prefix + "x_m"),
               y = samples.Get<double>("truth/" + prefix + "y_m"),
               heading = samples.Get<double>("truth/" + prefix + "heading_rad");
    const auto turn = samples.Get<double>(prefix + "odometry/turn_rad"),
               forward = samples.Get<double>(prefix + "odometry/forward_m"),
               left = samples.Get<double>(prefix + "odometry/left_m");
    ASSERT_EQ(turn.size(), x.size());
    EXPECT_EQ(turn[0], 0.0);
    EXPECT_EQ(forward[0], 0.0);
    Pose pose{x[0], y[0], heading[0]};
    for (std::size_t k = 1; k < x.size(); ++k) {
      const double faces = heading[k - 1] + turn[k];
      EXPECT_NEAR(x[k - 1] + forward[k] * std::cos(faces) - left[k] * std::sin(faces), x[k], 0.1);
      EXPECT_NEAR(y[k - 1] + forward[k] * std::sin(faces) + left[k] * std::cos(faces), y[k], 0.1);
      pose.heading_rad += turn[k];
      pose.x_m += forward[k] * std::cos(pose.heading_rad) - left[k] * std::sin(pose.heading_rad);
      pose.y_m += forward[k] * std::sin(pose.heading_rad) + left[k] * std::cos(pose.heading_rad);
    }
    const double off_m = std::hypot(pose.x_m - x.back(), pose.y_m - y.back());
    EXPECT_GT(off_m, 0.05) << prefix;
    EXPECT_LT(off_m, 6.0) << prefix;
  }
}

TEST(SimulateCorridor, ChangesWhatItIsTold) {
  SimulateCorridorOptions changed = Small("d1");
  changed.changed = 0.5;
  const Blob before = SimulateCorridor(Small("d1")), after = SimulateCorridor(changed);
  EXPECT_EQ(after.Texts("runs")[0], "d1 changed run 1");
  EXPECT_NE(after.Sub("run/0/").ContentHash(), before.Sub("run/0/").ContentHash());
  changed.changed = 0;
  EXPECT_EQ(SimulateCorridor(changed).ContentHash(), before.ContentHash());
  // Doors are where they were: they come into view at the same places, but for headings and people.
  const auto door = before.Get<float>("run/0/feature"), door_after = after.Get<float>("run/1/feature");
  int alike = 0;
  for (std::size_t k = 0; k < door.size(); k += 2) alike += door[k] == door_after[k] ? 1 : 0;
  EXPECT_GE(alike, 48);  // of 60
}

TEST(SimulateCorridor, ShowsEachRun) {
  std::vector<CorridorPicture> pictures;
  SimulateCorridor(Small("d2"), &pictures);
  ASSERT_EQ(pictures.size(), 2U);
  EXPECT_EQ(pictures[1].name, "d2 run 2");
  EXPECT_TRUE(pictures[1].png.starts_with("\x89PNG"));
}

TEST(SimulateCorridor, RefusesWhatIsOutOfRange) {
  const auto failure = [](auto change) {
    SimulateCorridorOptions options = Small("d1");
    change(options);
    return InputErrorOf([&] { SimulateCorridor(options); });
  };
  EXPECT_EQ(failure([](auto& o) { o.set = "d4"; }), "no set 'd4'; there are d1, d2, d3");
  ExpectContains(failure([](auto& o) { o.runs = 0; }), "runs is 0; allowed is 1 to 64");
  ExpectContains(failure([](auto& o) { o.snapshots = 1; }), "snapshots is 1; allowed is 2 to 100000");
  ExpectContains(failure([](auto& o) { o.length_m = 10; }), "length_m is 10");
  ExpectContains(failure([](auto& o) { o.label_error_m = -1; }), "label_error_m is -1");
  ExpectContains(failure([](auto& o) { o.changed = 1.5; }), "changed is 1.5; allowed is 0 to 1");
  ExpectContains(failure([](auto& o) { o.length_m = std::nan(""); }), "length_m is nan");
}

}  // namespace
}  // namespace cairn::datasets
