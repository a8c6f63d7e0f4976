// Whether a laser saw the same walls each time the robot passed a place, where the path has them. A path that
// closes a wrong loop, or misses one, draws a place twice: the walls of one pass stand in what the other
// looked through.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/local_map/grids/ring.h"
#include "pipelines/local_map/path/pairs.h"
#include "pipelines/local_map/path/pose_graph.h"
#include "pipelines/local_map/path/scale_watch.h"
#include "pipelines/local_map/path/scan_motion.h"
#include "pipelines/pipeline.h"
#include "schema/geometry.h"

namespace cairn::local_map {

// Two scans of different passes, near each other by the path.
struct Passing {
  std::int64_t from = 0, to = 0;  // scans
  double through = 0;             // share of the hits of `to` that lie in what `from` looked through
  bool doubled = false;           // that is much, and both meet well where `to` lies elsewhere:
  Point off;                      // by so much, in the path's frame
  static void Fields(const auto& field) {
    field("from", &Passing::from);
    field("to", &Passing::to);
    field("through", &Passing::through);
    field("doubled", &Passing::doubled);
    field("off", &Passing::off);
  }
};

// What a scan says of the room, in the robot's frame.
struct PassView {
  std::int64_t scan = 0;
  Pose pose;  // on the path
  double path_m = 0;
  Point origin;             // of the beams
  std::vector<Point> hits;  // some, spread over the scan
  // Of each half degree: how far it looked at least and at most, within some degrees, by the beams that are
  // not lost; 0: not known, for there it met nothing.
  std::vector<float> low_m, high_m;
};

// The robot at `to` of each that is doubled lies where both meet: by so much elsewhere than the nodes have
// it. Throws InputError where they are of other scans.
std::vector<LoopConstraint> MakePassConstraints(const std::vector<Passing>& passes, std::size_t robot,
                                                const std::vector<PathNode>& nodes);

class PassWatch {
 public:
  explicit PassWatch(const ScaleWatch::Ring& laser);

  // Scans in order of time; of those nearer to the last that was taken than half a metre of way none is.
  void Add(std::int64_t scan, const Pose& pose, double path_m, const RingScan& read);

  // Each scan that was taken with one of each other pass within some metres, in both orders.
  std::vector<Passing> Compare(Progress& progress) const;

 private:
  void Look(const LaserView& seen, PassView* view) const;

  std::vector<Pose> beams_;
  LaserFan fan_;
  std::vector<PassView> taken_;
};

}  // namespace cairn::local_map
