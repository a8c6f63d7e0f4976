#include "pipelines/landmark_map/state/given_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"
#include "pipelines/testing/in_process.h"
#include "schema/kinds/kind.h"

namespace cairn::landmark_map {
namespace {

BlobPtr Share(const Blob& blob) { return std::make_shared<const Blob>(blob); }

BlobPtr MapFrom(const Blob& log, const Options& options, const Blob* map = nullptr) {
  std::map<std::string, BlobPtr> inputs{{"log", Share(log)}};
  if (map != nullptr) inputs["map"] = Share(*map);
  return RunInProcess(LandmarkMap(options), inputs);
}

std::string Complaint(const Blob& log, const Options& options, const Blob* map) {
  try {
    MapFrom(log, options, map);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

void ExpectIn(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

// Cells of 1 m, the lower left corner at (0.5, -0.5): cell (1, 0) holds .6, cell (2, 1) .4.
Blob SmallMap() {
  Blob map;
  map.Put("landmarks", Array::Texts({}));
  map.Put("map/grid/probability", Array::Of<double>({1, 2, 2}, {0.6, 0.0, 0.0, 0.4}));
  map.PutScalar<double>("map/grid/origin_x_m", 0.5);
  map.PutScalar<double>("map/grid/origin_y_m", -0.5);
  map.PutScalar<double>("map/grid/cell_m", 1.0);
  map.PutVector<double>("map/landmark_x_m", {1.0});
  map.PutVector<double>("map/landmark_y_m", {0.0});
  map.Put("map/landmark_covariance_m2", Array::Of<double>({1, 2, 2}, {1, 0, 0, 1}));
  map.PutVector<double>("map/landmark_count", {1.0});
  map.PutVector<std::int32_t>("map/landmark_identity", {-1});
  return map;
}

Blob NoNames() {
  Blob log;
  log.Put("landmarks", Array::Texts({}));
  return log;
}

Settings WithCells(double cell_m) {
  Settings settings;
  settings.map.grid.cell_m = cell_m;
  return settings;
}

TEST(GivenMap, TheSameCellsKeepTheirValues) {
  const Layer layer = ReadGivenMap(SmallMap(), NoNames(), WithCells(1.0)).map.layers.at(0);
  EXPECT_EQ(layer.At(1, 0), 0.6);
  EXPECT_EQ(layer.At(2, 1), 0.4);
  EXPECT_EQ(layer.Sum(), 1.0);
}

TEST(GivenMap, OtherCellsShareByAreaAndKeepTheMass) {
  const Layer fine = ReadGivenMap(SmallMap(), NoNames(), WithCells(0.5)).map.layers.at(0);
  EXPECT_NEAR(fine.Sum(), 1.0, 1e-12);
  EXPECT_NEAR(fine.At(2, 0), 0.6 / 4, 1e-12);  // inside the square of 1 m
  EXPECT_NEAR(fine.At(1, 0), 0.6 / 8, 1e-12);  // half of it
  EXPECT_NEAR(fine.At(1, -1), 0.6 / 16, 1e-12);
  const Layer coarse = ReadGivenMap(SmallMap(), NoNames(), WithCells(3.0)).map.layers.at(0);
  EXPECT_NEAR(coarse.Sum(), 1.0, 1e-12);
  EXPECT_NEAR(coarse.At(0, 0), 0.6, 1e-12);  // from -1.5 to 1.5 m
  EXPECT_NEAR(coarse.At(1, 0), 0.4, 1e-12);
}

TEST(GivenMap, LandmarksGoByName) {
  Blob map = SmallMap(), log;
  map.Put("landmarks", Array::Texts({"oak", "elm"}));
  map.Put("map/grid/probability", Array::Of<double>({2, 1, 1}, {0.25, 0.75}));
  map.PutVector<std::int32_t>("map/landmark_identity", {1});
  log.Put("landmarks", Array::Texts({"ash", "elm"}));
  Settings settings = WithCells(1.0);
  settings.map.types = 2;
  const GivenMap given = ReadGivenMap(map, log, settings);
  EXPECT_TRUE(given.map.layers.at(0).box.empty());  // ash: not in the map
  EXPECT_EQ(given.map.layers.at(1).At(1, 0), 0.75);
  ASSERT_EQ(given.landmarks.size(), 1U);
  EXPECT_EQ(given.landmarks[0].type, 1);
}

TEST(GivenMap, WhatIsNoMapIsRefusedWithTheReason) {
  const auto complaint = [](const Blob& map, const Settings& settings) -> std::string {
    try {
      ReadGivenMap(map, NoNames(), settings);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  ExpectIn("no landmark_map: 'map/grid/probability' is missing", complaint(NoNames(), WithCells(1.0)));
  Blob bad = SmallMap();
  bad.Put("map/grid/probability", Array::Of<double>({1, 2, 2}, {0.6, 0.0, 0.0, 1.5}));
  ExpectIn("which is no probability", complaint(bad, WithCells(1.0)));
  bad = SmallMap();
  bad.PutScalar<double>("map/grid/cell_m", std::nan(""));
  ExpectIn("no sensible figures", complaint(bad, WithCells(1.0)));
  bad.PutScalar<double>("map/grid/cell_m", 1e5);
  ExpectIn("take a larger cell_m", complaint(bad, WithCells(0.1)));
  bad = SmallMap();
  bad.PutVector<double>("map/landmark_count", {});
  try {
    CheckInput(bad, "map");  // as before a job starts
    FAIL() << "accepted";
  } catch (const InputError& e) {
    ExpectIn("'map/landmark_count' has the shape [0]", e.what());
  }
  bad = SmallMap();
  bad.Put("map/grid/probability", Array::Of<double>({1, 2, 2}, {0.0, 0.0, 0.0, 0.0}));
  ExpectIn("none of the landmarks", complaint(bad, WithCells(1.0)));
  bad = SmallMap();
  bad.PutScalar<double>("map/grid/origin_x_m", 1000.0);
  Settings boxed = WithCells(1.0);
  boxed.box_m = 50.0;
  ExpectIn("outside box_m", complaint(bad, boxed));
}

const SquareLog kLog{.laps = 4, .side_m = 20.0, .drift_rad_per_m = 0.002};

TEST(LandmarkMap, FromAGivenMapOneIterationIsEnough) {
  const Blob log = kLog.Make();
  const BlobPtr first = MapFrom(log, {.cell_m = 0.5});
  for (const double cell_m : {0.5, 1.0}) {  // another resolution too
    const BlobPtr again = MapFrom(log, {.cell_m = cell_m, .iterations = 1}, first.get());
    const auto was = first->Get<std::int32_t>("robot/0/observations/map_landmark");
    const auto is = again->Get<std::int32_t>("robot/0/observations/map_landmark");
    ASSERT_EQ(again->Get<double>("map/landmark_x_m").size(), 4U);
    for (std::size_t i = 4; i < is.size(); ++i) EXPECT_EQ(is[i], is[i - 4]) << cell_m << " " << was[i];
  }
}

// Turned by a quarter the square is itself: one of four ways to lie in it is as good as the others, but it is
// one.
TEST(LandmarkMap, ARobotWithAnUnknownStartIsFoundInTheGivenMapWhichStaysAsItIs) {
  const BlobPtr first = MapFrom(kLog.Make(), {.cell_m = 0.5});
  const Blob other = SquareLog{.laps = 2, .side_m = 20.0, .seed = 2}.Make();
  const BlobPtr found = MapFrom(other, {.cell_m = 0.5, .iterations = 0, .start = "anywhere"}, first.get());
  EXPECT_TRUE(found->at("map/grid/probability") == first->at("map/grid/probability"));
  EXPECT_TRUE(found->at("map/landmark_x_m") == first->at("map/landmark_x_m"));
  const auto landmark = found->Get<std::int32_t>("robot/0/observations/map_landmark");
  ASSERT_EQ(landmark.size(), 8U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_GE(landmark[i], 0);
    EXPECT_EQ(landmark[i], landmark[i + 4]);
  }
}

// Every heading of the whole map for some steps, not the little that odometry spreads in its first ones.
TEST(LandmarkMap, ARobotThatMayBeAnywhereIsReckonedWithTheWholeMap) {
  const Blob log = kLog.Make();
  const BlobPtr first = MapFrom(log, {.cell_m = 0.5});
  std::map<std::string, double> expected_mb;
  for (const std::string start : {"origin", "anywhere"}) {
    const LandmarkMap pipeline({.cell_m = 0.5, .start = start});
    const Step step = pipeline.Start(MapInputs({{"log", Share(log)}, {"map", first}}));
    expected_mb[start] = step.plan.state().scalars().at("expected/task_mb").d();
  }
  constexpr double kMapCells = 40.0 * 40.0, kHeadings = 72.0;
  EXPECT_GT(expected_mb["anywhere"], kMapCells * kHeadings * sizeof(double) / 1e6);
  EXPECT_GT(expected_mb["anywhere"], 2.0 * expected_mb["origin"]);
}

TEST(LandmarkMap, WithoutIterationsAndMapTheResultIsOdometryWithItsErrors) {
  const Blob log = kLog.Make();
  const BlobPtr result = MapFrom(log, {.cell_m = 0.5, .iterations = 0});
  EXPECT_EQ(result->Get<double>("map/landmark_x_m").size(), 0U);
  EXPECT_EQ(result->Get<double>("history/log_likelihood").size(), 1U);
  const auto covariance = result->Get<double>("robot/0/poses/covariance");
  EXPECT_GT(covariance[covariance.size() - 9], 4.0);
  EXPECT_LT(covariance[0], 0.1);
}

TEST(LandmarkMap, AMapThatCannotBeMeantIsRefused) {
  const Blob log = kLog.Make();
  const BlobPtr first = MapFrom(log, {.cell_m = 0.5});
  Blob far = *first;
  far.PutScalar<double>("map/grid/origin_x_m", 5000.0);
  ExpectIn("another place, or another frame", Complaint(log, {.cell_m = 0.5}, &far));
  Blob aside = *first;  // within reach, but nothing is where the robot goes
  aside.PutScalar<double>("map/grid/origin_x_m", first->Scalar<double>("map/grid/origin_x_m") - 150.0);
  aside.PutScalar<double>("map/grid/origin_y_m", first->Scalar<double>("map/grid/origin_y_m") - 150.0);
  ExpectIn("than if every observation were false", Complaint(log, {.cell_m = 0.5}, &aside));
  ExpectIn("start=anywhere needs the input 'map'", Complaint(log, {.start = "anywhere"}, nullptr));
  ExpectIn("EM starts from it alone", Complaint(log, {.starts = 5}, first.get()));
}

}  // namespace
}  // namespace cairn::landmark_map
