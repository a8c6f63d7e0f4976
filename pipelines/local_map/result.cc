#include "pipelines/local_map/result.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace cairn::local_map {
namespace {

constexpr double kTurn_rad = std::numbers::pi / 2;

struct SideColumns {
  std::vector<float> angle_low, angle_high, distance_low, distance_high, cross;
  std::vector<std::uint8_t> occupied;

  void Add(const Side& side) {
    angle_low.push_back(side.angle_rad.low);
    angle_high.push_back(side.angle_rad.high);
    distance_low.push_back(side.distance_m.low);
    distance_high.push_back(side.distance_m.high);
    cross.push_back(side.cross_m);
    occupied.push_back(side.occupied);
  }
  void Put(const std::string& prefix, Blob* result) const {
    result->PutVector(prefix + "angle_low_rad", angle_low);
    result->PutVector(prefix + "angle_high_rad", angle_high);
    result->PutVector(prefix + "distance_low_m", distance_low);
    result->PutVector(prefix + "distance_high_m", distance_high);
    result->PutVector(prefix + "cross_m", cross);
    result->PutVector(prefix + "occupied", occupied);
  }
};

struct ConnectionColumns {
  std::vector<std::int32_t> from, to, kind;
  std::vector<double> from_s, to_s, from_z, from_u, to_z, to_u, quality;
  std::vector<std::uint8_t> used;
};

// Where the optimized path has a point, in a trace's frame.
Position OnTrace(const Parts& parts, std::size_t t, const Point& at) {
  const RecordedTrace& trace = parts.traces[t];
  const Point by = MovedBy(trace, parts.nodes);
  return trace.frame.At({at.x_m - by.x_m, at.y_m - by.y_m}, trace.trace.cell_m());
}

void Add(const Parts& parts, std::size_t from, std::size_t to, int kind, const Scan& at_from,
         const Scan& at_to, double quality, bool used, ConnectionColumns* c) {
  const Position there = OnTrace(parts, from, {at_from.pose.x_m, at_from.pose.y_m});
  const Position here = OnTrace(parts, to, {at_to.pose.x_m, at_to.pose.y_m});
  c->from.push_back(static_cast<std::int32_t>(from));
  c->to.push_back(static_cast<std::int32_t>(to));
  c->kind.push_back(kind);
  c->from_s.push_back(at_from.time_s);
  c->to_s.push_back(at_to.time_s);
  c->from_z.push_back(there.z_m);
  c->from_u.push_back(there.u_m);
  c->to_z.push_back(here.z_m);
  c->to_u.push_back(here.u_m);
  c->quality.push_back(quality);
  c->used.push_back(used ? 1 : 0);
}

// One trace led to the next: the best connections that there are, but across cuts.
void AddNeighbours(const Parts& parts, ConnectionColumns* c) {
  constexpr double kAcrossCut = 0.1;
  for (std::size_t t = 1; t < parts.traces.size(); ++t) {
    const RecordedTrace &before = parts.traces[t - 1], &now = parts.traces[t];
    if (before.robot != now.robot) continue;
    const Scan &last = parts.scans[now.robot][before.end - 1], &first = parts.scans[now.robot][now.first];
    const bool cut = last.run != first.run;
    const double distance_m = first.path_m - last.path_m;
    Add(parts, t - 1, t, cut ? 1 : 0, last, first, cut ? kAcrossCut : 1 / (1 + distance_m), true, c);
  }
}

void AddLoops(const Parts& parts, ConnectionColumns* c) {
  for (const Loop& loop : parts.loops) {
    const PathNode& node = parts.nodes[loop.node];
    const std::int32_t to = TraceAt(parts, node.robot, node.scan);
    if (to < 0) continue;
    const std::vector<Scan>& scans = parts.scans[node.robot];
    const RecordedTrace& trace = parts.traces[loop.trace];
    // What matching does not tell, the path does.
    const Point placed{scans[node.scan].pose.x_m, scans[node.scan].pose.y_m};
    Position at = OnTrace(parts, loop.trace, placed);
    if (!std::isnan(loop.at.z_m)) at.z_m = loop.at.z_m;
    if (!std::isnan(loop.at.u_m)) at.u_m = loop.at.u_m;
    // When the robot that recorded the trace was beside the place.
    std::size_t nearest = trace.first;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t s = trace.first; s < trace.end; ++s) {
      const double off =
          std::abs(OnTrace(parts, loop.trace, {scans[s].pose.x_m, scans[s].pose.y_m}).z_m - at.z_m);
      if (off >= least) continue;
      least = off;
      nearest = s;
    }
    Add(parts, loop.trace, static_cast<std::size_t>(to), 2, scans[nearest], scans[node.scan], loop.quality,
        loop.used, c);
    c->from_z.back() = at.z_m;
    c->from_u.back() = at.u_m;
  }
}

}  // namespace

Blob WallsBlob(const OrientationTrack& track, const Blob* before) {
  std::vector<double> angle, strength;
  std::vector<std::uint8_t> other, locked;
  bool seen = false;
  for (const Orientation& at : track.at) {
    seen |= at.strength > 0;
    angle.push_back(at.angle_rad);
    strength.push_back(at.strength);
    other.push_back(at.other ? 1 : 0);
    locked.push_back(seen ? 1 : 0);
  }
  if (before != nullptr) {
    const auto first = before->Get<double>("angle_rad");
    for (std::size_t s = 0; s < angle.size(); ++s) angle[s] += first[s];
  }
  Blob blob;
  blob.PutVector("angle_rad", angle);
  blob.PutVector("strength", strength);
  blob.PutVector("other_area", other);
  blob.PutVector("locked", locked);
  return blob;
}

void PutPoses(const std::string& prefix, const std::vector<Scan>& scans, Blob* result) {
  std::vector<double> time, x, y, heading;
  for (const Scan& scan : scans) {
    time.push_back(scan.time_s);
    x.push_back(scan.pose.x_m);
    y.push_back(scan.pose.y_m);
    heading.push_back(WrapAngle(scan.pose.heading_rad));
  }
  result->PutVector(prefix + "time_s", time);
  result->PutVector(prefix + "x_m", x);
  result->PutVector(prefix + "y_m", y);
  result->PutVector(prefix + "heading_rad", heading);
}

void PutWalls(const std::string& prefix, const std::vector<Scan>& scans, const Blob& walls, Blob* result) {
  std::vector<double> time, angle;
  const auto continuous = walls.Get<double>("angle_rad");
  const auto locked = walls.Get<std::uint8_t>("locked");
  for (std::size_t s = 0; s < scans.size(); ++s) {
    time.push_back(scans[s].time_s);
    const double turned = std::remainder(continuous[s], kTurn_rad);
    angle.push_back(locked[s] == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : turned < 0   ? turned + kTurn_rad
                                   : turned);
  }
  result->PutVector(prefix + "time_s", time);
  result->PutVector(prefix + "angle_rad", angle);
  for (const char* name : {"strength", "locked", "other_area"}) result->Put(prefix + name, walls.at(name));
}

void PutTraces(const Parts& parts, Blob* result) {
  std::vector<std::int32_t> robot, first_z;
  std::vector<double> first_s, last_s, x, y, direction;
  std::vector<std::int64_t> features;
  SideColumns left, right;
  for (const RecordedTrace& trace : parts.traces) {
    const std::vector<Scan>& scans = parts.scans[trace.robot];
    const Point origin = trace.frame.Local({}, trace.trace.cell_m()), by = MovedBy(trace, parts.nodes);
    robot.push_back(static_cast<std::int32_t>(trace.robot));
    first_s.push_back(scans[trace.first].time_s);
    last_s.push_back(scans[trace.end - 1].time_s);
    x.push_back(origin.x_m + by.x_m);
    y.push_back(origin.y_m + by.y_m);
    direction.push_back(WrapAngle(trace.frame.quarter * kTurn_rad));
    first_z.push_back(trace.trace.first_z());
    features.push_back(static_cast<std::int64_t>(trace.trace.features().size()));
    for (const Feature& feature : trace.trace.features()) {
      left.Add(feature.left);
      right.Add(feature.right);
    }
  }
  result->PutVector("traces/robot", robot);
  result->PutVector("traces/first_s", first_s);
  result->PutVector("traces/last_s", last_s);
  result->PutVector("traces/x_m", x);
  result->PutVector("traces/y_m", y);
  result->PutVector("traces/direction_rad", direction);
  result->PutVector("traces/first_z", first_z);
  result->PutVector("traces/features", features);
  left.Put("features/left/", result);
  right.Put("features/right/", result);
}

void PutConnections(const Parts& parts, Blob* result) {
  ConnectionColumns c;
  AddNeighbours(parts, &c);
  AddLoops(parts, &c);
  const std::string prefix = "connections/";
  result->PutVector(prefix + "from", c.from);
  result->PutVector(prefix + "to", c.to);
  result->PutVector(prefix + "kind", c.kind);
  result->PutVector(prefix + "from_s", c.from_s);
  result->PutVector(prefix + "to_s", c.to_s);
  result->PutVector(prefix + "from_z_m", c.from_z);
  result->PutVector(prefix + "from_u_m", c.from_u);
  result->PutVector(prefix + "to_z_m", c.to_z);
  result->PutVector(prefix + "to_u_m", c.to_u);
  result->PutVector(prefix + "quality", c.quality);
  result->PutVector(prefix + "used", c.used);
}

}  // namespace cairn::local_map
