// A robot with sonars that drives among walls, and its local grids, for tests.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "pipelines/local_map/grids/local_grids.h"
#include "pipelines/local_map/testing/room.h"

namespace cairn::local_map {

class Drive {
 public:
  static constexpr double kScanS = 0.2, kSpeedMS = 0.4;

  Drive(std::vector<TestWall> walls, const Pose& start, std::uint64_t seed,
        const GridOptions& options = Fixed())
      : walls_(std::move(walls)),
        pose_(start),
        rng_(seed),
        grids_(options, {SensorRing(RingBeams(), kTestOpeningRad, 6)}) {}

  // Grids that stay along the axes.
  static GridOptions Fixed() {
    GridOptions options;
    options.align = false;
    return options;
  }

  const Pose& pose() const { return pose_; }
  double time_s() const { return time_s_; }
  const LocalGrids& grids() const { return grids_; }
  std::vector<TestWall>& walls() { return walls_; }

  void Scan() {
    time_s_ += kScanS;
    const double turret = 0.5 * std::sin(time_s_);
    const std::vector<double> ranges = SonarScan(walls_, pose_, turret, rng_);
    const std::array scans{RingScan{time_s_, turret, ranges}};
    grids_.Update(pose_, scans);
  }
  void Step(double turn_rad = 0) {
    pose_ = Compose(pose_, {kSpeedMS * kScanS, 0, turn_rad});
    Scan();
  }
  void StepBack() {
    pose_ = Compose(pose_, {-kSpeedMS * kScanS, 0, 0});
    Scan();
  }
  void Ahead(double distance_m) {
    for (double gone = 0; gone < distance_m; gone += kSpeedMS * kScanS) Step();
  }

 private:
  std::vector<TestWall> walls_;
  Pose pose_;
  double time_s_ = 0;
  Rng rng_;
  LocalGrids grids_;
};

}  // namespace cairn::local_map
