// What the tests of landmark_map share: a log made by hand.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "pipelines/testing/in_process.h"
#include "schema/blob.h"
#include "schema/rng.h"

namespace cairn::landmark_map {

// A robot that goes round a square of `side_m` `laps` times in controls of 1 m. It presses a button at each
// corner, or sees the corners by range and bearing; odometry errs by a heading drift and noise.
struct SquareLog {
  int laps = 3;
  double side_m = 10.0;
  bool ranged = false;
  bool identified = false;
  double drift_rad_per_m = 0.0;
  double walk_rad_per_sqrt_m = 0.005;
  std::uint64_t seed = 1;

  Blob Make() const {
    Rng rng(seed);
    std::vector<double> time, turn, forward, seen_s, range, bearing;
    std::vector<std::int32_t> landmark;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    double t = 0;
    const int increments = static_cast<int>(side_m);
    for (int lap = 0; lap < laps; ++lap) {
      for (int corner = 0; corner < 4; ++corner) {
        for (int k = 0; k < increments; ++k) {
          const bool first = k == 0 && (lap > 0 || corner > 0);
          time.push_back(t += 1);
          turn.push_back((first ? std::numbers::pi / 2 : 0.0) + drift_rad_per_m +
                         walk_rad_per_sqrt_m * rng.Normal());
          forward.push_back(1.0 + 0.01 * rng.Normal());
          if (ranged && k == increments / 2)
            See(t, (corner + 1) % 4, side_m - k - 1, &seen_s, &landmark, &range, &bearing);
        }
        if (ranged) continue;
        seen_s.push_back(t);
        landmark.push_back(identified ? (corner + 1) % 4 : -1);
        range.push_back(nan);
        bearing.push_back(nan);
      }
    }
    Blob log;
    log.Put("robots", Array::Texts({"rover"}));
    log.Put("landmarks", identified ? Array::Texts({"a", "b", "c", "d"}) : Array::Texts({}));
    log.PutVector("robot/0/odometry/time_s", time);
    log.PutVector("robot/0/odometry/turn_rad", turn);
    log.PutVector("robot/0/odometry/forward_m", forward);
    log.PutVector("robot/0/observations/time_s", seen_s);
    log.PutVector("robot/0/observations/landmark", landmark);
    log.PutVector("robot/0/observations/range_m", range);
    log.PutVector("robot/0/observations/bearing_rad", bearing);
    return log;
  }

 private:
  void See(double t, int corner, double ahead_m, std::vector<double>* seen_s,
           std::vector<std::int32_t>* landmark, std::vector<double>* range,
           std::vector<double>* bearing) const {
    seen_s->push_back(t);
    landmark->push_back(identified ? corner : -1);
    range->push_back(ahead_m);
    bearing->push_back(0.0);
  }
};

// A robot that goes twice (or more often) round a figure of eight among six posts and sees, exactly to
// `range_m` and `bearing_rad`, those within 12 m that are ahead. Nothing says which is which, but where they
// are `named`, nor how odometry errs.
struct PostsLog {
  double drift_rad_per_m = 3.0 * std::numbers::pi / 180.0;
  double range_m = 0.05, bearing_rad = 0.01;
  double range_offset_m = 0.0;  // by which all ranges are too long
  std::uint64_t seed = 1;
  bool named = false;
  int times = 2;
  // After half of them a post is carried elsewhere; `swapped`: two change names.
  bool moved = false, swapped = false;

  Blob Make() const {
    constexpr double kPosts[][2] = {{3, 4}, {-4, 12}, {8, 9}, {5, -6}, {-6, -4}, {9, -12}};
    constexpr double kRadius_m = 8.0, kStep_m = 0.4;
    const int round = static_cast<int>(2.0 * std::numbers::pi * kRadius_m / kStep_m);
    Rng rng(seed);
    std::vector<double> time, turn, forward, seen_s, range, bearing;
    std::vector<std::int32_t> landmark;
    double x = 0, y = 0, heading = 0;
    for (int k = 0; k < 2 * times * round; ++k) {
      const double turned = (k / round % 2 == 0 ? 1.0 : -1.0) * 2.0 * std::numbers::pi / round;
      heading += turned;
      x += kStep_m * std::cos(heading);
      y += kStep_m * std::sin(heading);
      time.push_back(0.4 * (k + 1));
      turn.push_back(turned + drift_rad_per_m * kStep_m + 0.003 * rng.Normal());
      forward.push_back(kStep_m + 0.005 * rng.Normal());
      for (int p = 0; p < 6; ++p) {
        const bool again = k >= times * round;
        const bool carried = moved && again && p == 2;
        const double post_x = carried ? 13.0 : kPosts[p][0], post_y = carried ? -1.0 : kPosts[p][1];
        const double distance = std::hypot(post_x - x, post_y - y);
        const double ahead =
            std::remainder(std::atan2(post_y - y, post_x - x) - heading, 2.0 * std::numbers::pi);
        if (k % 2 != 0 || distance > 12.0 || std::abs(ahead) > 1.5) continue;
        seen_s.push_back(time.back());
        landmark.push_back(!named ? -1 : swapped && again && p >= 2 && p <= 3 ? 5 - p : p);
        range.push_back(distance + range_offset_m + range_m * rng.Normal());
        bearing.push_back(ahead + bearing_rad * rng.Normal());
      }
    }
    Blob log;
    log.Put("robots", Array::Texts({"rover"}));
    log.Put("landmarks", named ? Array::Texts({"a", "b", "c", "d", "e", "f"}) : Array::Texts({}));
    log.PutVector("robot/0/odometry/time_s", time);
    log.PutVector("robot/0/odometry/turn_rad", turn);
    log.PutVector("robot/0/odometry/forward_m", forward);
    log.PutVector("robot/0/observations/landmark", landmark);
    log.PutVector("robot/0/observations/time_s", seen_s);
    log.PutVector("robot/0/observations/range_m", range);
    log.PutVector("robot/0/observations/bearing_rad", bearing);
    return log;
  }
};

}  // namespace cairn::landmark_map
