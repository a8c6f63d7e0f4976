#include "datasets/reproduce/local/wall_coverage.h"

#include <algorithm>
#include <cmath>

#include "datasets/evaluate/maps/truth.h"
#include "datasets/report/pages/local_pictures.h"
#include "datasets/report/pages/pages.h"

namespace cairn::datasets {
namespace {

constexpr double kReachM = 2;
constexpr float kHitOften = 0.1F;
constexpr double kBetweenM = 1.5;  // of the nearest smooth wall: in the corridor

std::vector<Wall> SmoothWalls(const Blob& log) {
  const auto smooth = log.Get<std::uint8_t>("truth/walls/smooth");
  const std::vector<Wall> all = ReadSegments(log, "truth/walls/", {});
  std::vector<Wall> walls;
  for (std::size_t i = 0; i < std::min(smooth.size(), all.size()); ++i)
    if (smooth[i]) walls.push_back(all[i]);
  return walls;
}

struct ShownWall {
  bool edge = false, hit = false;
};

// Within a cell of a place that is seen from the robot in the grids' frame.
ShownWall ShownAt(const report::LocalSnapshot& shot, Point at) {
  const auto column = std::lround(at.x_m / shot.cell_m) + shot.cells / 2,
             row = std::lround(at.y_m / shot.cell_m) + shot.cells / 2;
  ShownWall shown;
  for (std::int64_t j = row - 1; j <= row + 1; ++j) {
    for (std::int64_t i = column - 1; i <= column + 1; ++i) {
      if (i < 0 || j < 0 || i >= shot.cells || j >= shot.cells) continue;
      const std::size_t cell = shot.Index(i, j);
      shown.edge = shown.edge || !std::isnan(shot.edge_rad[cell]);
      shown.hit = shown.hit || shot.occupancy[cell] >= kHitOften;
    }
  }
  return shown;
}

WallCoverage CoverageAt(const report::LocalSnapshot& shot, const std::vector<Wall>& walls, const Pose& robot,
                        double odometric_heading_rad) {
  const Point here{robot.x_m, robot.y_m};
  WallCoverage coverage;
  const bool between =
      std::ranges::any_of(walls, [&](const Wall& w) { return DistanceToM(w, here) < kBetweenM; });
  if (!between) return coverage;
  const double turn = odometric_heading_rad - shot.frame_rad - robot.heading_rad;
  const double c = std::cos(turn), s = std::sin(turn);
  for (const Wall& wall : walls) {
    const double length_m = DistanceM(wall.a, wall.b);
    const auto steps = static_cast<int>(std::ceil(length_m / shot.cell_m));
    for (int k = 0; k < steps; ++k) {
      const double share = (k + 0.5) / steps;
      const double x = wall.a.x_m + share * (wall.b.x_m - wall.a.x_m) - here.x_m,
                   y = wall.a.y_m + share * (wall.b.y_m - wall.a.y_m) - here.y_m;
      if (std::hypot(x, y) > kReachM) continue;
      const ShownWall shown = ShownAt(shot, {c * x - s * y, s * x + c * y});
      coverage.wall_m += length_m / steps;
      coverage.by_edges_m += shown.edge ? length_m / steps : 0;
      coverage.by_hits_m += shown.hit ? length_m / steps : 0;
      coverage.by_either_m += shown.edge || shown.hit ? length_m / steps : 0;
    }
  }
  return coverage;
}

}  // namespace

void WallCoverage::Add(const WallCoverage& other) {
  wall_m += other.wall_m;
  by_edges_m += other.by_edges_m;
  by_hits_m += other.by_hits_m;
  by_either_m += other.by_either_m;
}

WallCoverage MetallicCoverage(const Blob& result, const Blob& log) {
  const report::LocalResult local = report::ReadLocalResult(result);
  const std::vector<Track> odometry = report::OdometryOf(log);
  const std::vector<Wall> walls = SmoothWalls(log);
  WallCoverage coverage;
  for (const report::LocalSnapshot& shot : local.snapshots) {
    const Track truth = ReadTrack(log, "truth/robot/" + std::to_string(shot.robot) + "/poses/");
    const auto robot = PoseAt(truth, shot.time_s),
               reckoned = PoseAt(odometry.at(shot.robot), shot.time_s, HUGE_VAL);
    if (robot && reckoned) coverage.Add(CoverageAt(shot, walls, *robot, reckoned->heading_rad));
  }
  return coverage;
}

}  // namespace cairn::datasets
