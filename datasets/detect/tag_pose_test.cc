#include "datasets/detect/tag_pose.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "schema/rng.h"

namespace cairn::datasets {
namespace {

constexpr double kSize_m = 0.16;
const Camera kCamera{600, 610, 320, 240, {-0.3, 0.1, 0.001, -0.002, 0.02, 0, 0, 0}};

// A tag that faces the camera but for a turn.
TagCorners CornersOf(const Eigen::Vector3d& middle, const Eigen::Vector3d& turn) {
  const Eigen::Matrix3d axes = turn.norm() > 0 ? Eigen::AngleAxisd(turn.norm(), turn.normalized()).matrix()
                                               : Eigen::Matrix3d::Identity();
  TagCorners corners;
  const double h = kSize_m / 2;
  const Eigen::Vector3d tag[] = {{-h, h, 0}, {h, h, 0}, {h, -h, 0}, {-h, -h, 0}};
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = kCamera.Project(axes * tag[i] + middle);
  return corners;
}

TEST(Camera, UnprojectsWhatItProjects) {
  const Eigen::Vector3d point(0.4, -0.3, 1.2);
  EXPECT_LT((kCamera.Unproject(kCamera.Project(point)) - point.head<2>() / point.z()).norm(), 1e-9);
}

TEST(LocateTag, FindsWhereItIs) {
  for (const Eigen::Vector3d& turn :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.5, 0.3, 2), Eigen::Vector3d(0, -0.9, 0.1)}) {
    const Eigen::Vector3d middle(0.3, -0.2, 2.5);
    const auto located = LocateTag(CornersOf(middle, turn), kCamera, kSize_m);
    ASSERT_TRUE(located);
    EXPECT_LT((located->middle - middle).norm(), 1e-6);
    EXPECT_LT(located->squares_px2, 1e-9);
  }
}

// Of corners that err by a known amount the errors are, on average, as large as the covariance says (3 for
// three coordinates), and the residuals of two degrees of freedom.
TEST(LocateTag, StatesHowFarOffItIs) {
  Rng rng(3);
  double squares = 0, residuals = 0;
  constexpr int kTags = 2000;
  constexpr double kSd_px = 0.2;
  for (int k = 0; k < kTags; ++k) {
    const Eigen::Vector3d middle(rng.Uniform(-0.5, 0.5), rng.Uniform(-0.3, 0.3), rng.Uniform(1, 2.5));
    TagCorners corners =
        CornersOf(middle, {rng.Uniform(0.4, 0.8), rng.Uniform(-0.5, 0.5), rng.Uniform(-3, 3)});
    for (Eigen::Vector2d& corner : corners) corner += kSd_px * Eigen::Vector2d(rng.Normal(), rng.Normal());
    const auto located = LocateTag(corners, kCamera, kSize_m);
    ASSERT_TRUE(located);
    const Eigen::Vector3d off = located->middle - middle;
    squares += off.dot((kSd_px * kSd_px * located->covariance).inverse() * off);
    residuals += located->squares_px2 / (kSd_px * kSd_px);
  }
  EXPECT_NEAR(squares / kTags, 3, 0.5);
  EXPECT_NEAR(residuals / kTags, 2, 0.6);
}

TEST(LocateTag, CornersOnALineFitNoTag) {
  const TagCorners line = {Eigen::Vector2d(0, 0), {10, 0}, {20, 0}, {30, 0}};
  const auto located = LocateTag(line, kCamera, kSize_m);
  EXPECT_TRUE(!located || located->squares_px2 > 16);
}

}  // namespace
}  // namespace cairn::datasets
