#include "datasets/evaluate/maps/truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/evaluate/testing/grid.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

constexpr double kNoTruth = std::numeric_limits<double>::quiet_NaN();

// One scan from the middle of a room of 6 by 6 m whose walls are the cells round it; the rays to the right
// and upwards alone.
std::vector<ScoredSensor> OneScan(double opening_rad = 0) {
  ScoredSensor sensor;
  sensor.name = "robot/0/laser/";
  sensor.opening_rad = opening_rad;
  sensor.max_range_m = 20;
  sensor.beams = {{0, 0, 0}, {0, 0, std::numbers::pi / 2}};
  sensor.time_s = {1};
  sensor.poses = {{4.5, 4.5, 0}};
  sensor.held_out = {0};
  sensor.range_m = {3, 3};
  return {sensor};
}

const std::vector<Wall> kRoom{
    {{1.5, 1.5}, {7.5, 1.5}}, {{7.5, 1.5}, {7.5, 7.5}}, {{7.5, 7.5}, {1.5, 7.5}}, {{1.5, 7.5}, {1.5, 1.5}}};

TEST(MapTruth, OfARoomByHand) {
  const Occupancy map = ReadOccupancy(DrawnMap(std::vector<std::string>(9, std::string(9, ' '))));
  const MapTruth truth = TruthOfWalls(map.box, kRoom, OneScan());
  EXPECT_EQ(std::ranges::count(truth.wall, 1), 24);
  EXPECT_EQ(std::ranges::count(truth.free, 1), 25);
  EXPECT_EQ(std::ranges::count(truth.due, 1), 2);
  EXPECT_EQ(truth.due[truth.box.Index(7, 4)], 1);
  EXPECT_EQ(truth.due[truth.box.Index(4, 7)], 1);
}

// A cone of 30 degrees from 3 m away: what of the wall lies within 4 m of its tip.
TEST(MapTruth, AConeTellsOfTheWallThatIsAtMostACellBehindItsNearestPoint) {
  const Occupancy map = ReadOccupancy(DrawnMap(std::vector<std::string>(9, std::string(9, ' '))));
  const MapTruth truth = TruthOfWalls(map.box, kRoom, OneScan(std::numbers::pi / 6));
  EXPECT_EQ(std::ranges::count(truth.due, 1), 6);  // 3 tan 15 = 0.8 m to either side
  for (const int row : {3, 4, 5}) EXPECT_EQ(truth.due[truth.box.Index(7, row)], 1) << row;
}

// A wall of 100 km: as if it ended where no beam reaches. The points on it are looked at where a beam may see
// them.
TEST(MapTruth, WallsLongerThanAnyBeamTellOfTheSame) {
  const Occupancy map = ReadOccupancy(DrawnMap(std::vector<std::string>(9, std::string(9, ' '))));
  std::vector<ScoredSensor> scans = OneScan(std::numbers::pi / 6);
  scans[0].beams = {{0, 0, 0}};
  scans[0].range_m = {3};
  const MapTruth once = TruthOfWalls(map.box, {{{7.5, -50'000}, {7.5, 50'000}}}, scans);
  EXPECT_EQ(std::ranges::count(once.due, 1), 3);
  for (const int row : {3, 4, 5})
    EXPECT_EQ(once.due[once.box.Index(7 + once.offset_columns, row + once.offset_rows)], 1) << row;
}

TEST(MapTruth, WhatLiesFartherThanAnyMapReachesIsRefused) {
  Occupancy map = ReadOccupancy(DrawnMap(std::vector<std::string>(9, std::string(9, ' '))));
  for (const double far_m : {1.2e4, 1e9, 1.7e18, 1e300}) {
    EXPECT_THROW(TruthOfWalls(map.box, {{{0, 0}, {far_m, 0}}, {{0, 0}, {0, -far_m}}}, OneScan()), InputError)
        << far_m;
  }
  map.box.cell_m = 1e-300;
  EXPECT_THROW(TruthOfWalls(map.box, kRoom, OneScan()), InputError);
  Blob empty = DrawnMap({" "});
  empty.Put("map/grid/probability", Array::Of<double>({0, 3}, std::vector<double>()));
  EXPECT_THROW(ReadOccupancy(empty), InputError);
}

TEST(MapTruth, HeldOutScansTellOfNothing) {
  const Occupancy map = ReadOccupancy(DrawnMap(std::vector<std::string>(9, std::string(9, ' '))));
  std::vector<ScoredSensor> scans = OneScan();
  scans[0].held_out[0] = 1;
  const MapTruth truth = TruthOfWalls(map.box, kRoom, scans);
  EXPECT_EQ(std::ranges::count(truth.due, 1), 0);
  EXPECT_EQ(std::ranges::count(truth.free, 1), 25);
}

TEST(ScoreCells, CountsWhatIsMissedFalseAndBeyond) {
  const Blob map = DrawnMap({"#        ",  // beyond the walls
                             " #######.", " #.....#.", " #.#...#.", " #....## ", " #...... ", " #..... #",
                             " ####### ", "         "});
  const CellScore perfect =
      ScoreCells(ReadOccupancy(map), TruthOfWalls(ReadOccupancy(map).box, kRoom, OneScan()));
  EXPECT_EQ(perfect.due, 2);
  EXPECT_EQ(perfect.missed_occupied, 0);
  EXPECT_EQ(perfect.free, 25);
  EXPECT_EQ(perfect.false_occupied, 1);  // that in column 3; that in column 6 touches the wall
  EXPECT_EQ(perfect.beyond_walls, 0);    // those at the border touch it too
  const Blob bare = DrawnMap({"         ", " ##   ##.", " #.....#.", " #.....  ", " #....   ", " #.....  ",
                              " #.....  ", " ####### ", "         "});
  const CellScore missed =
      ScoreCells(ReadOccupancy(bare), TruthOfWalls(ReadOccupancy(bare).box, kRoom, OneScan()));
  EXPECT_EQ(missed.missed_occupied, 2);
  EXPECT_EQ(missed.missed_free, 0);  // they are unknown
}

TEST(ScoreCells, OccupiedCellsBehindWallsAreNoFalseObstacles) {
  std::vector<std::string> rows(12, std::string(12, ' '));
  rows[0][11] = '#';
  const Occupancy map = ReadOccupancy(DrawnMap(rows));
  const CellScore score = ScoreCells(map, TruthOfWalls(map.box, kRoom, OneScan()));
  EXPECT_EQ(score.beyond_walls, 1);
  EXPECT_EQ(score.false_occupied, 0);
  EXPECT_EQ(score.missed_occupied, 2);
}

// Truth that reaches beyond the map is missed there.
TEST(ScoreCells, WallsOutsideTheMapAreMissed) {
  const Occupancy map = ReadOccupancy(DrawnMap({"....", "....", "....", "...."}, 1, 2, 2));
  const CellScore score = ScoreCells(map, TruthOfWalls(map.box, kRoom, OneScan()));
  EXPECT_EQ(score.due, 2);
  EXPECT_EQ(score.missed_occupied, 2);
  EXPECT_EQ(score.free, 25);
}

TEST(ScoreCells, AgainstAnotherMapWithOtherCells) {
  const Occupancy reference = ReadOccupancy(DrawnMap({"#.", ".."}, 2));
  const Occupancy map = ReadOccupancy(DrawnMap({"  ..", "....", "..  ", "...#"}));
  const CellScore score = ScoreCells(map, TruthOfMap(map.box, reference));
  EXPECT_EQ(score.due, 4);
  EXPECT_EQ(score.missed_occupied, 4);
  EXPECT_EQ(score.missed_free, 2);
  EXPECT_EQ(score.free, 12);
  EXPECT_EQ(score.false_occupied, 1);
}

// A wall that is one fine cell wide lies in some coarse cell, wherever its centre is.
TEST(ScoreCells, AgainstAMapOfSmallerCells) {
  const Occupancy map = ReadOccupancy(DrawnMap({"....", "....", ".##.", "...."}));
  const Occupancy reference = ReadOccupancy(DrawnMap(
      {"............", "............", "............", "............", "............", "............",
       "....#####...", "............", "............", "............", "............", "............"},
      1.0 / 3));
  const MapTruth truth = TruthOfMap(map.box, reference);
  EXPECT_EQ(std::ranges::count(truth.wall, 1), 2);
  EXPECT_EQ(std::ranges::count(truth.free, 1), 14);
  const CellScore score = ScoreCells(map, truth);
  EXPECT_EQ(score.due, 2);
  EXPECT_EQ(score.missed_occupied, 0);
  EXPECT_EQ(score.false_occupied, 0);
}

TEST(ScoreCells, AgainstAMapOfAnotherPlaceIsRefused) {
  const Occupancy map = ReadOccupancy(DrawnMap({"....", "....", ".##.", "...."}));
  const Occupancy elsewhere = ReadOccupancy(DrawnMap({"..", "##"}, 1, 40, 0));
  ExpectContains(InputErrorOf([&] { TruthOfMap(map.box, elsewhere); }),
                 "it covers x from 40 to 42 m, y from 0 to 2 m, this one x from 0 to 4 m, y from 0 to 4 m");
}

TEST(Occupancy, WhereTheDataSayNothingNothingIsKnown) {
  Blob map = DrawnMap({"#."});
  map.Put("map/grid/log_odds_difference", Array::Of<double>({1, 2}, std::vector<double>{0, -3}));
  map.Put("map/grid/occupied", Array::Of<std::uint8_t>({1, 2}, std::vector<std::uint8_t>{0, 0}));
  EXPECT_TRUE(std::isnan(ReadOccupancy(map).probability[0]));
  EXPECT_EQ(ReadOccupancy(map).probability[1], 0.1);
  EXPECT_TRUE(std::isnan(ReadMostLikely(map).probability[0]));
  EXPECT_EQ(ReadMostLikely(map).probability[1], 0);
}

TEST(Occupancy, RefusesWhatDoesNotFit) {
  Blob map = DrawnMap({"#."});
  map.Put("map/grid/probability", Array::Vector<double>({0.5}));
  EXPECT_THROW(ReadOccupancy(map), InputError);
}

}  // namespace
}  // namespace cairn::datasets
