// Where a robot was by its odometry, at any time.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "schema/geometry.h"
#include "schema/kinds/log.h"
#include "schema/kinds/odometry_steps.h"

namespace cairn::datasets {

// Dead reckoning by odometry that means something else than it says; and what a sensor sees that is turned.
struct Reading {
  double forward = 1, turn = 1, delay_s = 0, sensor_rad = 0;
  bool steps_are_arcs = false;
};

class Reckoning {
 public:
  explicit Reckoning(const kinds::Log::Odometry& odometry, const Reading& reading = {})
      : time_s_(odometry.time_s), delay_s_(reading.delay_s) {
    Pose pose;
    double driven = 0, turned = 0;
    const Walked<double> turns = odometry.turn_rad.values(), ways = odometry.forward_m.values(),
                         times = time_s_;
    for (std::size_t i = 0; i < time_s_.size(); ++i) {
      const double turn = reading.turn * odometry.turn_rad[i], way = reading.forward * odometry.forward_m[i];
      const bool is_arc = reading.steps_are_arcs && IsStep(times, turns, ways, i);
      pose = Compose(pose, {0, 0, is_arc ? turn / 2 : turn});
      pose = Compose(pose, {is_arc ? ChordOfArc(way, turn) : way, 0, is_arc ? turn / 2 : 0});
      poses_.push_back(pose);
      driven_m_.push_back(driven += std::abs(odometry.forward_m[i]));
      turned_rad_.push_back(turned += std::abs(odometry.turn_rad[i]));
    }
  }

  Pose At(double time_s) const {
    const auto [i, share] = Place(time_s + delay_s_);
    const Pose &a = poses_[i], &b = poses_[std::min(i + 1, poses_.size() - 1)];
    return {std::lerp(a.x_m, b.x_m, share), std::lerp(a.y_m, b.y_m, share),
            std::lerp(a.heading_rad, b.heading_rad, share)};
  }
  double DrivenM(double time_s) const { return Of(driven_m_, time_s); }
  double TurnedRad(double time_s) const { return Of(turned_rad_, time_s); }

 private:
  std::pair<std::size_t, double> Place(double time_s) const {
    const auto after = std::ranges::upper_bound(time_s_, time_s);
    if (after == time_s_.begin()) return {0, 0};
    const auto i = static_cast<std::size_t>(after - time_s_.begin()) - 1;
    if (i + 1 >= time_s_.size()) return {i, 0};
    return {i, (time_s - time_s_[i]) / (time_s_[i + 1] - time_s_[i])};
  }
  double Of(const std::vector<double>& sums, double time_s) const {
    const auto [i, share] = Place(time_s);
    return std::lerp(sums[i], sums[std::min(i + 1, sums.size() - 1)], share);
  }

  std::span<const double> time_s_;
  double delay_s_;
  std::vector<Pose> poses_;
  std::vector<double> driven_m_, turned_rad_;
};

}  // namespace cairn::datasets
