#include "datasets/detect/tag_pose.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace cairn::datasets {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

Eigen::Vector2d Distorted(const Eigen::Vector2d& at, const std::array<double, 8>& d) {
  const double r2 = at.squaredNorm(), r4 = r2 * r2, r6 = r4 * r2, xy = at.x() * at.y();
  const double radial = (1 + d[0] * r2 + d[1] * r4 + d[4] * r6) / (1 + d[5] * r2 + d[6] * r4 + d[7] * r6);
  return {at.x() * radial + 2 * d[2] * xy + d[3] * (r2 + 2 * at.x() * at.x()),
          at.y() * radial + d[2] * (r2 + 2 * at.y() * at.y()) + 2 * d[3] * xy};
}

// The corners on the tag, its middle at the origin: whichever way round, the middle is the same.
std::array<Eigen::Vector3d, 4> OnTag(double size_m) {
  const double h = size_m / 2;
  return {Eigen::Vector3d(-h, h, 0), {h, h, 0}, {h, -h, 0}, {-h, -h, 0}};
}

// From the homography of the tag's plane to z = 1, its last entry 1.
std::optional<Eigen::Isometry3d> PoseOfHomography(const std::array<Eigen::Vector3d, 4>& tag,
                                                  const TagCorners& seen) {
  Eigen::Matrix<double, 8, 8> equations;
  Eigen::Matrix<double, 8, 1> right;
  for (int i = 0; i < 4; ++i) {
    const auto c = static_cast<std::size_t>(i);
    const double x = tag[c].x(), y = tag[c].y(), u = seen[c].x(), v = seen[c].y();
    equations.row(2 * i) << x, y, 1, 0, 0, 0, -u * x, -u * y;
    equations.row(2 * i + 1) << 0, 0, 0, x, y, 1, -v * x, -v * y;
    right(2 * i) = u;
    right(2 * i + 1) = v;
  }
  const Eigen::Matrix<double, 8, 1> h = equations.fullPivLu().solve(right);
  if (!h.allFinite()) return std::nullopt;
  const Eigen::Vector3d one(h[0], h[3], h[6]), two(h[1], h[4], h[7]), at(h[2], h[5], 1);
  const double scale = 2 / (one.norm() + two.norm());
  if (!std::isfinite(scale)) return std::nullopt;
  Eigen::Matrix3d axes;
  axes << one, two, one.cross(two) * scale;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(scale * axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() = scale * at;
  return pose;
}

}  // namespace

Eigen::Vector2d Camera::Project(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d at = Distorted(point.head<2>() / point.z(), distortion);
  return {fx * at.x() + cx, fy * at.y() + cy};
}

Eigen::Vector2d Camera::Unproject(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d seen((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  constexpr int kSteps = 30;
  Eigen::Vector2d at = seen;
  for (int step = 0; step < kSteps; ++step) at += seen - Distorted(at, distortion);
  return at;
}

std::optional<LocatedTag> LocateTag(const TagCorners& corners, const Camera& camera, double size_m) {
  TagCorners seen;
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = camera.Unproject(corners[i]);
  const auto tag = OnTag(size_m);
  std::optional<Eigen::Isometry3d> pose = PoseOfHomography(tag, seen);
  if (!pose) return std::nullopt;
  // On z = 1 a pixel is 1 / f.
  const Eigen::Vector2d focal(camera.fx, camera.fy);
  Matrix6d normal;
  double squares = 0;
  constexpr int kMostSteps = 50;
  constexpr double kStill = 1e-9;
  for (int step = 0; step < kMostSteps; ++step) {
    normal.setZero();
    Vector6d gradient = Vector6d::Zero();
    squares = 0;
    for (std::size_t i = 0; i < tag.size(); ++i) {
      const Eigen::Vector3d turned = pose->linear() * tag[i], p = turned + pose->translation();
      if (!(p.z() > 0)) return std::nullopt;
      Eigen::Matrix<double, 2, 3> slope;
      slope << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
      Eigen::Matrix<double, 3, 6> moved;  // by a shift, and by a small turn
      moved << Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Zero();
      for (int axis = 0; axis < 3; ++axis) moved.col(3 + axis) = Eigen::Vector3d::Unit(axis).cross(turned);
      const Eigen::Vector2d difference = focal.cwiseProduct(seen[i] - p.head<2>() / p.z());
      const Eigen::Matrix<double, 2, 6> by = focal.asDiagonal() * slope * moved;
      normal += by.transpose() * by;
      gradient += by.transpose() * difference;
      squares += difference.squaredNorm();
    }
    const Vector6d change = normal.fullPivLu().solve(gradient);
    if (!change.allFinite()) return std::nullopt;
    pose->translation() += change.head<3>();
    const double angle = change.tail<3>().norm();
    if (angle > 0)
      pose->linear() = Eigen::AngleAxisd(angle, change.tail<3>() / angle) * pose->linear().eval();
    if (change.norm() < kStill)
      return LocatedTag{pose->translation(), normal.inverse().topLeftCorner<3, 3>(), squares};
  }
  return std::nullopt;
}

}  // namespace cairn::datasets
