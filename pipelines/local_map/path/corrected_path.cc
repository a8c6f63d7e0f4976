#include "pipelines/local_map/path/corrected_path.h"

#include <cmath>

namespace cairn::local_map {

void Correct(const OrientationTrack& walls, double scale, std::vector<Scan>* scans) {
  Pose before, corrected;
  for (std::size_t s = 0; s < scans->size(); ++s) {
    const Pose now = (*scans)[s].pose;
    const double angle = walls.at[s].angle_rad;
    if (s > 0) {
      const double turn = -(walls.at[s - 1].angle_rad + angle) / 2;
      const double dx = scale * (now.x_m - before.x_m), dy = scale * (now.y_m - before.y_m);
      corrected.x_m += std::cos(turn) * dx - std::sin(turn) * dy;
      corrected.y_m += std::sin(turn) * dx + std::cos(turn) * dy;
    }
    corrected.heading_rad = now.heading_rad - angle;
    before = now;
    (*scans)[s].pose = corrected;
  }
}

}  // namespace cairn::local_map
