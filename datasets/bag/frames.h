// Where frames lie on each other, by tf's messages; in space.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/import/pose_controls.h"
#include "schema/geometry.h"
#include "schema/store/spooled_rows.h"

namespace cairn::datasets::bag {

struct Transform {
  double x = 0, y = 0, z = 0;             // metres
  double qx = 0, qy = 0, qz = 0, qw = 1;  // of length 1
  double Yaw() const;                     // of its x axis, seen from above
  Pose Planar() const { return {x, y, Yaw()}; }
  bool IsLevel() const { return qx == 0 && qy == 0; }  // turned about z alone
};
// T_a_c of T_a_b and T_b_c.
Transform Compose(const Transform& ab, const Transform& bc);
Transform Inverse(const Transform& transform);
// Nothing where its numbers are not finite, or the rotation is none: its length is not 1.
std::optional<Transform> MakeTransform(double x, double y, double z, double qx, double qy, double qz,
                                       double qw);

// A point that lies on the first, as its `transform` has it on the second.
struct PointInSpace {
  double x = 0, y = 0, z = 0;
};
inline PointInSpace Apply(const Transform& t, const PointInSpace& p) {
  // p + 2 w (v x p) + 2 v x (v x p), v the rotation's vector.
  const double cx = t.qy * p.z - t.qz * p.y, cy = t.qz * p.x - t.qx * p.z, cz = t.qx * p.y - t.qy * p.x;
  return {t.x + p.x + 2 * (t.qw * cx + t.qy * cz - t.qz * cy),
          t.y + p.y + 2 * (t.qw * cy + t.qz * cx - t.qx * cz),
          t.z + p.z + 2 * (t.qw * cz + t.qx * cy - t.qy * cx)};
}

// "/base_link" as "base_link".
std::string FrameName(std::string_view name);

class FrameTree {
 public:
  FrameTree() = default;
  // Where paths lie that are long.
  explicit FrameTree(std::filesystem::path folder) : folder_(std::move(folder)) {}
  // Of a message: of the same two frames the first counts for their place on each other, and whether others
  // lie elsewhere. Throws Damage for more than 10,000 frames.
  void Add(const std::string& parent, const std::string& child, double time_s, const Transform& transform);

  struct Mount {
    Transform transform;             // of `frame` on `base`
    std::vector<std::string> moves;  // frames between them that do not stand still on their parent
  };
  // Nothing where no chain of transforms leads from one to the other.
  std::optional<Mount> Find(const std::string& base, const std::string& frame) const;
  bool Knows(const std::string& frame) const;
  std::size_t size() const { return frames_.size(); }

  using Links = std::vector<std::pair<std::string, std::string>>;  // a parent, and a frame on it
  // Frames that move on a frame called `parent` ("odom", "robot1/odom"); where some of them are called
  // "`robot`/…", these.
  Links MovingOn(const std::string& parent, const std::string& robot) const;
  // What is known of such a frame's path, in the order of messages.
  const SpooledRows<TimedPose>& TrackOf(const std::string& child) const;
  void ForgetTracks();  // how frames lie on each other stays known

 private:
  struct Frame {
    std::string parent;
    Transform first;
    bool moves = false;
    SpooledRows<TimedPose> track;  // where its parent is called odom or map
  };
  // From `frame` upwards, itself first.
  std::vector<std::string> ChainOf(const std::string& frame) const;
  std::filesystem::path folder_;
  std::map<std::string, Frame> frames_;  // by name
};

}  // namespace cairn::datasets::bag
