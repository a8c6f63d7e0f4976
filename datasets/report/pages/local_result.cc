#include "datasets/report/pages/local_result.h"

#include <cmath>
#include <span>

namespace cairn::datasets::report {
namespace {

// Of all features.
std::vector<LocalSide> ReadSides(const Blob& result, const std::string& prefix) {
  const auto low = result.Get<float>(prefix + "angle_low_rad");
  const std::size_t n = low.size();
  const auto high = result.Get<float>(prefix + "angle_high_rad"),
             near = result.Get<float>(prefix + "distance_low_m"),
             far = result.Get<float>(prefix + "distance_high_m");
  const auto occupied = result.Get<std::uint8_t>(prefix + "occupied");
  std::vector<LocalSide> sides;
  for (std::size_t i = 0; i < n; ++i) sides.push_back({low[i], high[i], near[i], far[i], occupied[i] != 0});
  return sides;
}

std::vector<LocalTrace> ReadTraces(const Blob& result, double cell_m) {
  const auto robot = result.Get<std::int32_t>("traces/robot");
  const std::size_t n = robot.size();
  const auto first_s = result.Get<double>("traces/first_s"), last_s = result.Get<double>("traces/last_s"),
             x = result.Get<double>("traces/x_m"), y = result.Get<double>("traces/y_m"),
             direction = result.Get<double>("traces/direction_rad");
  const auto first_z = result.Get<std::int32_t>("traces/first_z");
  const auto features = result.Get<std::int64_t>("traces/features");
  const std::vector<LocalSide> left = ReadSides(result, "features/left/"),
                               right = ReadSides(result, "features/right/");
  std::vector<LocalTrace> traces;
  std::size_t next = 0;
  for (std::size_t k = 0; k < n; ++k) {
    LocalTrace trace{static_cast<std::size_t>(robot[k]),
                     first_s[k],
                     last_s[k],
                     {x[k], y[k], direction[k]},
                     first_z[k],
                     cell_m,
                     {}};
    for (std::int64_t f = 0; f < features[k]; ++f, ++next)
      trace.features.push_back({left[next], right[next]});
    traces.push_back(std::move(trace));
  }
  return traces;
}

std::vector<LocalConnection> ReadConnections(const Blob& result) {
  const auto kind = result.Get<std::int32_t>("connections/kind");
  const std::size_t n = kind.size();
  const auto from = result.Get<std::int32_t>("connections/from"),
             to = result.Get<std::int32_t>("connections/to");
  const auto used = result.Get<std::uint8_t>("connections/used");
  const auto from_z = result.Get<double>("connections/from_z_m"),
             from_u = result.Get<double>("connections/from_u_m"),
             to_z = result.Get<double>("connections/to_z_m"), to_u = result.Get<double>("connections/to_u_m");
  std::vector<LocalConnection> connections;
  for (std::size_t k = 0; k < n; ++k)
    connections.push_back({static_cast<std::size_t>(from[k]), static_cast<std::size_t>(to[k]), kind[k] == 2,
                           used[k] != 0, from_z[k], from_u[k], to_z[k], to_u[k]});
  return connections;
}

std::vector<LocalSnapshot> ReadSnapshots(const Blob& result, double cell_m) {
  if (!result.Has("snapshots/time_s")) return {};
  const auto time = result.Get<double>("snapshots/time_s");
  const Shape& shape = result.at("snapshots/occupancy").shape();
  const auto cells = static_cast<std::size_t>(shape[1] * shape[2]), n = time.size();
  const auto robot = result.Get<std::int32_t>("snapshots/robot");
  const auto frame = result.Get<double>("snapshots/frame_rad");
  const auto occupancy = result.Get<float>("snapshots/occupancy"),
             edge = result.Get<float>("snapshots/edge_rad");
  constexpr std::size_t kSectors = 8;
  const auto histogram = result.Get<double>("snapshots/histogram");
  const auto count = result.Get<std::int64_t>("snapshots/edges");
  const auto x0 = result.Get<double>("snapshots/edge/x0_m");
  const auto y0 = result.Get<double>("snapshots/edge/y0_m"), x1 = result.Get<double>("snapshots/edge/x1_m"),
             y1 = result.Get<double>("snapshots/edge/y1_m");
  std::vector<LocalSnapshot> snapshots;
  std::size_t next = 0;
  for (std::size_t k = 0; k < n; ++k) {
    LocalSnapshot shot;
    shot.robot = static_cast<std::size_t>(robot[k]);
    shot.time_s = time[k];
    shot.frame_rad = frame[k];
    shot.cells = shape[1];
    shot.cell_m = cell_m;
    const auto part = [&](const auto& all, std::size_t size) { return all.subspan(k * size, size); };
    const auto here = part(occupancy, cells), edges = part(edge, cells);
    const auto sectors = part(histogram, kSectors);
    shot.occupancy.assign(here.begin(), here.end());
    shot.edge_rad.assign(edges.begin(), edges.end());
    shot.histogram.assign(sectors.begin(), sectors.end());
    for (std::int64_t e = 0; e < count[k]; ++e, ++next)
      shot.edges.push_back({{x0[next], y0[next]}, {x1[next], y1[next]}});
    snapshots.push_back(std::move(shot));
  }
  return snapshots;
}

std::vector<LocalPosition> ReadPositions(const Blob& result, const std::string& prefix) {
  if (!result.Has(prefix + "trace")) return {};
  const auto trace = result.Get<std::int32_t>(prefix + "trace");
  const std::size_t n = trace.size();
  const auto time = result.Get<double>(prefix + "time_s"), z = result.Get<double>(prefix + "z_m"),
             u = result.Get<double>(prefix + "u_m");
  const auto corrected = result.Get<std::uint8_t>(prefix + "corrected");
  std::vector<LocalPosition> positions;
  for (std::size_t i = 0; i < n; ++i)
    positions.push_back({time[i], z[i], u[i], static_cast<std::size_t>(trace[i]), corrected[i] != 0});
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
  LocalResult read;
  const std::size_t robots = result.Texts("robots").size();
  read.cell_m = result.Scalar<double>("cell_m");
  read.traces = ReadTraces(result, read.cell_m);
  read.connections = ReadConnections(result);
  read.snapshots = ReadSnapshots(result, read.cell_m);
  for (std::size_t r = 0; r < robots; ++r) {
    const std::string prefix = "robot/" + std::to_string(r) + "/";
    read.paths.push_back(ReadTrack(result, prefix + "poses/"));
    read.positions.push_back(ReadPositions(result, prefix + "positions/"));
  }
  return read;
}

}  // namespace cairn::datasets::report
