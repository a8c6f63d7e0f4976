#include "datasets/export/graph_lines.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "datasets/common/array_text.h"

namespace cairn::datasets {
namespace {

// The upper triangle, row by row.
std::string Upper(const Eigen::MatrixXd& information) {
  std::string text;
  for (Eigen::Index r = 0; r < information.rows(); ++r) {
    for (Eigen::Index c = r; c < information.cols(); ++c) text += " " + NumberText(information(r, c));
  }
  return text;
}

}  // namespace

std::string PoseEdge(std::size_t from, std::size_t to, const Pose& seen, const Eigen::Matrix3d& information) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(seen.heading_rad).toRotationMatrix();
  return fmt::format("EDGE_SE2 {} {} {} {} {}{}\n", from, to, NumberText(seen.x_m), NumberText(seen.y_m),
                     NumberText(WrapAngle(seen.heading_rad)), Upper(turn.transpose() * information * turn));
}

std::string LandmarkEdge(std::size_t from, std::size_t to, const Eigen::Vector2d& seen,
                         const Eigen::Matrix2d& information) {
  return fmt::format("EDGE_SE2_XY {} {} {} {}{}\n", from, to, NumberText(seen.x()), NumberText(seen.y()),
                     Upper(information));
}

std::string LandmarkPoseEdge(std::size_t from, double from_heading_rad, std::size_t to,
                             const Eigen::Vector2d& seen, const Eigen::Matrix2d& information) {
  constexpr double kOfHeading_m2_per_rad2 = 1e-6;  // GTSAM's Cholesky takes what is 1.6e7 times less for none
  Eigen::Matrix3d all = Eigen::Matrix3d::Zero();
  all.topLeftCorner<2, 2>() = information;
  all(2, 2) = kOfHeading_m2_per_rad2 * information.trace();
  return PoseEdge(from, to, {seen.x(), seen.y(), -from_heading_rad}, all);
}

std::string PoseVertex(std::size_t id, const Pose& pose) {
  return fmt::format("VERTEX_SE2 {} {} {} {}\n", id, NumberText(pose.x_m), NumberText(pose.y_m),
                     NumberText(pose.heading_rad));
}

std::string LandmarkVertex(std::size_t id, Point at) {
  return fmt::format("VERTEX_XY {} {} {}\n", id, NumberText(at.x_m), NumberText(at.y_m));
}

}  // namespace cairn::datasets
