#include "datasets/export/landmark_edges.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/export/graph_lines.h"
#include "datasets/export/odometry_track.h"
#include "schema/square.h"

namespace cairn::datasets {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

OdometryErrors ErrorsOf(const kinds::LandmarkMap::Robot& robot, const kinds::Log::Noise& noise) {
  // Where neither the result nor the log tells, as landmark_map takes them to be.
  constexpr double kWalk = 2.1 * kDegree, kTurn = 0.06, kWay = 0.02;
  OdometryErrors errors;
  errors.drift_rad_per_m = robot.heading_drift_rad_per_m.Or(0);
  errors.distance_scale = robot.distance_scale.Or(1);
  errors.turn_scale = robot.turn_scale.Or(1);
  // As the least squares found them; else as EM did; else as the log has them.
  errors.walk_rad_per_sqrt_m = robot.odometry_walk_rad_per_sqrt_m.Or(
      robot.heading_walk_rad_per_sqrt_m.Or(noise.heading_walk_rad_per_sqrt_m.Or(kWalk)));
  errors.turn_rad_per_sqrt_rad =
      robot.odometry_turn_rad_per_sqrt_rad.Or(robot.turn_ratio.Or(noise.turn_ratio.Or(kTurn)));
  errors.way_m_per_sqrt_m = robot.odometry_way_m_per_sqrt_m.Or(noise.forward_ratio.Or(kWay));
  return errors;
}

// Standard deviations.
struct SeenWidths {
  double range_m = 0, bearing_rad = 0, contact_m = 0;
};

SeenWidths WidthsOf(const kinds::LandmarkMap::Fit& fit, const kinds::Log::Noise& noise) {
  constexpr double kLeast = 1e-3;
  const std::vector<std::string> kinds = fit.kind.OrNone();
  const auto width = [&](const char* kind, const Column<double>& stated, double otherwise) {
    const auto found = std::ranges::find(kinds, kind);
    const double of_kind = found == kinds.end() ? stated.Or(otherwise) : fit.found[found - kinds.begin()];
    return std::max(kLeast, of_kind);
  };
  return {width("range", noise.range_m, 0.1), width("bearing", noise.bearing_rad, 0.02),
          width("contact", noise.contact_m, 0.3)};
}

// An observation of a landmark as its vertex has it: in that frame the robot's pose, and the landmark.
struct SeenLandmark {
  std::size_t robot = 0, vertex = 0, landmark = 0;
  double heading_rad = 0;  // the vertex's
  Pose from;
  double range_m = 0, bearing_rad = 0;  // of contact detections 0
  bool contact = false;
  Eigen::Vector2d sd_m;    // along the ray and across it
  Eigen::Vector2d off;     // by which the landmark lies elsewhere, in these
  Eigen::Matrix2d to_ray;  // from the vertex's frame

  Eigen::Vector2d At() const {
    const Pose at = Compose(from, {range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad), 0});
    return {at.x_m, at.y_m};
  }
};

// The observations of one robot that the map was made of.
class Observer {
 public:
  Observer(const kinds::LandmarkMap& map, const kinds::Log& log, const Path& path, std::size_t first_id,
           const OdometryTrack& track)
      : map_(map),
        robot_(map.robot.at(path.index)),
        seen_(log.robot.at(path.index).observations),
        path_(path),
        first_id_(first_id),
        track_(track),
        widths_(WidthsOf(map.fit, log.noise)) {}

  void AddTo(std::vector<SeenLandmark>* all) const {
    if (!robot_.map_landmark) return;
    const std::size_t rows = seen_.time_s.size();
    if (rows != robot_.map_landmark.size())
      throw InputError("'robot/" + std::to_string(path_.index) + "/observations/' has " +
                       std::to_string(rows) + " rows in the log, " +
                       std::to_string(robot_.map_landmark.size()) +
                       " in the result: was it made from this log?");
    for (std::size_t i = 0; i < rows; ++i) {
      const auto after = std::ranges::upper_bound(path_.time_s, seen_.time_s[i]);
      if (!IsOfLandmark(i) || after == path_.time_s.begin()) continue;  // seen before the first pose
      all->push_back(Seen(i, static_cast<std::size_t>(after - path_.time_s.begin()) - 1));
    }
  }

 private:
  // As the refinement takes it.
  bool IsOfLandmark(std::size_t i) const {
    if (robot_.map_landmark[i] < 0) return false;
    const double probability = robot_.probability ? robot_.probability[i] : 1;
    return probability >= 0.5 || (seen_.landmark[i] >= 0 && probability > 0);
  }

  Pose SinceVertex(std::size_t i, double time_s) const {
    if (i + 1 == path_.poses.size()) return track_.Between(path_.time_s[i], time_s).pose;
    return track_.BentTo(Between(path_.poses[i], path_.poses[i + 1]), path_.time_s[i], time_s,
                         path_.time_s[i + 1]);
  }

  SeenLandmark Seen(std::size_t row, std::size_t pose) const {
    SeenLandmark seen;
    seen.robot = path_.index;
    seen.vertex = first_id_ + pose;
    seen.landmark = static_cast<std::size_t>(robot_.map_landmark[row]);
    seen.heading_rad = path_.poses[pose].heading_rad;
    seen.from = SinceVertex(pose, seen_.time_s[row]);
    seen.contact = std::isnan(seen_.range_m[row]);
    seen.sd_m = {widths_.contact_m, widths_.contact_m};
    if (!seen.contact) {
      constexpr double kLeast_m = 1e-3;
      seen.range_m = seen_.range_m[row] - robot_.range_offset_m.Or(0);
      seen.bearing_rad = seen_.bearing_rad[row];
      seen.sd_m = {widths_.range_m, std::max(kLeast_m, widths_.bearing_rad * seen_.range_m[row])};
    }
    const double ray_rad = seen.from.heading_rad + seen.bearing_rad;
    seen.to_ray = Eigen::Rotation2Dd(-ray_rad).toRotationMatrix();
    const Pose there = Between(
        path_.poses[pose], {map_.map.landmark_x_m[seen.landmark], map_.map.landmark_y_m[seen.landmark], 0});
    seen.off = (seen.to_ray * (Eigen::Vector2d(there.x_m, there.y_m) - seen.At())).cwiseQuotient(seen.sd_m);
    return seen;
  }

  const kinds::LandmarkMap& map_;
  const kinds::LandmarkMap::Robot& robot_;
  const kinds::Log::Observations& seen_;
  const Path& path_;
  std::size_t first_id_;
  const OdometryTrack& track_;
  SeenWidths widths_;
};

// As the least squares weighs it in the end.
std::string EdgeTo(const SeenLandmark& seen, const kinds::LandmarkMap::Fit& fit,
                   std::size_t first_landmark_id, G2oLandmarks landmarks) {
  constexpr double kCauchySigmas = 3;  // what older files were made with
  Eigen::Vector2d share(1, 1);
  if (!seen.contact) share << 1 / fit.repeats_along.Or(1), 1 / fit.repeats_across.Or(1);
  const double weight = 1 / (1 + seen.off.cwiseAbs2().dot(share) / Square(fit.tail_sigmas.Or(kCauchySigmas)));
  const Eigen::Vector2d weights = weight * share.cwiseQuotient(seen.sd_m.cwiseAbs2());
  const Eigen::Matrix2d information = seen.to_ray.transpose() * weights.asDiagonal() * seen.to_ray;
  const std::size_t id = first_landmark_id + seen.landmark;
  return landmarks == G2oLandmarks::kPoses
             ? LandmarkPoseEdge(seen.vertex, seen.heading_rad, id, seen.At(), information)
             : LandmarkEdge(seen.vertex, id, seen.At(), information);
}

}  // namespace

std::string LandmarkMapEdges(const kinds::LandmarkMap& map, const kinds::Log& log,
                             const std::vector<Path>& paths, G2oLandmarks landmarks) {
  std::string text;
  std::vector<SeenLandmark> all;
  std::size_t id = 0;
  for (const Path& path : paths) {
    const kinds::LandmarkMap::Robot& robot = map.robot.at(path.index);
    const kinds::Log::Odometry& odometry = log.robot.at(path.index).odometry;
    OdometryErrors errors = ErrorsOf(robot, log.noise);
    // Contact detections alone do not tell it; the path has one all the same.
    if (!robot.distance_scale)
      errors.distance_scale = OdometryTrack(odometry, errors).ScaleOf(path.time_s, path.poses);
    const OdometryTrack track(odometry, errors);
    for (std::size_t i = 0; i + 1 < path.poses.size(); ++i) {
      const OdometryMotion motion = track.Between(path.time_s[i], path.time_s[i + 1]);
      text += PoseEdge(id + i, id + i + 1, motion.pose, motion.covariance.inverse());
    }
    Observer(map, log, path, id, track).AddTo(&all);
    id += path.poses.size();
  }
  for (const SeenLandmark& seen : all) text += EdgeTo(seen, map.fit, id, landmarks);
  return text;
}

}  // namespace cairn::datasets
