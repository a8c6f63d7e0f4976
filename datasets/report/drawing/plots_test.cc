#include "datasets/report/drawing/plots.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

namespace cairn::datasets::report {
namespace {

cv::Mat DecodedPlot(const std::string& png) {
  return cv::imdecode(std::vector<unsigned char>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

bool IsRed(const cv::Vec3b& pixel) { return pixel[2] > 200 && pixel[0] < 60 && pixel[1] < 60; }

// Rows of the file in which a column shows red.
std::vector<int> RedRows(const cv::Mat& image, int column) {
  std::vector<int> rows;
  for (int row = 0; row < image.rows; ++row) {
    if (IsRed(image.at<cv::Vec3b>(row, column))) rows.push_back(row);
  }
  return rows;
}

Plot Flat(double y) {
  Plot plot;
  plot.x_label = "x";
  plot.y_low = 0;
  plot.y_high = 10;
  plot.series = {{.name = "red", .points = {{0, y, {}}, {10, y, {}}}, .colour = {255, 0, 0}}};
  return plot;
}

TEST(Plots, ACurveLiesWhereItsValueIs) {
  const PlotLayout layout{.columns = 1, .width = 300, .height = 200};
  const cv::Mat low = DecodedPlot(DrawPlots({Flat(2)}, layout)),
                high = DecodedPlot(DrawPlots({Flat(7)}, layout));
  ASSERT_FALSE(low.empty());
  // Of the column in the middle of the plot; the legend lies farther left.
  const std::vector<int> low_rows = RedRows(low, 262), high_rows = RedRows(high, 262);
  ASSERT_FALSE(low_rows.empty());
  ASSERT_FALSE(high_rows.empty());
  EXPECT_NEAR(low_rows.front() - high_rows.front(), 100, 1);  // 5 of 10, of 200 pixels
}

TEST(Plots, ABarSpansItsInterval) {
  Plot plot = Flat(5);
  plot.series[0].points = {{0, 5, {}}, {5, 5, std::pair(3.0, 8.0)}, {10, 5, {}}};
  const cv::Mat image = DecodedPlot(DrawPlots({plot}, {.columns = 1, .width = 300, .height = 200}));
  const std::vector<int> rows = RedRows(image, 62 + 150);
  ASSERT_FALSE(rows.empty());
  EXPECT_NEAR(rows.back() - rows.front(), 100, 3);
}

TEST(Plots, StandInRowsOfColumns) {
  const PlotLayout layout{.columns = 2, .width = 100, .height = 80};
  const cv::Mat one = DecodedPlot(DrawPlots({Flat(1)}, layout)),
                two = DecodedPlot(DrawPlots({Flat(1), Flat(2)}, layout)),
                three = DecodedPlot(DrawPlots({Flat(1), Flat(2), Flat(3)}, layout));
  EXPECT_EQ(one.size(), two.size());
  EXPECT_EQ(two.cols, three.cols);
  EXPECT_GT(three.rows, two.rows + 80);
}

}  // namespace
}  // namespace cairn::datasets::report
