#include "datasets/export/local_edges.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "datasets/export/graph_lines.h"
#include "datasets/export/odometry_track.h"
#include "schema/square.h"

namespace cairn::datasets {
namespace {

// local_map's: along_sd, aside_sd and what two nodes half a metre apart err by anyway; across a cut; of
// loops.
constexpr double kAlong_m2_per_m = 1.5e-4, kAcross_m2_per_m = 4.5e-4;
constexpr double kGap_m = 0.3, kJump_m = 2;
constexpr double kLoopAlong_m = 0.15, kLoopAside_m = 0.05;
// Headings are those of the walls, which the path takes as they are.
constexpr double kHeading_rad = 1e-3, kLeast_m = 1e-4;

Eigen::Matrix3d WithHeading(const Eigen::Matrix2d& information) {
  Eigen::Matrix3d all = Eigen::Matrix3d::Zero();
  all.topLeftCorner<2, 2>() = information;
  all(2, 2) = 1 / Square(kHeading_rad);
  return all;
}

// Diagonal in a frame that is turned by `angle_rad`.
Eigen::Matrix2d Turned(double first, double second, double angle_rad) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle_rad).toRotationMatrix();
  return turn * Eigen::Vector2d(first, second).asDiagonal() * turn.transpose();
}

class Motions {
 public:
  Motions(const kinds::LocalMap::Robot& robot, const kinds::Log::Robot& log, const Path& path)
      : cuts_(robot.cuts), path_(path) {
    if (log.HasControls()) track_.emplace(log.odometry, OdometryErrors{});
    double products = 0, squares = 0;
    for (std::size_t i = 0; i + 1 < path.poses.size(); ++i) {
      if (CutAfter(i)) continue;
      const Pose own = Between(path.poses[i], path.poses[i + 1]), said = Said(i);
      products += own.x_m * said.x_m + own.y_m * said.y_m;
      squares += Square(said.x_m) + Square(said.y_m);
    }
    if (squares > 0 && products > 0) metre_ = products / squares;
  }

  std::string Edge(std::size_t i, std::size_t first_id) const {
    const Pose own = Between(path_.poses[i], path_.poses[i + 1]);
    const std::optional<std::string> cut = CutAfter(i);
    Pose motion = cut == "jump" ? own : Said(i);
    if (cut != "jump") {
      motion.x_m *= metre_;
      motion.y_m *= metre_;
    }
    motion.heading_rad = own.heading_rad;
    const double way_m = std::hypot(motion.x_m, motion.y_m);
    const double more_m2 = Square(kLeast_m) + (!cut ? 0 : Square(*cut == "jump" ? kJump_m : kGap_m));
    const Eigen::Matrix2d information =
        Turned(1 / (kAlong_m2_per_m * way_m + more_m2), 1 / (kAcross_m2_per_m * way_m + more_m2),
               std::atan2(motion.y_m, motion.x_m));
    return PoseEdge(first_id + i, first_id + i + 1, motion, WithHeading(information));
  }

 private:
  // What odometry says of the motion from pose `i`; the path's own where there is none.
  Pose Said(std::size_t i) const {
    if (!track_) return Between(path_.poses[i], path_.poses[i + 1]);
    return track_->Between(path_.time_s[i], path_.time_s[i + 1]).pose;
  }
  std::optional<std::string> CutAfter(std::size_t i) const {
    const std::span<const double> time_s = cuts_.time_s.OrNone();
    const auto found = std::ranges::find(time_s, path_.time_s[i]);
    if (found == time_s.end()) return std::nullopt;
    return cuts_.why[static_cast<std::size_t>(found - time_s.begin())];
  }

  const kinds::LocalMap::Cuts& cuts_;
  const Path& path_;
  std::optional<OdometryTrack> track_;
  double metre_ = 1;
};

// A robot's path, and its first vertex.
struct PathVertices {
  const Path* path = nullptr;
  std::size_t first_id = 0;
  // None where the path has no pose of that time.
  std::optional<std::size_t> At(double time_s) const {
    const auto found = std::ranges::lower_bound(path->time_s, time_s);
    if (found == path->time_s.end() || *found != time_s) return std::nullopt;
    return static_cast<std::size_t>(found - path->time_s.begin());
  }
};

std::string LoopEdge(const kinds::LocalMap& map, std::size_t k, const std::vector<PathVertices>& paths) {
  constexpr std::int32_t kLoop = 2;
  const kinds::LocalMap::Connections& loops = map.connections;
  if (loops.kind[k] != kLoop || loops.used[k] == 0) return {};
  const auto trace = static_cast<std::size_t>(loops.from[k]);
  const auto found = std::ranges::find_if(paths, [&](const PathVertices& of) {
    return of.path->index == static_cast<std::size_t>(map.traces.robot[trace]);
  });
  if (found == paths.end()) return {};
  const auto from = found->At(loops.from_s[k]), to = found->At(loops.to_s[k]);
  if (!from || !to) return {};
  const std::vector<Pose>& poses = found->path->poses;
  // Where matching put the robot of the later time, seen from where it recorded the trace.
  const double axis_rad = map.traces.direction_rad[trace];
  Pose there = Compose({map.traces.x_m[trace], map.traces.y_m[trace], axis_rad},
                       {loops.from_z_m[k], loops.from_u_m[k], 0});
  there.heading_rad = poses[*to].heading_rad;
  const bool along_x = std::abs(std::cos(axis_rad)) > 0.5;
  const bool tells_x = loops.tells_x ? loops.tells_x[k] != 0 : true,
             tells_y = loops.tells_y ? loops.tells_y[k] != 0 : true;
  constexpr double kNotTold = 1e-6;
  const auto told = [&](bool tells, double sd_m) {
    return tells ? loops.quality[k] / Square(sd_m) : kNotTold;
  };
  const Eigen::Matrix2d information =
      Turned(told(along_x ? tells_x : tells_y, kLoopAlong_m), told(along_x ? tells_y : tells_x, kLoopAside_m),
             axis_rad - poses[*from].heading_rad);
  return PoseEdge(found->first_id + *from, found->first_id + *to, Between(poses[*from], there),
                  WithHeading(information));
}

}  // namespace

std::string LocalMapEdges(const kinds::LocalMap& map, const kinds::Log& log, const std::vector<Path>& paths) {
  std::string text;
  std::vector<PathVertices> vertices;
  std::size_t id = 0;
  for (const Path& path : paths) {
    const Motions motions(map.robot.at(path.index), log.robot.at(path.index), path);
    for (std::size_t i = 0; i + 1 < path.poses.size(); ++i) text += motions.Edge(i, id);
    vertices.push_back({&path, id});
    id += path.poses.size();
  }
  for (std::size_t k = 0; k < map.connections.kind.OrNone().size(); ++k) text += LoopEdge(map, k, vertices);
  return text;
}

}  // namespace cairn::datasets
