#include "datasets/report/local_result.h"

#include <cmath>
#include <span>

namespace cairn::datasets::report {
namespace {

template <class T>
std::span<const T> Column(const Blob& blob, const std::string& name, std::size_t rows) {
  const auto column = blob.Get<T>(name);
  if (column.size() != rows)
    throw InputError("'" + name + "' has " + std::to_string(column.size()) + " numbers, where " +
                     std::to_string(rows) + " are needed");
  return column;
}

std::size_t Index(std::int64_t value, std::size_t size, const char* of) {
  if (value < 0 || static_cast<std::size_t>(value) >= size)
    throw InputError(std::string("not a local_map: there is no ") + of + " " + std::to_string(value));
  return static_cast<std::size_t>(value);
}

// `counts` rows of each owner, one after the other, must be all of `rows`.
void CheckCounts(std::span<const std::int64_t> counts, std::size_t rows, const char* what) {
  std::int64_t sum = 0;
  for (const std::int64_t count : counts) {
    if (count < 0 || count > static_cast<std::int64_t>(rows)) sum = -1;
    if (sum < 0) break;
    sum += count;
  }
  if (sum != static_cast<std::int64_t>(rows))
    throw InputError(std::string(what) + ": the rows do not add up");
}

// Of all features.
std::vector<LocalSide> ReadSides(const Blob& result, const std::string& prefix) {
  const auto low = result.Get<float>(prefix + "angle_low_rad");
  const std::size_t n = low.size();
  const auto high = Column<float>(result, prefix + "angle_high_rad", n),
             near = Column<float>(result, prefix + "distance_low_m", n),
             far = Column<float>(result, prefix + "distance_high_m", n);
  const auto occupied = Column<std::uint8_t>(result, prefix + "occupied", n);
  constexpr float kFarthest_m = 1000;  // no sensor of a robot sees as far
  for (const auto& [name, column] :
       {std::pair(prefix + "distance_low_m", near), {prefix + "distance_high_m", far}})
    for (const float distance_m : column)
      if (std::abs(distance_m) > kFarthest_m)  // not a number: no edge
        throw InputError("'" + name + "' holds " + std::to_string(distance_m) +
                         ", which is no distance of an edge");
  std::vector<LocalSide> sides;
  for (std::size_t i = 0; i < n; ++i) sides.push_back({low[i], high[i], near[i], far[i], occupied[i] != 0});
  return sides;
}

std::vector<LocalTrace> ReadTraces(const Blob& result, std::size_t robots, double cell_m) {
  const auto robot = result.Get<std::int32_t>("traces/robot");
  const std::size_t n = robot.size();
  const auto first_s = Column<double>(result, "traces/first_s", n),
             last_s = Column<double>(result, "traces/last_s", n), x = Column<double>(result, "traces/x_m", n),
             y = Column<double>(result, "traces/y_m", n),
             direction = Column<double>(result, "traces/direction_rad", n);
  const auto first_z = Column<std::int32_t>(result, "traces/first_z", n);
  const auto features = Column<std::int64_t>(result, "traces/features", n);
  const std::vector<LocalSide> left = ReadSides(result, "features/left/"),
                               right = ReadSides(result, "features/right/");
  if (left.size() != right.size()) throw InputError("features: left and right differ in length");
  CheckCounts(features, left.size(), "traces/features");
  std::vector<LocalTrace> traces;
  std::size_t next = 0;
  for (std::size_t k = 0; k < n; ++k) {
    LocalTrace trace{Index(robot[k], robots, "robot"),
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

std::vector<LocalConnection> ReadConnections(const Blob& result, std::size_t traces) {
  const auto kind = result.Get<std::int32_t>("connections/kind");
  const std::size_t n = kind.size();
  const auto from = Column<std::int32_t>(result, "connections/from", n),
             to = Column<std::int32_t>(result, "connections/to", n);
  const auto used = Column<std::uint8_t>(result, "connections/used", n);
  const auto from_z = Column<double>(result, "connections/from_z_m", n),
             from_u = Column<double>(result, "connections/from_u_m", n),
             to_z = Column<double>(result, "connections/to_z_m", n),
             to_u = Column<double>(result, "connections/to_u_m", n);
  std::vector<LocalConnection> connections;
  for (std::size_t k = 0; k < n; ++k)
    connections.push_back({Index(from[k], traces, "trace"), Index(to[k], traces, "trace"), kind[k] == 2,
                           used[k] != 0, from_z[k], from_u[k], to_z[k], to_u[k]});
  return connections;
}

std::vector<LocalSnapshot> ReadSnapshots(const Blob& result, std::size_t robots, double cell_m) {
  if (!result.Has("snapshots/time_s")) return {};
  const auto time = result.Get<double>("snapshots/time_s");
  const Shape& shape = result.at("snapshots/occupancy").shape();
  if (shape.size() != 3 || shape[1] != shape[2] || shape[0] != static_cast<std::int64_t>(time.size()))
    throw InputError("'snapshots/occupancy' is no row of square grids");
  const auto cells = static_cast<std::size_t>(shape[1] * shape[2]), n = time.size();
  const auto robot = Column<std::int32_t>(result, "snapshots/robot", n);
  const auto frame = Column<double>(result, "snapshots/frame_rad", n);
  const auto occupancy = Column<float>(result, "snapshots/occupancy", n * cells),
             edge = Column<float>(result, "snapshots/edge_rad", n * cells);
  constexpr std::size_t kSectors = 8;
  const auto histogram = Column<double>(result, "snapshots/histogram", n * kSectors);
  const auto count = Column<std::int64_t>(result, "snapshots/edges", n);
  const auto x0 = result.Get<double>("snapshots/edge/x0_m");
  const auto y0 = Column<double>(result, "snapshots/edge/y0_m", x0.size()),
             x1 = Column<double>(result, "snapshots/edge/x1_m", x0.size()),
             y1 = Column<double>(result, "snapshots/edge/y1_m", x0.size());
  CheckCounts(count, x0.size(), "snapshots/edges");
  std::vector<LocalSnapshot> snapshots;
  std::size_t next = 0;
  for (std::size_t k = 0; k < n; ++k) {
    LocalSnapshot shot;
    shot.robot = Index(robot[k], robots, "robot");
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

std::vector<LocalPosition> ReadPositions(const Blob& result, const std::string& prefix, std::size_t traces) {
  if (!result.Has(prefix + "trace")) return {};
  const auto trace = result.Get<std::int32_t>(prefix + "trace");
  const std::size_t n = trace.size();
  const auto time = Column<double>(result, prefix + "time_s", n),
             z = Column<double>(result, prefix + "z_m", n), u = Column<double>(result, prefix + "u_m", n);
  const auto corrected = Column<std::uint8_t>(result, prefix + "corrected", n);
  std::vector<LocalPosition> positions;
  for (std::size_t i = 0; i < n; ++i)
    positions.push_back({time[i], z[i], u[i], Index(trace[i], traces, "trace"), corrected[i] != 0});
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
  constexpr double kLargest_m = 10;
  if (!(read.cell_m > 0 && read.cell_m <= kLargest_m))
    throw InputError("'cell_m' is " + std::to_string(read.cell_m) + ", which is no cell's edge");
  read.traces = ReadTraces(result, robots, read.cell_m);
  read.connections = ReadConnections(result, read.traces.size());
  read.snapshots = ReadSnapshots(result, robots, read.cell_m);
  for (std::size_t r = 0; r < robots; ++r) {
    const std::string prefix = "robot/" + std::to_string(r) + "/";
    read.paths.push_back(ReadTrack(result, prefix + "poses/"));
    read.positions.push_back(ReadPositions(result, prefix + "positions/", read.traces.size()));
  }
  return read;
}

}  // namespace cairn::datasets::report
