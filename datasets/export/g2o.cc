#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "datasets/common/array_text.h"
#include "datasets/export/export.h"
#include "datasets/export/parts.h"
#include "schema/kinds/landmark_map.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {
namespace {

// Below these a covariance is taken to be these: the first robot's first pose is certain.
constexpr double kLeastVarianceM2 = 1e-6;
constexpr double kLeastVarianceRad2 = 1e-6;

std::string Upper(const Eigen::MatrixXd& information) {
  std::string text;
  for (Eigen::Index r = 0; r < information.rows(); ++r) {
    for (Eigen::Index c = r; c < information.cols(); ++c) text += " " + NumberText(information(r, c));
  }
  return text;
}

Eigen::Matrix2d Rotation(double angle_rad) { return Eigen::Rotation2Dd(angle_rad).toRotationMatrix(); }

Eigen::Matrix3d CovarianceOf(const Path& path, std::size_t i) {
  if (path.covariances.empty()) return Eigen::Matrix3d::Zero();
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(path.covariances.data() + 9 * i);
}

std::string EdgeBetween(const Path& path, std::size_t i, std::size_t first_id) {
  const Pose& a = path.poses[i];
  const Pose& b = path.poses[i + 1];
  const Eigen::Vector2d offset = Rotation(-a.heading_rad) * Eigen::Vector2d(b.x_m - a.x_m, b.y_m - a.y_m);
  Eigen::Matrix3d to_frame = Eigen::Matrix3d::Identity();
  to_frame.topLeftCorner<2, 2>() = Rotation(-a.heading_rad);
  Eigen::Matrix3d covariance =
      to_frame * (CovarianceOf(path, i) + CovarianceOf(path, i + 1)) / 2 * to_frame.transpose();
  covariance.diagonal() += Eigen::Vector3d(kLeastVarianceM2, kLeastVarianceM2, kLeastVarianceRad2);
  return fmt::format("EDGE_SE2 {} {} {} {} {}{}\n", first_id + i, first_id + i + 1, NumberText(offset.x()),
                     NumberText(offset.y()), NumberText(WrapAngle(b.heading_rad - a.heading_rad)),
                     Upper(covariance.inverse()));
}

double Nominal(const Column<double>& figure, double otherwise) {
  return figure ? std::max(figure.Scalar(), 1e-3) : otherwise;
}

// A landmark as seen from `robot`, a pose in a vertex's frame, and the information of that, in that frame.
std::string Seen(const Pose& robot, double range_m, double bearing_rad, const kinds::Log::Noise& noise) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Identity() * std::pow(Nominal(noise.contact_m, 0.5), -2);
  Pose at = robot;
  if (!std::isnan(range_m)) {
    const double across = std::max(range_m, 0.1) * Nominal(noise.bearing_rad, 0.02);
    const Eigen::Vector2d weights(std::pow(Nominal(noise.range_m, 0.1), -2), std::pow(across, -2));
    const Eigen::Matrix2d along = Rotation(robot.heading_rad + bearing_rad);
    information = along * weights.asDiagonal() * along.transpose();
    at = Compose(robot, {range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad), 0});
  }
  return NumberText(at.x_m) + " " + NumberText(at.y_m) + Upper(information);
}

// Where the robot was at `time_s`, as vertex `i`, the last one before, has it.
Pose SinceVertex(const Path& path, std::size_t i, double time_s) {
  if (i + 1 == path.poses.size() || path.time_s[i + 1] <= path.time_s[i]) return {};
  const double share = (time_s - path.time_s[i]) / (path.time_s[i + 1] - path.time_s[i]);
  return Between(path.poses[i], Interpolate(path.poses[i], path.poses[i + 1], share));
}

// Edges from a robot's poses, the first of which is vertex `first_id`, to landmarks.
std::string LandmarkEdges(const kinds::LandmarkMap& map, const kinds::Log& log, const Path& path,
                          std::size_t first_id, std::size_t first_landmark_id, std::size_t landmarks) {
  const std::span<const std::int32_t> landmark = map.robot.at(path.index).map_landmark.OrNone();
  if (!map.robot[path.index].map_landmark) return {};
  const kinds::Log::Observations& seen = log.robot.at(path.index).observations;
  const std::span<const double> time = seen.time_s, range = seen.range_m, bearing = seen.bearing_rad;
  if (time.size() != landmark.size())
    throw InputError("'robot/" + std::to_string(path.index) + "/observations/' has " +
                     std::to_string(time.size()) + " rows in the log, " + std::to_string(landmark.size()) +
                     " in the result: was it made from this log?");
  std::string text;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (landmark[i] < 0 || static_cast<std::size_t>(landmark[i]) >= landmarks) continue;
    const auto after = std::ranges::upper_bound(path.time_s, time[i]);
    if (after == path.time_s.begin()) continue;  // seen before the first pose
    const auto pose = static_cast<std::size_t>(after - path.time_s.begin()) - 1;
    text += "EDGE_SE2_XY " + std::to_string(first_id + pose) + " " +
            std::to_string(first_landmark_id + static_cast<std::size_t>(landmark[i])) + " " +
            Seen(SinceVertex(path, pose, time[i]), range[i], bearing[i], log.noise) + "\n";
  }
  return text;
}

}  // namespace

Written ExportG2o(const Blob& result, const Blob* log, const std::string& folder, bool replace) {
  const std::vector<Path> paths = ReadPaths(result);
  const std::vector<MapLandmark> landmarks = ReadMapLandmarks(result);
  std::size_t poses = 0;
  for (const Path& path : paths) poses += path.poses.size();
  std::string vertices, edges;
  std::size_t id = 0;
  for (const Path& path : paths) {
    for (std::size_t i = 0; i + 1 < path.poses.size(); ++i) edges += EdgeBetween(path, i, id);
    if (log != nullptr)
      edges += LandmarkEdges(Read<kinds::LandmarkMap>(result), Read<kinds::Log>(*log), path, id, poses,
                             landmarks.size());
    for (const Pose& pose : path.poses) {
      vertices += fmt::format("VERTEX_SE2 {} {} {} {}\n", id++, NumberText(pose.x_m), NumberText(pose.y_m),
                              NumberText(pose.heading_rad));
    }
  }
  for (const MapLandmark& landmark : landmarks) {
    vertices +=
        fmt::format("VERTEX_XY {} {} {}\n", id++, NumberText(landmark.at.x_m), NumberText(landmark.at.y_m));
  }
  FolderWriter writer(folder, replace);
  writer.Write("graph.g2o", vertices + "FIX 0\n" + edges);
  return writer.Finish();
}

}  // namespace cairn::datasets
