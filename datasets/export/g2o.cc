#include <Eigen/Dense>
#include <cmath>

#include "datasets/common/made_from.h"
#include "datasets/export/export.h"
#include "datasets/export/graph_lines.h"
#include "datasets/export/landmark_edges.h"
#include "datasets/export/local_edges.h"
#include "datasets/export/parts.h"
#include "schema/kinds/landmark_map.h"
#include "schema/kinds/local_map.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {
namespace {

// Below these a covariance is taken to be these: the first robot's first pose is certain.
constexpr double kLeastVarianceM2 = 1e-6;
constexpr double kLeastVarianceRad2 = 1e-6;

Eigen::Matrix3d CovarianceOf(const Path& path, std::size_t i) {
  if (path.covariances.empty()) return Eigen::Matrix3d::Zero();
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(path.covariances.data() + 9 * i);
}

// The path's own motion: with no log there is no other.
std::string OwnEdge(const Path& path, std::size_t i, std::size_t first_id) {
  const Pose& a = path.poses[i];
  Eigen::Matrix3d to_frame = Eigen::Matrix3d::Identity();
  to_frame.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(-a.heading_rad).toRotationMatrix();
  Eigen::Matrix3d covariance =
      to_frame * (CovarianceOf(path, i) + CovarianceOf(path, i + 1)) / 2 * to_frame.transpose();
  covariance.diagonal() += Eigen::Vector3d(kLeastVarianceM2, kLeastVarianceM2, kLeastVarianceRad2);
  return PoseEdge(first_id + i, first_id + i + 1, Between(a, path.poses[i + 1]), covariance.inverse());
}

bool IsLocalMap(const Blob& result) { return result.Has("connections/kind"); }

std::string EdgesOf(const Blob& result, const Blob* log, const std::vector<Path>& paths,
                    G2oLandmarks landmarks) {
  if (log != nullptr) {
    CheckMadeFrom(result, *log);
    const auto of = Read<kinds::Log>(*log);
    return IsLocalMap(result) ? LocalMapEdges(Read<kinds::LocalMap>(result), of, paths)
                              : LandmarkMapEdges(Read<kinds::LandmarkMap>(result), of, paths, landmarks);
  }
  std::string text;
  std::size_t id = 0;
  for (const Path& path : paths) {
    for (std::size_t i = 0; i + 1 < path.poses.size(); ++i) text += OwnEdge(path, i, id);
    id += path.poses.size();
  }
  return text;
}

}  // namespace

Written ExportG2o(const Blob& result, const Blob* log, const std::string& folder, bool replace,
                  G2oLandmarks landmarks) {
  const std::vector<Path> paths = ReadPaths(result);
  std::string vertices, fixed;
  std::size_t id = 0;
  for (const Path& path : paths) {
    // Paths of a local map have frames of their own: nothing ties them.
    if (id == 0 || IsLocalMap(result)) fixed += "FIX " + std::to_string(id) + "\n";
    for (const Pose& pose : path.poses) vertices += PoseVertex(id++, pose);
  }
  for (const MapLandmark& landmark : ReadMapLandmarks(result)) {
    vertices += landmarks == G2oLandmarks::kPoses ? PoseVertex(id, {landmark.at.x_m, landmark.at.y_m, 0})
                                                  : LandmarkVertex(id, landmark.at);
    ++id;
  }
  FolderWriter writer(folder, replace);
  // GTSAM's reader takes two numbers after a FIX, and ends where there is but one.
  writer.Write("graph.g2o", vertices + EdgesOf(result, log, paths, landmarks) + fixed);
  return writer.Finish();
}

}  // namespace cairn::datasets
