#include "datasets/evaluate/grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "datasets/evaluate/testing/grid.h"
#include "datasets/simulate/hall/hall.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

// A map whose cells are what the truth's walls say, made of the log's scans at its own poses.
Blob PerfectMap(const Blob& log, double cell_m = 0.05) {
  const auto columns = static_cast<std::size_t>(14 / cell_m), rows = static_cast<std::size_t>(7 / cell_m);
  std::vector<std::string> drawn(rows, std::string(columns, '.'));
  const auto x = log.Get<double>("truth/walls/x_m"), y = log.Get<double>("truth/walls/y_m");
  for (std::size_t w = 0; w < x.size(); w += 2) {
    for (int i = 0; i <= 2000; ++i) {
      const double t = i / 2000.0;
      const auto column = static_cast<std::size_t>((x[w] + t * (x[w + 1] - x[w]) + 2.8) / cell_m);
      const auto row = static_cast<std::size_t>((y[w] + t * (y[w + 1] - y[w]) + 1.6) / cell_m);
      drawn[rows - 1 - row][column] = '#';
    }
  }
  Blob map = DrawnMap(drawn, cell_m, -2.8, -1.6);
  const auto time = log.Get<double>("robot/0/sonar/time_s");
  map.Put("robot/0/sonar/time_s", log.at("robot/0/sonar/time_s"));
  for (const char* name : {"x_m", "y_m", "heading_rad"})
    map.Put(std::string("robot/0/sonar/") + name, log.at(std::string("robot/0/poses/") + name).Rows(1, 75));
  std::vector<std::uint8_t> held_out(time.size(), 0);
  for (std::size_t s = 0; s < held_out.size(); ++s) held_out[s] = s % 10 == 9 ? 1 : 0;
  map.PutVector("robot/0/sonar/held_out", held_out);
  return map;
}

Blob Hallway(bool closed) { return SimulateHallway({.door_readings = 3, .closed = closed, .seed = 2}); }

TEST(EvaluateGrid, APerfectMapMissesNothingAndKnowsItsDoor) {
  for (const bool closed : {false, true}) {
    const Blob log = Hallway(closed);
    const GridEvaluation evaluation = EvaluateGrid(PerfectMap(log), log);
    ASSERT_TRUE(evaluation.map.cells.has_value());
    EXPECT_EQ(evaluation.map.cells->missed_occupied, 0);
    EXPECT_EQ(evaluation.map.cells->false_occupied, 0);
    EXPECT_EQ(evaluation.map.cells->beyond_walls, 0);
    EXPECT_GT(evaluation.map.cells->due, 350);
    ASSERT_EQ(evaluation.map.doors.size(), 1U);
    EXPECT_EQ(evaluation.map.doors[0].truly_open, !closed);
    EXPECT_EQ(evaluation.map.doors[0].open, !closed);
    EXPECT_LT(*evaluation.pose_rmse_m, 1e-9);
    EXPECT_LT(*evaluation.pose_heading_rmse_deg, 1e-6);
  }
}

TEST(EvaluateGrid, HeadingsThatAreOffAreSaidBesidePositionsThatAreRight) {
  const Blob log = Hallway(false);
  Blob map = PerfectMap(log);
  std::vector<double> heading_rad;
  for (const double heading : map.Get<double>("robot/0/sonar/heading_rad"))
    heading_rad.push_back(heading + 0.3);
  map.PutVector("robot/0/sonar/heading_rad", heading_rad);
  const GridEvaluation evaluation = EvaluateGrid(map, log);
  EXPECT_LT(*evaluation.pose_rmse_m, 1e-9);
  EXPECT_NEAR(*evaluation.pose_heading_rmse_deg, 0.3 * 180 / M_PI, 1e-6);
  ExpectContains(MakeScores(evaluation).ToText(), "pose_heading_rmse_deg");
}

// The map of the other hall says the contrary.
TEST(EvaluateGrid, TheMapOfTheClosedHallDoesNotShowTheOpenDoor) {
  const Blob log = Hallway(false);
  Blob map = PerfectMap(Hallway(true));
  EXPECT_FALSE(EvaluateGrid(map, log).map.doors[0].open);
  EXPECT_GT(EvaluateGrid(map, log).map.cells->false_occupied, 3);  // the leaf
}

TEST(EvaluateGrid, ATrueMapPredictsReadingsBetterThanAFalseOneAndThatThanNone) {
  const Blob log = Hallway(false);
  const Blob right = PerfectMap(log),
             other = PerfectMap(SimulateHallway({.door_readings = 3, .closed = false, .seed = 9}));
  Blob wrong = right;
  wrong.Put("map/grid/probability", other.at("map/grid/probability"));
  Blob none = right;
  none.Put("map/grid/probability",
           Array::Of<double>(
               right.at("map/grid/probability").shape(),
               std::vector<double>(static_cast<std::size_t>(right.at("map/grid/probability").size()), 0.0)));
  const auto score = [&](const Blob& map) {
    return EvaluateGrid(map, log).map.held_out->log_likelihood_per_reading;
  };
  EXPECT_EQ(EvaluateGrid(right, log).map.held_out->readings, 7 * 24);
  EXPECT_GT(score(right), score(wrong) + 0.3);
  EXPECT_GT(score(wrong), score(none));
}

// A map in a frame of its own is laid over the truth by its poses.
TEST(EvaluateGrid, AMapInAnotherFrameIsScoredAllTheSame) {
  const Blob log = Hallway(false);
  const Blob map = PerfectMap(log);
  Blob moved = map;
  moved.PutScalar("map/grid/origin_x_m", map.Scalar<double>("map/grid/origin_x_m") + 10);
  moved.PutScalar("map/grid/origin_y_m", map.Scalar<double>("map/grid/origin_y_m") - 5);
  for (const auto& [name, shift] : std::map<std::string, double>{{"x_m", 10}, {"y_m", -5}}) {
    std::vector<double> values;
    for (const double value : map.Get<double>("robot/0/sonar/" + name)) values.push_back(value + shift);
    moved.PutVector("robot/0/sonar/" + name, values);
  }
  const GridEvaluation evaluation = EvaluateGrid(moved, log);
  EXPECT_EQ(evaluation.map.cells->missed_occupied, 0);
  EXPECT_EQ(evaluation.map.cells->false_occupied, 0);
  EXPECT_TRUE(evaluation.map.doors[0].open);
}

// A corridor round a block of 8 by 8 m, along whose middle a robot drives; its outer walls 20 m long. Four
// beams, one to each side.
constexpr double kMiddle_m = 11.5;
const std::vector<Point> kCorners{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

Blob RoundTheBlock() {
  std::vector<double> time, x, y, heading, wall_x, wall_y;
  for (std::size_t side = 0; side < 4; ++side) {
    const Point from = kCorners[side], to = kCorners[(side + 1) % 4];
    for (int i = 0; i < 14; ++i) {
      time.push_back(static_cast<double>(time.size()));
      x.push_back(kMiddle_m + 7 * from.x_m + (to.x_m - from.x_m) / 2 * i);
      y.push_back(kMiddle_m + 7 * from.y_m + (to.y_m - from.y_m) / 2 * i);
      heading.push_back(0);
    }
    for (const double half_m : {10.0, 4.0}) {
      for (const Point end : {from, to}) {
        wall_x.push_back(kMiddle_m + half_m * end.x_m);
        wall_y.push_back(kMiddle_m + half_m * end.y_m);
      }
    }
  }
  Blob log;
  log.Put("robots", Array::Texts({"Rosa"}));
  const auto scans = static_cast<std::int64_t>(time.size());
  log.PutVector("robot/0/laser/time_s", time);
  log.Put("robot/0/laser/range_m", Array::Of<double>({scans, 4}, std::vector<double>(time.size() * 4, 3)));
  log.PutVector<double>("robot/0/laser/beam_x_m", {0, 0, 0, 0});
  log.PutVector<double>("robot/0/laser/beam_y_m", {0, 0, 0, 0});
  log.PutVector<double>("robot/0/laser/beam_heading_rad", {0, M_PI / 2, M_PI, -M_PI / 2});
  log.PutScalar<double>("robot/0/laser/opening_rad", 0);
  log.PutScalar<double>("robot/0/laser/max_range_m", 30);
  log.Put("truth/walls/x_m", Array::Of<double>({8, 2}, wall_x));
  log.Put("truth/walls/y_m", Array::Of<double>({8, 2}, wall_y));
  const std::string poses = "truth/robot/0/poses/";
  log.PutVector(poses + "time_s", time);
  log.PutVector(poses + "x_m", x);
  log.PutVector(poses + "y_m", y);
  log.PutVector(poses + "heading_rad", heading);
  return log;
}

// With the block, and outer walls so far from the middle, made with the true path shrunk to `scale` times it.
Blob MapOfTheBlock(const Blob& log, int outer_cells, double scale) {
  std::vector<std::string> drawn(23, std::string(23, ' '));
  for (const int half : {outer_cells, 4}) {
    for (int i = -half; i <= half; ++i) {
      const auto at = static_cast<std::size_t>(11 + i), low = static_cast<std::size_t>(11 - half),
                 high = static_cast<std::size_t>(11 + half);
      drawn[low][at] = drawn[high][at] = drawn[at][low] = drawn[at][high] = '#';
    }
  }
  drawn[11][18] = '#';  // in the corridor
  Blob map = DrawnMap(drawn);
  map.Put("robot/0/laser/time_s", log.at("robot/0/laser/time_s"));
  for (const char* name : {"x_m", "y_m"}) {
    std::vector<double> values;
    for (const double value : log.Get<double>(std::string("truth/robot/0/poses/") + name))
      values.push_back(kMiddle_m + scale * (value - kMiddle_m));
    map.PutVector(std::string("robot/0/laser/") + name, values);
  }
  map.Put("robot/0/laser/heading_rad", log.at("truth/robot/0/poses/heading_rad"));
  map.PutVector("robot/0/laser/held_out",
                std::vector<std::uint8_t>(log.at("robot/0/laser/time_s").size(), 0));
  return map;
}

// The path of the worse map lies in the block, four metres off: from there nothing of the corridor, where its
// outer walls stand, is to be reached or seen.
TEST(EvaluateGrid, WhatIsFreeAndWhatWasSeenIsByTheTruePathWhereverTheMapHasIt) {
  const Blob log = RoundTheBlock();
  const GridEvaluation right = EvaluateGrid(MapOfTheBlock(log, 10, 1), log),
                       wrong = EvaluateGrid(MapOfTheBlock(log, 7, 3.0 / 7), log);
  EXPECT_GT(*wrong.pose_rmse_m, 4);
  EXPECT_EQ(right.map.cells->free, 19 * 19 - 9 * 9);
  EXPECT_EQ(wrong.map.cells->free, right.map.cells->free);
  EXPECT_EQ(wrong.map.cells->due, right.map.cells->due);
  EXPECT_EQ(right.map.cells->false_occupied, 1);
  EXPECT_EQ(wrong.map.cells->false_occupied, 4 * 14);
  EXPECT_EQ(right.map.cells->missed_occupied, 0);
  EXPECT_GT(wrong.map.cells->missed_occupied, 50);
  EXPECT_FALSE(right.by_own_path);
}

TEST(EvaluateGrid, ScansOfWhoseTimesTheTruthHasNoPoseTellOfNothing) {
  Blob log = RoundTheBlock();
  const Blob map = MapOfTheBlock(log, 10, 1);
  const std::int64_t due = EvaluateGrid(map, log).map.cells->due;
  for (const char* name : {"time_s", "x_m", "y_m", "heading_rad"}) {
    const std::string full = std::string("truth/robot/0/poses/") + name;
    log.Put(full, log.at(full).Rows(0, 14));
  }
  const GridEvaluation part = EvaluateGrid(map, log);
  EXPECT_LT(part.map.cells->due, due / 2);
  EXPECT_GT(part.map.cells->due, 14);
  EXPECT_EQ(part.map.cells->free, 19 * 19 - 9 * 9);
}

TEST(EvaluateGrid, WhereTheTruthHasNoPathItIsTheMapsOwnAndTheScoreSaysSo) {
  const Blob log = RoundTheBlock();
  const Blob map = MapOfTheBlock(log, 10, 1);
  const Scores with = MakeScores(EvaluateGrid(map, log)),
               without = MakeScores(EvaluateGrid(map, log.Without("truth/robot/")));
  EXPECT_EQ(nlohmann::json::parse(with.ToJson())["cells"]["by_own_path"], false);
  EXPECT_EQ(nlohmann::json::parse(without.ToJson())["cells"]["by_own_path"], true);
  EXPECT_EQ(nlohmann::json::parse(without.ToJson())["cells"]["false_occupied"], 1);
  ExpectContains(with.ToText(), "1 of 280 free\n");
  ExpectContains(without.ToText(), "1 of 280 free, by the map's own path: the truth has none\n");
}

// DrawnMap's and PerfectMap's cells are sure to 0.1 and 0.9: log-odds of 2.2 either way.
TEST(ScoreByThreshold, FindsMoreWallsAndMoreFalseCellsTheLowerItIs) {
  const Blob log = Hallway(false), map = PerfectMap(log);
  const std::vector<ThresholdScore> scores = ScoreByThreshold(map, log, {-3, 0, 3});
  ASSERT_EQ(scores.size(), 3U);
  EXPECT_GT(scores[0].cells.false_occupied, 10000);
  EXPECT_EQ(scores[0].cells.missed_occupied, 0);
  EXPECT_FALSE(scores[0].doors_right);
  EXPECT_EQ(scores[1].cells.false_occupied, 0);
  EXPECT_EQ(scores[1].cells.missed_occupied, 0);
  EXPECT_TRUE(scores[1].doors_right);
  EXPECT_EQ(scores[2].cells.missed_occupied, scores[2].cells.due);
  Blob unsure = map;
  std::vector<double> halves(static_cast<std::size_t>(map.at("map/grid/probability").size()), 0.501);
  unsure.Put("map/grid/probability", Array::Of<double>(map.at("map/grid/probability").shape(), halves));
  for (const ThresholdScore& score : ScoreByThreshold(unsure, log, {-3, 0}))
    EXPECT_EQ(score.cells.missed_occupied, score.cells.due);  // says nothing, at any threshold
  ExpectContains(InputErrorOf([&] { ScoreByThreshold(map, log.Without("truth/walls/"), {0}); }), "no walls");
}

TEST(EvaluateGrid, SaysWhatItMeasuredAsTheIssueNamesIt) {
  const Blob log = Hallway(false);
  const auto json = nlohmann::json::parse(MakeScores(EvaluateGrid(PerfectMap(log), log)).ToJson());
  EXPECT_EQ(json["cells"]["false_occupied"], 0);
  EXPECT_EQ(json["cells"]["missed_occupied"], 0);
  EXPECT_EQ(json["door"]["open"], true);
  EXPECT_TRUE(json["heldout"]["log_likelihood_per_reading"].is_number());
  EXPECT_TRUE(json["most_likely"].is_null());
  const std::string text = MakeScores(EvaluateGrid(PerfectMap(log), log)).ToText();
  for (const char* name :
       {"cells.false_occupied", "cells.missed_occupied", "door.open", "heldout.log_likelihood"})
    ExpectContains(text, name);
  ExpectContains(text, "yes, every door\n");
}

TEST(EvaluateGrid, WithoutTruthOnlyReadingsAreScored) {
  const Blob log = Hallway(false);
  const GridEvaluation evaluation = EvaluateGrid(PerfectMap(log), log.Without("truth/"));
  EXPECT_FALSE(evaluation.map.cells.has_value());
  EXPECT_TRUE(evaluation.map.doors.empty());
  EXPECT_TRUE(evaluation.map.held_out.has_value());
  EXPECT_FALSE(evaluation.pose_rmse_m.has_value());
}

TEST(EvaluateGrid, RefusesAMapOfAnotherLog) {
  const Blob log = Hallway(false);
  const Blob map = PerfectMap(log);
  const auto refused = [&](const Blob& m, const Blob& l) {
    return InputErrorOf([&] { EvaluateGrid(m, l); });
  };
  ExpectContains(refused(map, SimulateHallway({.door_readings = 3, .closed = false, .seed = 3})),
                 "was the map made from this log?");
  ExpectContains(refused(map, log.Without("robot/0/sonar/")), "no 'robot/0/sonar/'");
  ExpectContains(refused(map.Without("robot/"), log), "at which poses");
  Blob named = map;
  named.Put("log_hash", Array::Text("0123"));
  ExpectContains(refused(named, log), "made from another log");
  named.Put("log_hash", Array::Text(log.Without("truth/").ContentHash().Hex()));
  EXPECT_EQ(refused(named, log), "");
  Blob bad = log;
  bad.Put("truth/walls/x_m", Array::Vector<double>({1, 2, 3}));
  ExpectContains(refused(map, bad), "two ends");
}

TEST(CompareGrids, AMapAgreesWithItself) {
  const Blob map = PerfectMap(Hallway(false));
  const GridEvaluation evaluation = CompareGrids(map, map);
  EXPECT_EQ(evaluation.map.cells->missed_occupied, 0);
  EXPECT_EQ(evaluation.map.cells->false_occupied, 0);
  EXPECT_GT(evaluation.map.cells->due, 500);
}

}  // namespace
}  // namespace cairn::datasets
