// Where a square tag is, by its corners in an image.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace cairn::datasets {

// As CameraInfo of ROS has it: pixels, their centres at whole numbers; x to the right, y down, z ahead.
// `distortion`: k1, k2, p1, p2, k3, k4, k5, k6 of plumb_bob and rational_polynomial.
struct Camera {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<double, 8> distortion{};

  // Of a point in front of it, and back, on the plane z = 1.
  Eigen::Vector2d Project(const Eigen::Vector3d& point) const;
  Eigen::Vector2d Unproject(const Eigen::Vector2d& pixel) const;
};

using TagCorners = std::array<Eigen::Vector2d, 4>;  // in order round the tag; pixels

struct LocatedTag {
  Eigen::Vector3d middle;      // as the camera sees it, m
  Eigen::Matrix3d covariance;  // of it, for corners that err by a pixel
  double squares_px2 = 0;      // what the corners and the pose differ by: of two degrees of freedom
};

// The pose whose corners fit best, by least squares from that of the homography. `size_m`: the edge on which
// the corners lie. Nothing where that leads to none, or behind
// the camera; of corners that are no tag's a pose fits badly.
std::optional<LocatedTag> LocateTag(const TagCorners& corners, const Camera& camera, double size_m);

}  // namespace cairn::datasets
