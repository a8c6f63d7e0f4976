#include "datasets/reproduce/panels.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

namespace cairn::datasets::report {
namespace {

cv::Mat DecodedPanel(const std::string& png) {
  return cv::imdecode(std::vector<unsigned char>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

// A belief of two cells on a panel of 10 m: one certain, one a quarter as likely.
PanelPicture Belief() {
  PanelPicture picture;
  picture.title = "t";
  picture.density = Grid{{0, 0}, 5, 2, 1, {1.0, 0.25}};
  return picture;
}

TEST(Panels, TheDarkerTheLikelierByTheRoot) {
  const cv::Mat image = DecodedPanel(DrawPanels({Belief()}, {0, 10, 0, 5}, 1));
  ASSERT_FALSE(image.empty());
  const int y = image.rows / 2, left = image.cols / 4, right = 3 * image.cols / 4;
  const int dark = image.at<cv::Vec3b>(y, left)[2], light = image.at<cv::Vec3b>(y, right)[2];
  EXPECT_EQ(dark, 36);                      // the full colour's red
  EXPECT_NEAR(light, 0.5 * (36 + 255), 1);  // half of it: the root of a quarter
}

TEST(Panels, PanelsStandInRowsOfColumns) {
  const Box box{0, 10, 0, 5};
  const cv::Mat one = DecodedPanel(DrawPanels({Belief()}, box, 2));
  const cv::Mat two = DecodedPanel(DrawPanels({Belief(), Belief()}, box, 2));
  const cv::Mat three = DecodedPanel(DrawPanels({Belief(), Belief(), Belief()}, box, 2));
  EXPECT_EQ(one.size(), two.size());
  EXPECT_EQ(two.cols, three.cols);
  EXPECT_GT(three.rows, 1.5 * two.rows);
}

TEST(Panels, TheBoundsHoldWhatIsDrawnAndDensitiesWhereThereIsNothingElse) {
  PanelPicture path;
  path.paths = {{{-3, 1}, {7, 2}}};
  path.density = Grid{{100, 100}, 1, 1, 1, {1.0}};
  const Box box = BoundsOf({path});
  EXPECT_LT(box.x_low_m, -3);
  EXPECT_GT(box.x_high_m, 7);
  EXPECT_LT(box.x_high_m, 20);
  EXPECT_GT(BoundsOf({Belief()}).x_high_m, 10);
  EXPECT_GT(Around(box, BoundsOf({Belief()})).y_high_m, 5);
}

TEST(Panels, CellsHaveTheirColours) {
  PanelPicture picture;
  picture.cells = CellPicture{{0, 0, 5, 2, 1}, {0, 0, 0, 255, 255, 255}};
  const cv::Mat image = DecodedPanel(DrawPanels({picture}, {0, 10, 0, 5}, 1));
  const int y = image.rows / 2;
  EXPECT_EQ(image.at<cv::Vec3b>(y, image.cols / 4), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(image.at<cv::Vec3b>(y, image.cols * 9 / 16), cv::Vec3b(255, 255, 255));
}

}  // namespace
}  // namespace cairn::datasets::report
