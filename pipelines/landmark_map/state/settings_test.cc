#include "pipelines/landmark_map/state/settings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "pipelines/landmark_map/testing.h"
#include "schema/kinds/kind.h"

namespace cairn::landmark_map {
namespace {

Blob TypedLog(std::vector<double> confusion) {
  Blob log = SquareLog{}.Make();
  log.Put("types", Array::Texts({"door", "lamp"}));
  log.PutVector("robot/0/observations/type",
                std::vector<std::int32_t>(log.at("robot/0/observations/time_s").size(), 0));
  if (!confusion.empty()) log.Put("noise/type_confusion", Array::Of<double>({2, 2}, confusion));
  return log;
}

// One hundredth is spread evenly; without a figure one tenth is.
TEST(Resolve, TypesAreTakenForOneAnotherAsTheLogSays) {
  const ClassRules stated = Resolve({}, TypedLog({1.0, 0.0, 0.3, 0.7})).map.classes;
  EXPECT_EQ(stated.count, 2);
  EXPECT_DOUBLE_EQ(stated.Confusion(0, 0), 0.995);
  EXPECT_DOUBLE_EQ(stated.Confusion(1, 0), 0.005);
  EXPECT_DOUBLE_EQ(stated.Confusion(0, 1), 0.302);
  EXPECT_DOUBLE_EQ(Resolve({}, TypedLog({})).map.classes.Confusion(1, 1), 0.95);
  const Settings settings = Resolve({}, TypedLog({0.9, 0.1, 0.3, 0.7}));
  EXPECT_EQ(Settings::FromBlob(settings.ToBlob()).ToBlob().ContentHash(), settings.ToBlob().ContentHash());
}

// As a worker hands the log on.
Settings ResolveChecked(const Blob& log) {
  CheckInput(log, "log");
  return Resolve({}, log);
}

TEST(Resolve, TypesThatMakeNoSenseAreRefused) {
  EXPECT_NO_THROW(ResolveChecked(TypedLog({0.9, 0.1, 0.3, 0.7})));
  for (const std::vector<double>& wrong : std::vector<std::vector<double>>{
           {0.9, 0.2, 0.3, 0.7}, {1.5, -0.5, 0.3, 0.7}, {std::nan(""), 1, 0.3, 0.7}}) {
    EXPECT_THROW(ResolveChecked(TypedLog(wrong)), InputError);
  }
  Blob three = TypedLog({});
  three.PutVector<double>("noise/type_confusion", {1, 0, 0});
  EXPECT_THROW(ResolveChecked(three), InputError);
  Blob many = TypedLog({});
  many.Put("types", Array::Texts(std::vector<std::string>(257, "x")));
  EXPECT_THROW(Resolve({}, many), InputError);
  EXPECT_THROW(Resolve({.model = "exact"}, TypedLog({})), InputError);
}

// A contact detection at every corner: two thirds of a side, rounded to 1, 2 or 5 times a power of ten.
TEST(Resolve, ReachOfLandmarksWithoutIdentityFollowsTheLogsScale) {
  for (const double side_m : {20.0, 200.0}) {
    const MapRules rules = Resolve({}, SquareLog{.laps = 2, .side_m = side_m}.Make()).map;
    EXPECT_DOUBLE_EQ(rules.radius_m, side_m / 2.0);
    EXPECT_DOUBLE_EQ(rules.core_m, side_m / 8.0);
  }
}

// One at a time is in view, 9 m ahead: two are further apart than that.
TEST(Resolve, WhatOneObservationCannotTellApartIsOneLandmark) {
  const Blob log = SquareLog{.laps = 2, .side_m = 20.0, .ranged = true}.Make();
  const MapRules rules = Resolve({}, log).map;
  EXPECT_DOUBLE_EQ(rules.core_m, 4.0 * rules.observation_m);
  EXPECT_LT(rules.core_m, 5.0);
  EXPECT_DOUBLE_EQ(rules.radius_m, 2.0 / 3.0 * 9.0);
  EXPECT_EQ(Resolve({.radius_m = 7.0, .core_m = 1.5}, log).map.radius_m, 7.0);
}

// Where images show two side by side neither takes the other's observations.
TEST(Resolve, LandmarksThatImagesShowBesideEachOtherDoNotContend) {
  Blob log = SquareLog{.laps = 2, .side_m = 20.0, .ranged = true}.Make();
  auto bearing_rad = log.Get<double>("robot/0/observations/bearing_rad");
  std::vector<double> time_s, turned(bearing_rad.begin(), bearing_rad.end());
  for (std::size_t k = 0; k < turned.size(); ++k)
    time_s.push_back(k % 2 == 0 ? 10.0 + 10.0 * static_cast<double>(k) : time_s.back());
  for (std::size_t k = 0; k < turned.size(); k += 2) turned[k] = 0.1;
  log.PutVector("robot/0/observations/time_s", time_s);
  log.PutVector("robot/0/observations/bearing_rad", turned);
  const MapRules rules = Resolve({}, log).map;
  EXPECT_DOUBLE_EQ(rules.radius_m, rules.core_m) << "0.9 m apart";
}

// Seen at a distance: as far as odometry is trusted where landmarks contend and its drift is stated.
TEST(Resolve, TheFirstIterationBeginsWithATwentiethWhereNothingIsSaidOfTheDrift) {
  Blob log = SquareLog{.laps = 2, .side_m = 20.0, .ranged = true}.Make();
  EXPECT_DOUBLE_EQ(Resolve({}, log).growth_start, 0.05);
  log.PutScalar<double>("noise/heading_drift_rad_per_m", 1e-4);
  EXPECT_GT(Resolve({}, log).growth_start, 0.5);
  EXPECT_DOUBLE_EQ(Resolve({.radius_m = 0.1}, log).growth_start, 0.05) << "nothing contends";
}

TEST(Resolve, ObservationsWithoutIdentityGrowThePrefixMoreCarefully) {
  EXPECT_LT(Resolve({}, SquareLog{.ranged = true}.Make()).growth_factor,
            Resolve({}, SquareLog{.ranged = true, .identified = true}.Make()).growth_factor);
  EXPECT_EQ(Resolve({.growth_factor = 3.0}, SquareLog{.ranged = true}.Make()).growth_factor, 3.0);
}

// 50 m to a side: a 90th is 0.5 m.
TEST(Resolve, ACellIsNoLargerThanWhatAnObservationWithoutIdentityErrsBy) {
  Blob exact = SquareLog{.laps = 1, .side_m = 50.0, .ranged = true}.Make(), vague = exact;
  const std::size_t seen = exact.Get<double>("robot/0/observations/range_m").size();
  for (const auto& [log, range_m] : {std::pair{&exact, 0.01}, std::pair{&vague, 3.0}}) {
    log->PutVector("robot/0/observations/range_m", std::vector<double>(seen, 1.0));  // near by
    log->PutScalar<double>("noise/range_m", range_m);
    log->PutScalar<double>("noise/bearing_rad", 1e-4);
  }
  EXPECT_DOUBLE_EQ(Resolve({}, exact).map.grid.cell_m, 0.1) << "a fifth is as much as the time allows";
  EXPECT_DOUBLE_EQ(Resolve({}, vague).map.grid.cell_m, 0.5);
  EXPECT_DOUBLE_EQ(Resolve({.cell_m = 2.0}, exact).map.grid.cell_m, 2.0);
  exact.PutScalar<double>("noise/heading_drift_rad_per_m", 0.001);
  EXPECT_DOUBLE_EQ(Resolve({}, exact).map.grid.cell_m, 0.5) << "the search needs a coarse grid";
  EXPECT_DOUBLE_EQ(Resolve({}, SquareLog{.laps = 1, .side_m = 50.0}.Make()).map.grid.cell_m, 0.5);
}

// Landmarks lie as far as it sees, though it goes nowhere: a map of them on cells of a 90th of its path has
// millions.
TEST(Resolve, OfARobotThatHardlyMovesCellsFollowWhatItSees) {
  Blob log = SquareLog{.laps = 2, .side_m = 1.0, .ranged = true}.Make();
  log.PutVector("robot/0/observations/range_m",
                std::vector<double>(log.at("robot/0/observations/time_s").size(), 9.0));
  EXPECT_DOUBLE_EQ(Resolve({}, log).map.grid.cell_m, 0.1);
}

// What a log without names states of an exact sensor is for the least squares and for single images; EM finds
// the same map as where nothing is stated.
TEST(Resolve, EmTakesNoSensorForMoreExactThanUsual) {
  for (const bool identified : {false, true}) {
    const Blob silent = SquareLog{.laps = 2, .side_m = 20.0, .ranged = true, .identified = identified}.Make();
    Blob exact = silent;
    exact.PutScalar<double>("noise/range_m", 0.005);
    exact.PutScalar<double>("noise/bearing_rad", 0.001);
    const Settings usual = Resolve({}, silent), stated = Resolve({}, exact);
    EXPECT_EQ(stated.observation_noise.range_m, 0.005);
    EXPECT_EQ(stated.observation_noise.bearing_rad, 0.001);
    EXPECT_LT(stated.in_image_m, usual.in_image_m);
    if (identified) {
      EXPECT_LT(stated.map.observation_m, usual.map.observation_m) << "names tell which is which";
    } else {
      EXPECT_EQ(stated.map.observation_m, usual.map.observation_m);
      EXPECT_EQ(stated.map.radius_m, usual.map.radius_m);
      EXPECT_EQ(stated.map.grid.cell_m, usual.map.grid.cell_m);
      EXPECT_EQ(usual.in_image_m, usual.map.observation_m);
    }
  }
}

// The widths of odometry that EM starts from where nothing is stated are no more likely for being wide.
TEST(Resolve, OdometryIsExpectedToErrAsStatedOrAsSmallRobotsDo) {
  Blob log = SquareLog{.laps = 2, .ranged = true, .identified = true}.Make();
  const Settings silent = Resolve({}, log);
  EXPECT_NEAR(silent.noise.turn_ratio, 3.0 * silent.expected_turn_ratio, 1e-12);
  EXPECT_NEAR(silent.noise.heading_walk_rad_per_sqrt_m, 3.0 * silent.expected_walk_rad_per_sqrt_m, 1e-12);
  EXPECT_NEAR(silent.expected_turn_ratio, 0.02, 1e-12);
  log.PutScalar<double>("noise/heading_walk_rad_per_sqrt_m", 0.05);
  log.PutScalar<double>("noise/turn_ratio", 0.1);
  const Settings stated = Resolve({.noise_scale = 2.0}, log);
  EXPECT_EQ(stated.expected_walk_rad_per_sqrt_m, 0.1);
  EXPECT_EQ(stated.expected_turn_ratio, 0.2);
}

// Over the whole extent the heading errs by as much as over 250 m, the drift as well as the walk.
TEST(Resolve, InALargeWorldOdometryWithNamesKeepsItsHeadingForLonger) {
  const auto noise = [](double side_m, bool identified) {
    return Resolve({.starts = 1}, SquareLog{.laps = 1,
                                            .side_m = side_m,
                                            .ranged = true,
                                            .identified = identified,
                                            .walk_rad_per_sqrt_m = 0.0}
                                      .Make())
        .noise;
  };
  const MotionNoise hall = noise(200.0, true), town = noise(1000.0, true), unnamed = noise(1000.0, false);
  EXPECT_EQ(noise(20.0, true).heading_drift_rad_per_m, hall.heading_drift_rad_per_m);
  EXPECT_NEAR(town.heading_drift_rad_per_m, 0.25 * hall.heading_drift_rad_per_m,
              0.01 * hall.heading_drift_rad_per_m);
  EXPECT_NEAR(town.heading_walk_rad_per_sqrt_m, 0.5 * hall.heading_walk_rad_per_sqrt_m,
              0.01 * hall.heading_walk_rad_per_sqrt_m);
  EXPECT_EQ(unnamed.heading_walk_rad_per_sqrt_m, hall.heading_walk_rad_per_sqrt_m);
}

// A landmark seen 80 m away on cells of 20 m: at 1e-3 per square metre four of ten observations would be
// false of each cell, and none would tell where the robot is.
TEST(Resolve, ARateOfFalseObservationsIsNoMoreThanAPartOfThemInAllThatIsInView) {
  const auto rate = [](double side_m, bool identified) {
    return Resolve({.starts = 1},
                   SquareLog{.laps = 1, .side_m = side_m, .ranged = true, .identified = identified}.Make())
        .map.false_rate_per_m2;
  };
  const double away_m = 500.0 - 1.0;
  EXPECT_EQ(rate(10.0, true), 1e-3);
  EXPECT_NEAR(rate(1000.0, true) * std::numbers::pi * away_m * away_m, 0.3, 1e-9);
  EXPECT_EQ(rate(1000.0, false), 1e-3);
}

TEST(Resolve, TheGaugeIsFreeWhereSeveralRobotsSeeAtADistance) {
  for (const bool ranged : {false, true}) {
    Blob log = SquareLog{.ranged = ranged}.Make();
    EXPECT_FALSE(Resolve({}, log).gauge_free);
    log.Put("robots", Array::Texts({"one", "two"}));
    log.PutAll("robot/1/", log.Sub("robot/0/"));
    EXPECT_EQ(Resolve({}, log).gauge_free, ranged);
  }
}

TEST(Resolve, IncrementsAreAsLongAsTheGridBearsOrAsLongAsOneSays) {
  const Blob log = SquareLog{.laps = 2, .side_m = 20.0}.Make();
  const double most_m[] = {20.0, 0.5};
  int steps[2];
  for (int i = 0; i < 2; ++i) {
    const Settings settings = Resolve({.cell_m = 1.0, .max_increment_m = most_m[i]}, log);
    EXPECT_EQ(settings.steps.max_increment_m, most_m[i]);
    const RobotSteps made = MakeSteps(Read<kinds::Log>(log).robot[0], "rover", settings.steps, nullptr);
    for (const double travelled : made.path_m) EXPECT_LE(travelled, most_m[i] + 1e-9);
    steps[i] = made.size();
  }
  EXPECT_GT(steps[1], 10 * steps[0]);
  EXPECT_DOUBLE_EQ(Resolve({.cell_m = 1.0, .heading_deg = 5.0}, log).steps.max_increment_m,
                   180.0 / (5.0 * std::numbers::pi));
  EXPECT_THROW(Resolve({.cell_m = 1.0, .max_increment_m = 0.05}, log), InputError);
}

TEST(Resolve, WholeTablesNeedABox) {
  const Blob log = SquareLog{}.Make();
  EXPECT_THROW(Resolve({.tables = "whole"}, log), InputError);
  EXPECT_TRUE(Resolve({.tables = "whole", .box_m = 40.0}, log).whole_tables);
}

// Five standard deviations of drift, of which each of ten starts leaves a standard deviation open.
TEST(Resolve, ManyStartsLeaveLessOfTheDriftUnknown) {
  Blob log = SquareLog{}.Make();
  EXPECT_EQ(Resolve({.cell_m = 1.0, .starts = 10}, log).noise.drift_length_m, 150.0)
      << "nobody knows how much";
  log.PutScalar<double>("noise/heading_drift_rad_per_m", 0.002);
  const double one = Resolve({.cell_m = 1.0, .starts = 1}, log).noise.drift_length_m;
  EXPECT_EQ(one, 150.0);
  EXPECT_NEAR(Resolve({.cell_m = 1.0, .starts = 10}, log).noise.drift_length_m, one / 12.0, 1e-9);
  EXPECT_NEAR(Resolve({.cell_m = 1.0, .starts = 18}, log).noise.drift_length_m, one / 48.0, 1e-9);
}

TEST(ChooseStarts, OneWhereObservationsTellWhichLandmarkIsWhichElseTen) {
  const auto choice = [](const SquareLog& log, const Options& options = {}) {
    return ChooseStarts(options, log.Make());
  };
  EXPECT_EQ(choice({.identified = true}).count, 1);
  EXPECT_EQ(choice({.identified = true}).why, "every observation names its landmark");
  EXPECT_EQ(choice({}, {.model = "exact"}).count, 1);
  EXPECT_EQ(choice({}).count, 10);
  EXPECT_EQ(choice({.ranged = true}).count, 10);
  EXPECT_NE(choice({.ranged = true}).why.find("does not state a drift of the heading"), std::string::npos);
  EXPECT_EQ(choice({.ranged = true}, {.starts = 4}).count, 4);
  EXPECT_EQ(Resolve({}, SquareLog{.ranged = true}.Make()).starts, 10);
}

// An observation a side: 20,000 of all starts.
TEST(ChooseStarts, FewerOfALongLogAndOneWhereFewerThanFiveFit) {
  const auto of_laps = [](int laps) {
    return ChooseStarts({}, SquareLog{.laps = laps, .side_m = 5.0, .ranged = true}.Make());
  };
  EXPECT_EQ(of_laps(500).count, 10);
  EXPECT_EQ(of_laps(700).count, 7);
  EXPECT_NE(of_laps(700).why.find("fewer than ten, for the log is long"), std::string::npos);
  EXPECT_EQ(of_laps(1001).count, 1);
  EXPECT_NE(of_laps(1001).why.find("starts=10 searches all the same"), std::string::npos);
}

// Of range-bearing observations starts span the drift of nearly every robot; of contact detections that log
// tells nothing, and starts stay near.
TEST(Resolve, StartsOfALogThatStatesNoDriftSpanThatOfAnyRobotWhereLandmarksAreSeenAtADistance) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const auto drift = [](bool ranged, std::int64_t starts) {
    return Resolve({.starts = starts}, SquareLog{.ranged = ranged}.Make()).noise.heading_drift_rad_per_m;
  };
  EXPECT_NEAR(drift(true, 10), 0.75 * kDegree, 1e-12);
  EXPECT_NEAR(drift(true, 1), 0.1 * kDegree, 1e-12);
  EXPECT_NEAR(drift(false, 10), 0.1 * kDegree, 1e-12);
  Blob told = SquareLog{.ranged = true}.Make();
  told.PutScalar<double>("noise/heading_drift_rad_per_m", 0.002);
  EXPECT_EQ(Resolve({}, told).noise.heading_drift_rad_per_m, 0.002);
}

// The least cells are a fifth of a 90th of the extent.
TEST(ForSearch, IsOnCellsAtMostTwoAndAHalfTimesAsWide) {
  const Blob log = PostsLog{}.Make();
  const double fine_m = Resolve({}, log).map.grid.cell_m;
  const double coarse_m = Resolve(ForSearch({}, log), log).map.grid.cell_m;
  EXPECT_GT(coarse_m, fine_m);
  EXPECT_LE(coarse_m, 2.5 * fine_m);
  EXPECT_EQ(ForSearch({.starts = 1}, log).cell_m, 0.0);
}

TEST(Resolve, ALogOfScansIsSentToThePipelinesThatTakeThem) {
  Blob log = SquareLog{}.Make();
  for (const char* column : {"time_s", "range_m", "bearing_rad"})
    log.PutVector<double>(std::string("robot/0/observations/") + column, {});
  log.PutVector<std::int32_t>("robot/0/observations/landmark", {});
  const auto why = [&] {
    try {
      Resolve({}, log);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(why().find("controls only"), std::string::npos) << why();
  log.Put("robot/0/laser/range_m", Array::Of<double>({1, 1}, {1.0}));
  EXPECT_NE(why().find("evidence_map"), std::string::npos) << why();
}

// 25 m at 5 degrees a root of a metre are 25 degrees.
TEST(Resolve, TheFirstIterationUsesTheWayOnWhichOdometryCanBeTrusted) {
  Blob log = SquareLog{.laps = 3, .side_m = 20.0}.Make();
  log.PutScalar<double>("noise/heading_drift_rad_per_m", 0.0);
  log.PutScalar<double>("noise/turn_ratio", 0.0);
  log.PutScalar<double>("noise/heading_walk_rad_per_sqrt_m", 5.0 * std::numbers::pi / 180.0);
  EXPECT_NEAR(Resolve({.cell_m = 1.0}, log).growth_start, 23.04 / 240.0, 1.0 / 240.0);
  log.PutScalar<double>("noise/heading_walk_rad_per_sqrt_m", 0.01);
  EXPECT_EQ(Resolve({.cell_m = 1.0}, log).growth_start, 1.0);
}

// Of robots 'one' and 'two', who each name so many corners and leave the other names out.
Settings PartlyNamed(int one, int two) {
  Blob log = SquareLog{.ranged = true, .identified = true}.Make();
  log.Put("robots", Array::Texts({"one", "two"}));
  log.PutAll("robot/1/", log.Sub("robot/0/"));
  for (const std::string robot : {"robot/0/", "robot/1/"}) {
    std::vector<std::int32_t> names;
    for (const std::int32_t k : log.Get<std::int32_t>(robot + "observations/landmark"))
      names.push_back(k < (robot == "robot/0/" ? one : two) ? k : -1);
    log.PutVector(robot + "observations/landmark", names);
  }
  return Resolve({}, log);
}

TEST(Resolve, TellsWhereNamesAreMissing) {
  EXPECT_FALSE(PartlyNamed(4, 4).map.partly_named);
  EXPECT_FALSE(PartlyNamed(0, 0).map.partly_named);
  EXPECT_FALSE(PartlyNamed(0, 0).joins_by_geometry);
  EXPECT_TRUE(PartlyNamed(3, 4).map.partly_named);
  EXPECT_FALSE(PartlyNamed(3, 4).joins_by_geometry);
  EXPECT_TRUE(PartlyNamed(4, 1).joins_by_geometry);
  EXPECT_FALSE(PartlyNamed(4, 0).map.named_later);
  const Settings later = PartlyNamed(0, 4);
  EXPECT_TRUE(later.map.named_later);
  EXPECT_TRUE(later.joins_by_geometry);
  EXPECT_TRUE(Settings::FromBlob(later.ToBlob()).map.named_later);
}

}  // namespace
}  // namespace cairn::landmark_map
