#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "datasets/common/array_text.h"
#include "datasets/export/export.h"
#include "datasets/export/parts.h"

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

double NoiseParameter(const Blob& log, const char* name, double otherwise) {
  return log.Has(name) ? std::max(log.Scalar<double>(name), 1e-3) : otherwise;
}

// A landmark as seen from a pose, and the information of that.
std::string Seen(double range_m, double bearing_rad, const Blob& log) {
  Eigen::Matrix2d information =
      Eigen::Matrix2d::Identity() * std::pow(NoiseParameter(log, "noise/contact_m", 0.5), -2);
  if (std::isnan(range_m)) return "0 0" + Upper(information);
  const double across = std::max(range_m, 0.1) * NoiseParameter(log, "noise/bearing_rad", 0.02);
  const Eigen::Vector2d weights(std::pow(NoiseParameter(log, "noise/range_m", 0.1), -2),
                                std::pow(across, -2));
  information = Rotation(bearing_rad) * weights.asDiagonal() * Rotation(bearing_rad).transpose();
  return NumberText(range_m * std::cos(bearing_rad)) + " " + NumberText(range_m * std::sin(bearing_rad)) +
         Upper(information);
}

// Edges from a robot's poses, the first of which is vertex `first_id`, to landmarks.
std::string LandmarkEdges(const Blob& result, const Blob& log, const Path& path, std::size_t first_id,
                          std::size_t first_landmark_id, std::size_t landmarks) {
  const std::string prefix = "robot/" + std::to_string(path.index) + "/observations/";
  if (!result.Has(prefix + "map_landmark")) return {};
  const auto landmark = result.Get<std::int32_t>(prefix + "map_landmark");
  const auto time = log.Get<double>(prefix + "time_s");
  const auto range = log.Get<double>(prefix + "range_m");
  const auto bearing = log.Get<double>(prefix + "bearing_rad");
  if (time.size() != landmark.size())
    throw InputError(fmt::format("'{}' has {} rows in the log, {} in the result: was it made from this log?",
                                 prefix, time.size(), landmark.size()));
  std::string text;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (landmark[i] < 0 || static_cast<std::size_t>(landmark[i]) >= landmarks) continue;
    const auto after = std::ranges::upper_bound(path.time_s, time[i]);
    if (after == path.time_s.begin()) continue;  // seen before the first pose
    const auto pose = static_cast<std::size_t>(after - path.time_s.begin()) - 1;
    text += fmt::format("EDGE_SE2_XY {} {} {}\n", first_id + pose,
                        first_landmark_id + static_cast<std::size_t>(landmark[i]),
                        Seen(range[i], bearing[i], log));
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
    if (log != nullptr) edges += LandmarkEdges(result, *log, path, id, poses, landmarks.size());
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
