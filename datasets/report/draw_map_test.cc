#include "datasets/report/draw_map.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "datasets/evaluate/testing/perfect_result.h"
#include "datasets/simulate/loop.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

cv::Mat Decoded(const std::string& png) {
  return cv::imdecode(std::vector<char>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

int Count(const cv::Mat& image, const cv::Scalar& bgr) {
  cv::Mat mask;
  cv::inRange(image, bgr, bgr, mask);
  return cv::countNonZero(mask);
}

// Of paths: their colours as they are seen through on paper.
const cv::Scalar kTruePath(208, 201, 194), kSecondPath(60, 120, 217), kThirdPath(116, 152, 57),
    kBad(30, 38, 179), kFirstRobot(181, 111, 31), kSecondRobot(26, 96, 210);

TEST(DrawMap, ShowsPathsAndTruthAtTheAskedWidth) {
  const Blob log = SimulateLoop({.difficulty = "paper", .robots = 2, .seed = 2});
  Blob result = PerfectLandmarkMap(log);
  const Evaluation evaluation = Evaluate(result, log);
  const cv::Mat plain = Decoded(DrawMapPng(result, nullptr, nullptr, 900));
  EXPECT_EQ(plain.cols, 900);
  EXPECT_GT(plain.rows, 300);
  EXPECT_EQ(Count(plain, kTruePath), 0);
  EXPECT_GT(Count(plain, kSecondPath), 100);
  EXPECT_EQ(Count(plain, kThirdPath), 0);
  const cv::Mat with_truth = Decoded(DrawMapPng(result, &log, &evaluation, 900));
  EXPECT_GT(Count(with_truth, kTruePath), 100);
  EXPECT_EQ(Count(with_truth, kBad), 0) << "nothing is wrong";
}

TEST(DrawMap, TheLegendsStartHasTheFirstRobotsColourBesideAGridToo) {
  const Blob log = SimulateLoop({.difficulty = "paper", .robots = 2, .seed = 2});
  Blob result = PerfectLandmarkMap(log);
  result.Put("map/grid/probability", Array::Of<double>({1, 2, 2}, std::vector<double>{0, 1, 0, 0.5}));
  result.PutScalar("map/grid/origin_x_m", 0.0);
  result.PutScalar("map/grid/origin_y_m", 0.0);
  result.PutScalar("map/grid/cell_m", 1.0);
  const cv::Mat image = Decoded(DrawMapPng(result, nullptr, nullptr, 900));
  const cv::Mat legend = image.rowRange(0, 80);
  EXPECT_GT(Count(legend, kFirstRobot), 20);
  EXPECT_EQ(Count(legend, kSecondRobot), 0);
  EXPECT_GT(Count(legend, kSecondPath), 10) << "both robots' lines are there";
}

TEST(DrawMap, MarksWhatIsWrong) {
  const Blob log = SimulateLoop({.difficulty = "paper", .robots = 1, .seed = 2});
  Blob result = PerfectLandmarkMap(log);
  const auto x = result.Get<double>("map/landmark_x_m");
  std::vector<double> moved(x.begin(), x.end());
  moved[0] += 2;   // an error line
  moved[1] += 20;  // spurious
  result.PutVector("map/landmark_x_m", moved);
  const Evaluation evaluation = Evaluate(result, log);
  EXPECT_GT(Count(Decoded(DrawMapPng(result, &log, &evaluation)), kBad), 50);
}

TEST(DrawMap, AGridAloneIsGrey) {
  Blob map;
  map.Put(
      "map/grid/probability",
      Array::Of<double>({1, 2, 2}, std::vector<double>{0, 1, std::numeric_limits<double>::quiet_NaN(), 0.5}));
  map.PutScalar("map/grid/origin_x_m", -1.0);
  map.PutScalar("map/grid/origin_y_m", 3.0);
  map.PutScalar("map/grid/cell_m", 0.5);
  const cv::Mat image = Decoded(DrawMapPng(map, nullptr, nullptr, 600));
  const int cell = Count(image, {0, 0, 0});
  EXPECT_GT(cell, 10000);
  // The three other cells are as large, but for the raster over them.
  EXPECT_NEAR(Count(image, {218, 196, 178}), cell, 0.2 * cell) << "unknown";
  EXPECT_NEAR(Count(image, {220, 220, 220}), cell, 0.2 * cell) << "one half";
}

TEST(DrawMap, TheScaleHidesNothingOfTheMap) {
  // Cells of the bottom row and of the top row, the left one and the right one, of which one is a wall.
  std::vector<int> walls;
  for (int wall = 0; wall < 4; ++wall) {
    std::vector<double> probability(4, 0);
    probability[static_cast<std::size_t>(wall)] = 1;
    Blob map;
    map.Put("map/grid/probability", Array::Of<double>({1, 2, 2}, probability));
    map.PutScalar("map/grid/origin_x_m", -1.0);
    map.PutScalar("map/grid/origin_y_m", 3.0);
    map.PutScalar("map/grid/cell_m", 0.5);
    walls.push_back(Count(Decoded(DrawMapPng(map, nullptr, nullptr, 600)), {0, 0, 0}));
  }
  EXPECT_GT(walls[0], 10000);
  for (const int wall : walls) EXPECT_NEAR(wall, walls[0], 0.03 * walls[0]);
}

TEST(DrawMap, RefusesWhatHoldsNothing) {
  ExpectContains(InputErrorOf([] { DrawMapPng(Blob(), nullptr, nullptr); }), "neither a map nor a path");
}

}  // namespace
}  // namespace cairn::datasets
