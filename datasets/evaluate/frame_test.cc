#include "datasets/evaluate/frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

// Of a map that is `off_m` wrong, turned and shifted against the truth, which is `scale` times as large.
std::vector<PointPair> PairsIn(double scale, bool exchanged, double off_m = 0.02, int count = 12) {
  const Similarity turned{1, 0.7, 5, -3};
  std::vector<PointPair> pairs;
  for (int i = 0; i < count; ++i) {
    const Point map{9 * std::sin(1.3 * i), 5 * std::cos(2.9 * i)},
        true_m = turned(Point{map.x_m + off_m * std::sin(40 * i), map.y_m + off_m * std::cos(70 * i)});
    const double x = scale * true_m.x_m, y = scale * true_m.y_m;
    pairs.push_back({map, exchanged ? Point{y, x} : Point{x, y}});
  }
  return pairs;
}

TEST(OtherFrame, IsFoundWithItsUnit) {
  for (const auto& [scale, question] :
       {std::pair{1000.0, "divided by 1000 the map's would be 0.0"}, std::pair{1000.0, "in millimetres?"},
        std::pair{3.2808, "are they in feet?"}, std::pair{0.3048, "is the map in feet?"},
        std::pair{0.001, "multiplied by 1000 the map's"}, std::pair{2.0, "are they in another unit?"}}) {
    const auto frame = FindOtherFrame(PairsIn(scale, false));
    ASSERT_TRUE(frame) << scale;
    EXPECT_NEAR(frame->scale / scale, 1, 0.01);
    EXPECT_FALSE(frame->mirrored);
    EXPECT_NEAR(frame->rmse_m, 0.02, 0.01);
    ExpectContains(frame->Text(), question);
  }
}

TEST(OtherFrame, IsFoundWhereItIsMirrored) {
  const auto frame = FindOtherFrame(PairsIn(1, true));
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->mirrored);
  EXPECT_EQ(frame->scale, 1);
  ExpectContains(frame->Text(), "with the true positions mirrored the map's would be 0.0");
  ExpectContains(frame->Text(), "are x and y exchanged, or an axis reversed?");
  const auto both = FindOtherFrame(PairsIn(100, true));
  ASSERT_TRUE(both);
  EXPECT_TRUE(both->mirrored);
  ExpectContains(both->Text(), "divided by 100 and mirrored the map's would be 0.0");
}

TEST(OtherFrame, IsNoneWhereTheMapIsWrongOtherwise) {
  EXPECT_FALSE(FindOtherFrame({}));
  EXPECT_FALSE(FindOtherFrame(PairsIn(1, false)));
  EXPECT_FALSE(FindOtherFrame(PairsIn(1, false, 3)));
  EXPECT_FALSE(FindOtherFrame(PairsIn(1000, false, 6)));
  EXPECT_FALSE(FindOtherFrame(PairsIn(1.2, false)));
  EXPECT_FALSE(FindOtherFrame(PairsIn(1000, false, 0.02, 3)));
}

// The whole map in one point, and the whole truth.
TEST(OtherFrame, IsNoneOfAMapWithoutExtent) {
  std::vector<PointPair> map = PairsIn(1, false, 3), truth = map;
  for (PointPair& pair : map) pair.from = {1e-6 * pair.from.x_m, 1e-6 * pair.from.y_m};
  for (PointPair& pair : truth) pair.to = {1e-6 * pair.to.x_m, 1e-6 * pair.to.y_m};
  EXPECT_FALSE(FindOtherFrame(map));
  EXPECT_FALSE(FindOtherFrame(truth));
}

}  // namespace
}  // namespace cairn::datasets
