// Lines of g2o's text format.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "schema/geometry.h"

namespace cairn::datasets {

// `to` as seen from `from`, and the information of that, of x, y and heading in the frame of `from`. g2o
// counts an edge's error in the frame where it says that `to` is: the line has it there.
std::string PoseEdge(std::size_t from, std::size_t to, const Pose& seen, const Eigen::Matrix3d& information);
std::string LandmarkEdge(std::size_t from, std::size_t to, const Eigen::Vector2d& seen,
                         const Eigen::Matrix2d& information);
// The same of a landmark that is a pose of heading 0, seen from one of heading `from_heading_rad`: it counts
// as much where they lie so, and of headings next to nothing (not nothing, which GTSAM refuses).
std::string LandmarkPoseEdge(std::size_t from, double from_heading_rad, std::size_t to,
                             const Eigen::Vector2d& seen, const Eigen::Matrix2d& information);
std::string PoseVertex(std::size_t id, const Pose& pose);
std::string LandmarkVertex(std::size_t id, Point at);

}  // namespace cairn::datasets
