#include "datasets/report/drawing/charts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "datasets/testing.h"

namespace cairn::datasets::report {
namespace {

std::size_t Occurrences(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(Thinned, KeepsFewPointsAsTheyAreAndManyByTheMeansOfStretches) {
  const std::vector<ChartPoint> few{{1, 5}, {2, 6}};
  EXPECT_EQ(Thinned(few, 2).size(), 2U);
  std::vector<ChartPoint> many;
  for (int i = 0; i < 1000; ++i) many.push_back({static_cast<double>(i), i < 500 ? 1.0 : 3.0});
  const auto thinned = Thinned(many, 4);
  ASSERT_EQ(thinned.size(), 4U);
  EXPECT_DOUBLE_EQ(thinned[0].x, 124.5);
  EXPECT_DOUBLE_EQ(thinned[1].y, 1.0);
  EXPECT_DOUBLE_EQ(thinned[2].y, 3.0);
}

TEST(LineChart, DrawsEachCurveAndLeavesOutWhatIsNotFinite) {
  Picture picture(400, 200, "x");
  const LineChart chart{
      "Title", "step", "error", {{"a", {{1, 1}, {2, NAN}, {3, 2}}, 0}, {"b", {{1, 2}, {3, 1}}, 1}}};
  EXPECT_TRUE(Draw(chart, {80, 20, 300, 140}, &picture));
  const std::string text = picture.Svg();
  EXPECT_EQ(Occurrences(text, "<polyline"), 2U);
  EXPECT_EQ(Occurrences(text, "nan"), 0U);
}

TEST(LineChart, ALogarithmicAxisLeavesOutZerosAndNamesTheValues) {
  Picture picture(400, 200, "x");
  EXPECT_TRUE(
      Draw({"", "", "", {{"", {{1, 0.0}, {2, 0.01}, {3, 100.0}}, 0}}, true}, {80, 20, 300, 140}, &picture));
  const std::string text = picture.Svg();
  EXPECT_EQ(Occurrences(text, "inf"), 0U);
  EXPECT_EQ(Occurrences(text, ">0.01<"), 1U);
  EXPECT_EQ(Occurrences(text, ">1e+02<"), 1U);
}

TEST(LineChart, SaysWhereThereIsNothingToDraw) {
  Picture picture(400, 200, "x");
  const std::string before = picture.Svg();
  EXPECT_FALSE(Draw({"", "", "", {{"", {{1, NAN}}, 0}}, false}, {80, 20, 300, 140}, &picture));
  EXPECT_EQ(picture.Svg(), before);
}

cv::Mat DecodedChart(const Picture& picture) {
  const std::string png = picture.Png(1);
  return cv::imdecode(std::vector<unsigned char>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

// Rows of the file in which a column shows the second robot's colour, seen through or not.
std::vector<int> CurveRows(const cv::Mat& image, int column) {
  std::vector<int> rows;
  for (int row = 0; row < image.rows; ++row) {
    const cv::Vec3b& pixel = image.at<cv::Vec3b>(row, column);
    if (pixel[2] > 190 && pixel[0] < 120) rows.push_back(row);
  }
  return rows;
}

LineChart Flat(double y) {
  return {.title = {},
          .x_label = "x",
          .y_label = {},
          .curves = {{.name = "flat", .points = {{0, y}, {10, y}}, .colour = 1}},
          .y_low = 0,
          .y_high = 10};
}

TEST(ChartsPicture, ACurveLiesWhereItsValueIs) {
  const cv::Mat low = DecodedChart(ChartsPicture({Flat(2)}, 1, 300, 200)),
                high = DecodedChart(ChartsPicture({Flat(7)}, 1, 300, 200));
  ASSERT_FALSE(low.empty());
  // Of the column in the middle of the plot; the legend lies farther left.
  const int middle = static_cast<int>(kChartLeft) + 200;
  const std::vector<int> low_rows = CurveRows(low, middle), high_rows = CurveRows(high, middle);
  ASSERT_FALSE(low_rows.empty());
  ASSERT_FALSE(high_rows.empty());
  EXPECT_NEAR(low_rows.front() - high_rows.front(), 100, 1);  // 5 of 10, of 200 pixels
}

TEST(ChartsPicture, ABarSpansItsInterval) {
  LineChart chart = Flat(5);
  chart.curves[0].points = {{0, 5}, {5, 5, std::pair(3.0, 8.0)}, {10, 5}};
  const cv::Mat image = DecodedChart(ChartsPicture({chart}, 1, 300, 200));
  const std::vector<int> rows = CurveRows(image, static_cast<int>(kChartLeft) + 150);
  ASSERT_FALSE(rows.empty());
  EXPECT_NEAR(rows.back() - rows.front(), 100, 3);
}

TEST(ChartsPicture, StandInRowsOfColumns) {
  const Picture one = ChartsPicture({Flat(1)}, 2, 100, 80),
                two = ChartsPicture({Flat(1), Flat(2)}, 2, 100, 80),
                three = ChartsPicture({Flat(1), Flat(2), Flat(3)}, 2, 100, 80);
  EXPECT_EQ(one.width(), two.width());
  EXPECT_EQ(one.height(), two.height());
  EXPECT_EQ(two.width(), three.width());
  EXPECT_GT(three.height(), two.height() + 80);
}

// A shape in a file has the colours that its classes have on a page.
TEST(PicturePng, CutsWhatIsClippedAndLaysCellsOverWhatIsThere) {
  Picture picture(40, 20);
  picture.BeginClip({0, 0, 20, 20});
  picture.Rect({0, 0, 40, 20}, "spurious");
  picture.EndClip();
  picture.Image({10, 0, 20, 20}, {1, 1, PngColour::kRgba, {0, 0, 0, 51}});
  const cv::Mat image = DecodedChart(picture);
  ASSERT_EQ(image.size(), cv::Size(40, 20));
  EXPECT_EQ(image.at<cv::Vec3b>(10, 5), cv::Vec3b(30, 38, 179));
  EXPECT_EQ(image.at<cv::Vec3b>(10, 15), cv::Vec3b(24, 30, 143)) << "a fifth of black over it";
  EXPECT_EQ(image.at<cv::Vec3b>(10, 25), cv::Vec3b(204, 204, 204)) << "a fifth of black over paper";
  EXPECT_EQ(image.at<cv::Vec3b>(10, 35), cv::Vec3b(255, 255, 255));
}

}  // namespace
}  // namespace cairn::datasets::report
