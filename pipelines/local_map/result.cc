#include "pipelines/local_map/result.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "pipelines/common/handed_over.h"
#include "schema/kinds/local_map.h"

namespace cairn::local_map {
namespace {

constexpr double kTurn_rad = std::numbers::pi / 2;

// Of FORMAT.md's features/left/ and features/right/.
struct SideRow {
  Side side;
  static void Fields(const auto& field) {
    field("angle_low_rad", [](auto& row) -> auto& { return row.side.angle_rad.low; });
    field("angle_high_rad", [](auto& row) -> auto& { return row.side.angle_rad.high; });
    field("distance_low_m", [](auto& row) -> auto& { return row.side.distance_m.low; });
    field("distance_high_m", [](auto& row) -> auto& { return row.side.distance_m.high; });
    field("cross_m", [](auto& row) -> auto& { return row.side.cross_m; });
    field("occupied", [](auto& row) -> auto& { return row.side.occupied; });
  }
};

// Of traces/.
struct TraceRow {
  std::int32_t robot = 0, first_z = 0;
  double first_s = 0, last_s = 0, x_m = 0, y_m = 0, direction_rad = 0;
  std::size_t features = 0;
  static void Fields(const auto& field) {
    field("robot", &TraceRow::robot);
    field("first_z", &TraceRow::first_z);
    field("first_s", &TraceRow::first_s);
    field("last_s", &TraceRow::last_s);
    field("x_m", &TraceRow::x_m);
    field("y_m", &TraceRow::y_m);
    field("direction_rad", &TraceRow::direction_rad);
    field("features", &TraceRow::features);
  }
};

// Of connections/.
struct ConnectionRow {
  std::int32_t from = 0, to = 0, kind = 0;
  double from_s = 0, to_s = 0;
  Position at_from, at_to;
  double quality = 0;
  bool used = false, tells_x = true, tells_y = true;
  static void Fields(const auto& field) {
    field("from", &ConnectionRow::from);
    field("to", &ConnectionRow::to);
    field("kind", &ConnectionRow::kind);
    field("from_s", &ConnectionRow::from_s);
    field("to_s", &ConnectionRow::to_s);
    field("from_z_m", [](auto& row) -> auto& { return row.at_from.z_m; });
    field("from_u_m", [](auto& row) -> auto& { return row.at_from.u_m; });
    field("to_z_m", [](auto& row) -> auto& { return row.at_to.z_m; });
    field("to_u_m", [](auto& row) -> auto& { return row.at_to.u_m; });
    field("quality", &ConnectionRow::quality);
    field("used", &ConnectionRow::used);
    field("tells_x", &ConnectionRow::tells_x);
    field("tells_y", &ConnectionRow::tells_y);
  }
};
using ConnectionRows = std::vector<ConnectionRow>;

// Where the optimized path has a point, in a trace's frame.
Position OnTrace(const Parts& parts, std::size_t t, const Point& at) {
  const RecordedTrace& trace = parts.traces[t];
  const Point by = MovedBy(trace, parts.nodes);
  return trace.frame.At({at.x_m - by.x_m, at.y_m - by.y_m}, trace.trace.cell_m());
}

void Add(const Parts& parts, std::size_t from, std::size_t to, int kind, const Scan& at_from,
         const Scan& at_to, double quality, bool used, ConnectionRows* rows) {
  rows->push_back({static_cast<std::int32_t>(from), static_cast<std::int32_t>(to), kind, at_from.time_s,
                   at_to.time_s, OnTrace(parts, from, {at_from.pose.x_m, at_from.pose.y_m}),
                   OnTrace(parts, to, {at_to.pose.x_m, at_to.pose.y_m}), quality, used});
}

// One trace led to the next: the best connections that there are, but across cuts.
void AddNeighbours(const Parts& parts, ConnectionRows* c) {
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

void AddLoops(const Parts& parts, ConnectionRows* c) {
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
    c->back().at_from = at;
    const bool along_x = trace.frame.quarter % 2 == 0;
    c->back().tells_x = !std::isnan(along_x ? loop.at.z_m : loop.at.u_m);
    c->back().tells_y = !std::isnan(along_x ? loop.at.u_m : loop.at.z_m);
  }
}

}  // namespace

Blob WallsBlob(const OrientationTrack& track, const Blob* before) {
  std::vector<double> angle;
  std::vector<std::uint8_t> other, locked;
  bool seen = false;
  for (const Orientation& at : track.at) {
    seen |= at.strength > 0;
    angle.push_back(at.angle_rad);
    other.push_back(at.other ? 1 : 0);
    locked.push_back(seen ? 1 : 0);
  }
  if (before != nullptr) {
    const auto first = before->Get<double>("angle_rad");
    for (std::size_t s = 0; s < angle.size(); ++s) angle[s] += first[s];
  }
  return BlobOf(
      kinds::LocalMap::Walls{{}, angle, cairn::ColumnOf(track.at, &Orientation::strength), locked, other});
}

void PutPath(const std::string& prefix, const std::vector<Scan>& scans, const Blob& walls, Blob* result) {
  const std::vector<double> time_s = cairn::ColumnOf(scans, &Scan::time_s);
  kinds::LocalMap::Robot robot;
  robot.poses.Set(time_s, cairn::ColumnOf(scans, &Scan::pose));
  robot.poses.heading_rad =
      cairn::ColumnOf(scans, [](const Scan& scan) { return WrapAngle(scan.pose.heading_rad); });
  robot.walls = Read<kinds::LocalMap::Walls>(walls);
  robot.walls.time_s = time_s;
  std::vector<double> angle = robot.walls.angle_rad.vector();
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const double turned = std::remainder(angle[s], kTurn_rad);
    angle[s] = robot.walls.locked[s] == 0 ? std::numeric_limits<double>::quiet_NaN()
               : turned < 0               ? turned + kTurn_rad
                                          : turned;
  }
  robot.walls.angle_rad = angle;
  PutFields(prefix, robot, result);
}

void PutPasses(const std::string& prefix, const std::vector<Passing>& passes, const std::vector<Scan>& scans,
               Blob* result) {
  const auto last = static_cast<std::int64_t>(scans.size()) - 1;
  kinds::LocalMap::Passes rows;
  const auto time_s = [&](std::int64_t scan) {
    RequireWithin("a pass's scan", scan, std::int64_t{0}, last);
    return scans[static_cast<std::size_t>(scan)].time_s;
  };
  for (const Passing& passing : passes) {
    RequireWithin("a pass's share", passing.through, 0.0, 1.0);
    RequireWithin("how far off a pass is", std::hypot(passing.off.x_m, passing.off.y_m), 0.0, kFarthest_m);
  }
  rows.from_s = cairn::ColumnOf(passes, [&](const Passing& passing) { return time_s(passing.from); });
  rows.to_s = cairn::ColumnOf(passes, [&](const Passing& passing) { return time_s(passing.to); });
  rows.through = cairn::ColumnOf(passes, &Passing::through);
  rows.doubled = cairn::ColumnOf(passes, [](const Passing& p) { return std::uint8_t{p.doubled}; });
  rows.off_x_m = cairn::ColumnOf(passes, [](const Passing& p) { return p.off.x_m; });
  rows.off_y_m = cairn::ColumnOf(passes, [](const Passing& p) { return p.off.y_m; });
  PutFields(prefix + "passes/", rows, result);
}

void PutTraces(const Parts& parts, Blob* result) {
  std::vector<TraceRow> traces;
  std::vector<SideRow> left, right;
  for (const RecordedTrace& trace : parts.traces) {
    const std::vector<Scan>& scans = parts.scans[trace.robot];
    const Point origin = trace.frame.Local({}, trace.trace.cell_m()), by = MovedBy(trace, parts.nodes);
    traces.push_back({static_cast<std::int32_t>(trace.robot), trace.trace.first_z(),
                      scans[trace.first].time_s, scans[trace.end - 1].time_s, origin.x_m + by.x_m,
                      origin.y_m + by.y_m, WrapAngle(trace.frame.quarter * kTurn_rad),
                      trace.trace.features().size()});
    for (const Feature& feature : trace.trace.features()) {
      left.push_back({feature.left});
      right.push_back({feature.right});
    }
  }
  PutRows("traces/", traces, result);
  PutRows("features/left/", left, result);
  PutRows("features/right/", right, result);
}

void PutConnections(const Parts& parts, Blob* result) {
  ConnectionRows rows;
  AddNeighbours(parts, &rows);
  AddLoops(parts, &rows);
  PutRows("connections/", rows, result);
}

}  // namespace cairn::local_map
