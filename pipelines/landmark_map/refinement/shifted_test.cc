#include "pipelines/landmark_map/refinement/shifted.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

// A robot drives along a row of posts 1.5 m beside its way, round a block on which there are none, and along
// them again. It sees half of what lies within 2.5 m.
struct RowLog {
  std::vector<double> post_m = {0, 3, 6, 9, 12, 15, 18, 21};  // from where it starts
  double way_error = 0.02;                                    // odometry's ways are too long by so much
  std::vector<int> post = {};                                 // of each observation

  Blob Make() {
    constexpr double kStep_m = 0.5, kLong_m = 24, kShort_m = 12;
    Rng rng(3);
    std::vector<double> time, turn, forward, seen_s, range, bearing;
    double x = 0, y = 0, heading = 0;
    const std::vector<double> sides = {kLong_m, kShort_m, kLong_m, kShort_m, kLong_m};
    for (std::size_t side = 0; side < sides.size(); ++side) {
      for (int k = 0; k < static_cast<int>(sides[side] / kStep_m); ++k) {
        const double turned = side > 0 && k == 0 ? std::numbers::pi / 2 : 0;
        heading += turned;
        x += kStep_m * std::cos(heading);
        y += kStep_m * std::sin(heading);
        time.push_back(static_cast<double>(time.size() + 1));
        turn.push_back(turned - 0.003 * kStep_m + 0.007 * rng.Normal());
        forward.push_back(kStep_m * (1 + way_error) + 0.01 * rng.Normal());
        for (std::size_t p = 0; p < post_m.size(); ++p) {
          const double dx = post_m[p] - x, dy = 1.5 - y, distance = std::hypot(dx, dy);
          const double ahead = std::remainder(std::atan2(dy, dx) - heading, 2 * std::numbers::pi);
          if (distance > 2.5 || std::abs(ahead) > std::numbers::pi / 2 || time.size() % 2 != 0) continue;
          seen_s.push_back(time.back());
          range.push_back(distance + 0.1 * rng.Normal());
          bearing.push_back(ahead + 0.03 * rng.Normal());
          post.push_back(static_cast<int>(p));
        }
      }
    }
    Blob log;
    log.Put("robots", Array::Texts({"rover"}));
    log.Put("landmarks", Array::Texts({}));
    log.PutVector("robot/0/odometry/time_s", time);
    log.PutVector("robot/0/odometry/turn_rad", turn);
    log.PutVector("robot/0/odometry/forward_m", forward);
    log.PutVector("robot/0/observations/landmark", std::vector<std::int32_t>(seen_s.size(), -1));
    log.PutVector("robot/0/observations/time_s", seen_s);
    log.PutVector("robot/0/observations/range_m", range);
    log.PutVector("robot/0/observations/bearing_rad", bearing);
    return log;
  }
};

BlobPtr MapOfRow(const Blob& log) {
  return RunInProcess(LandmarkMap({.cell_m = 0.2, .starts = 1}),
                      {{"log", std::make_shared<const Blob>(log)}});
}

TEST(WeighShifts, ARowOfPostsFitsAsWellOnePostOn) {
  RowLog row;
  const BlobPtr result = MapOfRow(row.Make());
  ASSERT_TRUE(result->Has("fit/shift_lead_nats"));
  EXPECT_NEAR(result->Scalar<double>("fit/shift_m"), 3, 0.3);
  EXPECT_LT(result->Scalar<double>("fit/shift_lead_nats"), 10);
}

TEST(WeighShifts, PostsAtUnevenDistancesFitInOnePlaceOnly) {
  RowLog row{.post_m = {0, 2, 6, 8.5, 11, 16, 18, 22}};
  const BlobPtr result = MapOfRow(row.Make());
  EXPECT_TRUE(!result->Has("fit/shift_lead_nats") || result->Scalar<double>("fit/shift_lead_nats") > 10);
  EXPECT_EQ(result->Get<double>("map/landmark_x_m").size(), row.post_m.size());
}

// What is seen of posts on two passes along them, from a path that is exact.
std::vector<PlacedRow> TwoPassesAlong(const std::vector<double>& post_m) {
  std::vector<PlacedRow> rows;
  for (int pass = 0; pass < 2; ++pass) {
    for (int k = 0; k < 50; ++k) {
      const double x = 0.5 * k, time_s = 200.0 * pass + k;
      for (std::size_t p = 0; p < post_m.size(); ++p) {
        const double dx = post_m[p] - x;
        if (dx < 0 || std::hypot(dx, 1.5) > 2.5) continue;
        rows.push_back(
            {time_s, {x, 0, 0}, std::hypot(dx, 1.5), std::atan2(1.5, dx), static_cast<std::int32_t>(p)});
      }
    }
  }
  return rows;
}

std::vector<Shift> ShiftsAlong(const std::vector<double>& post_m, double between_m) {
  const std::vector<PlacedRow> rows = TwoPassesAlong(post_m);
  std::vector<double> way_m;
  for (const PlacedRow& row : rows) way_m.push_back(row.from.x_m + (row.time_s < 200 ? 0 : between_m));
  return FindShifts(rows, way_m, 0.15);
}

TEST(FindShifts, AreByOneSpacingWhereTheWayBetweenIsLong) {
  const std::vector<double> even = {1, 4, 7, 10, 13, 16, 19, 22};
  const std::vector<Shift> shifts = ShiftsAlong(even, 80);
  ASSERT_FALSE(shifts.empty());
  EXPECT_NEAR(std::abs(shifts[0].by.x_m), 3, 0.01);
  EXPECT_NEAR(shifts[0].by.y_m, 0, 0.01);
  EXPECT_EQ(shifts[0].meets.size(), 7U);
  EXPECT_GT(shifts[0].behind_nats, 0);
  EXPECT_LT(shifts[0].until_s, 100);
  for (const auto& [one, other] : shifts[0].meets) EXPECT_EQ(std::abs(one - other), 1);
  EXPECT_TRUE(ShiftsAlong(even, 30).empty()) << "odometry does not err by a quarter";
  EXPECT_TRUE(ShiftsAlong({1, 3, 7, 9.5, 12, 17, 19, 23}, 80).empty());
}

}  // namespace
}  // namespace cairn::landmark_map
