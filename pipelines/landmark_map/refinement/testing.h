// What the tests of the least squares share: a world of which odometry and sightings are drawn.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "pipelines/landmark_map/refinement/least_squares.h"
#include "pipelines/landmark_map/refinement/placing.h"
#include "schema/geometry.h"
#include "schema/rng.h"

namespace cairn::landmark_map {

inline constexpr double kDegree = std::numbers::pi / 180.0;

// A robot on a figure of eight among six landmarks, of which it sees one from each node, and what its
// odometry says of that: too much turning by a drift, ways too long by a scale, and noise as the problem's
// widths have it.
struct EightWorld {
  LeastSquaresProblem problem;
  LeastSquaresPoint truth;

  EightWorld(std::uint64_t seed, double drift_rad_per_m, double scale, int nodes = 240) {
    constexpr double kStep_m = 0.5;
    Rng rng(seed);
    problem.widths = {{0.5 * kDegree, 0.01, 0.02}};
    problem.noise = {.contact_m = 0.1, .range_m = 0.1, .bearing_rad = 1.0 * kDegree};
    problem.priors = {1.0 * kDegree, 0.02, 0.02};
    problem.landmarks = 6;
    for (int l = 0; l < 6; ++l)
      truth.landmarks.emplace_back(12.0 * std::cos(l) + 3.0 * rng.Normal(), 8.0 * std::sin(2.0 * l));
    truth.errors = {{drift_rad_per_m, 1.0 / scale - 1.0, 0.0}};
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    NodeTrack track;
    auto& path = truth.nodes.emplace_back();
    for (int k = 0; k < nodes; ++k) {
      if (k > 0) {
        const double turn = 0.12 * std::sin(2.0 * std::numbers::pi * k / 120.0);
        at[2] += turn;
        at[0] += kStep_m * std::cos(at[2]);
        at[1] += kStep_m * std::sin(at[2]);
        const double forward = kStep_m * scale + 0.02 * std::sqrt(kStep_m) * rng.Normal();
        track.controls.push_back(
            {{turn + drift_rad_per_m * kStep_m + 0.5 * kDegree * std::sqrt(kStep_m) * rng.Normal(),
              forward}});
      }
      track.time_s.push_back(k);
      path.push_back(at);
      const Eigen::Vector2d& landmark = truth.landmarks[static_cast<std::size_t>(k % 6)];
      const double range = (landmark - at.head<2>()).norm() + 0.1 * rng.Normal();
      const double bearing =
          std::atan2(landmark.y() - at[1], landmark.x() - at[0]) - at[2] + kDegree * rng.Normal();
      problem.sightings.push_back({0, k, k % 6, range * std::cos(bearing), range * std::sin(bearing)});
    }
    problem.robots = {track};
  }

  LeastSquaresPoint Reckoned() const {
    LeastSquaresPoint point = truth;
    point.errors = {{}};
    point.nodes[0] = DeadReckoned(problem.robots[0], truth.nodes[0][0], {});
    return point;
  }
};

// What a robot sees that drives twice round a room of ten by eight metres, among ten landmarks that the seed
// places, on a path that is exact: each within five metres and sixty degrees from ahead, nine times of ten.
// Its landmarks are `first`, `first` + 1, …; `stream`: of its noise; the room lies at `frame`.
inline constexpr std::size_t kSeenInRoom1 = 9;  // of the ten that seed 1 places
inline std::vector<PlacedRow> DriveThroughRoom(std::uint64_t seed, std::int32_t first = 0,
                                               std::uint64_t stream = 0, const Pose& frame = {}) {
  constexpr int kSteps = 120;
  Rng world(seed), noise(seed, stream + 1);
  std::vector<Point> landmarks;
  for (int l = 0; l < 10; ++l) landmarks.push_back({world.Uniform(0, 10), world.Uniform(0, 8)});
  std::vector<PlacedRow> rows;
  for (int k = 0; k < kSteps; ++k) {
    const double angle = 4 * std::numbers::pi * k / kSteps;
    const Pose at{5 + 3.5 * std::cos(angle), 4 + 2.5 * std::sin(angle), angle + std::numbers::pi / 2};
    for (std::size_t l = 0; l < landmarks.size(); ++l) {
      const double dx = landmarks[l].x_m - at.x_m, dy = landmarks[l].y_m - at.y_m;
      const double range_m = std::hypot(dx, dy), bearing = WrapAngle(std::atan2(dy, dx) - at.heading_rad);
      const double range_error = 0.05 * noise.Normal(), bearing_error = 0.02 * noise.Normal();
      if (noise.Uniform() > 0.9 || range_m > 5 || std::abs(bearing) > 60 * kDegree) continue;
      rows.push_back({1.0 * k, Compose(frame, at), range_m + range_error, bearing + bearing_error,
                      first + static_cast<std::int32_t>(l)});
    }
  }
  return rows;
}

}  // namespace cairn::landmark_map
