#include "datasets/report/pages/local_result.h"

#include <cmath>

#include "schema/kinds/local_map.h"

namespace cairn::datasets::report {
namespace {

LocalSide SideAt(const kinds::LocalMap::Side& of, std::size_t i) {
  return {of.angle_low_rad[i], of.angle_high_rad[i], of.distance_low_m[i], of.distance_high_m[i],
          of.occupied[i] != 0};
}

std::vector<LocalTrace> TracesOf(const kinds::LocalMap& map) {
  const kinds::LocalMap::Traces& of = map.traces;
  std::vector<LocalTrace> traces;
  std::size_t next = 0;
  for (std::size_t k = 0; k < of.robot.size(); ++k) {
    LocalTrace trace{static_cast<std::size_t>(of.robot[k]),
                     of.first_s[k],
                     of.last_s[k],
                     {of.x_m[k], of.y_m[k], of.direction_rad[k]},
                     of.first_z[k],
                     map.cell_m.Scalar(),
                     {}};
    for (std::int64_t f = 0; f < of.features[k]; ++f, ++next)
      trace.features.push_back({SideAt(map.left, next), SideAt(map.right, next)});
    traces.push_back(std::move(trace));
  }
  return traces;
}

std::vector<LocalConnection> ConnectionsOf(const kinds::LocalMap::Connections& of) {
  std::vector<LocalConnection> connections;
  for (std::size_t k = 0; k < of.kind.size(); ++k)
    connections.push_back({static_cast<std::size_t>(of.from[k]), static_cast<std::size_t>(of.to[k]),
                           of.kind[k] == 2, of.used[k] != 0, of.from_z_m[k], of.from_u_m[k], of.to_z_m[k],
                           of.to_u_m[k]});
  return connections;
}

std::vector<LocalSnapshot> SnapshotsOf(const kinds::LocalMap& map) {
  const kinds::LocalMap::Snapshots& of = map.snapshots;
  std::vector<LocalSnapshot> snapshots;
  std::size_t next = 0;
  for (std::size_t k = 0; of.time_s && k < of.time_s.size(); ++k) {
    const auto part = [&](const auto& all) {
      const std::size_t size = all.size() / of.time_s.size();
      const auto own = all.values().subspan(k * size, size);
      return std::vector(own.begin(), own.end());
    };
    LocalSnapshot shot{static_cast<std::size_t>(of.robot[k]),
                       of.time_s[k],
                       of.frame_rad[k],
                       of.occupancy.shape()[1],
                       map.cell_m.Scalar(),
                       part(of.occupancy),
                       part(of.edge_rad),
                       part(of.histogram),
                       {}};
    for (std::int64_t e = 0; e < of.edges[k]; ++e, ++next)
      shot.edges.push_back(
          {{of.edge.x0_m[next], of.edge.y0_m[next]}, {of.edge.x1_m[next], of.edge.y1_m[next]}});
    snapshots.push_back(std::move(shot));
  }
  return snapshots;
}

std::vector<LocalPosition> PositionsOf(const kinds::LocalMap::Positions& of) {
  std::vector<LocalPosition> positions;
  for (std::size_t i = 0; of.trace && i < of.trace.size(); ++i)
    positions.push_back(
        {of.time_s[i], of.z_m[i], of.u_m[i], static_cast<std::size_t>(of.trace[i]), of.corrected[i] != 0});
  return positions;
}

}  // namespace

Point LocalTrace::ToWorld(double z_m, double u_m) const {
  const double c = std::cos(frame.heading_rad), s = std::sin(frame.heading_rad);
  return {frame.x_m + c * z_m - s * u_m, frame.y_m + s * z_m + c * u_m};
}

Point LocalSnapshot::Centre(std::int64_t column, std::int64_t row) const {
  const auto middle = cells / 2;
  return {static_cast<double>(column - middle) * cell_m, static_cast<double>(row - middle) * cell_m};
}

std::size_t LocalSnapshot::Index(std::int64_t column, std::int64_t row) const {
  return static_cast<std::size_t>(row * cells + column);
}

LocalResult ReadLocalResult(const Blob& result) {
  for (const char* name : {"robots", "cell_m", "traces/robot", "connections/kind"})
    if (!result.Has(name)) throw InputError(std::string("not a local_map: '") + name + "' is missing");
  const auto map = FieldsIn<kinds::LocalMap>("", result);
  LocalResult read{map.cell_m.Scalar(), {}, TracesOf(map), ConnectionsOf(map.connections),
                   SnapshotsOf(map),    {}};
  for (const kinds::LocalMap::Robot& robot : map.robot) {
    read.paths.push_back(TrackOf(robot.poses));
    read.positions.push_back(PositionsOf(robot.positions));
  }
  return read;
}

}  // namespace cairn::datasets::report
