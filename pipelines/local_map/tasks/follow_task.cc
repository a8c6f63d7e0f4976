#include "pipelines/local_map/tasks/follow_task.h"

#include <algorithm>

#include "schema/kinds/fields.h"

namespace cairn::local_map {
namespace {

constexpr double kTurnSd_m = 0.02, kCutSd_m = 0.5, kLoopSd_m = 0.03;  // of connections

// Of FORMAT.md's positions/.
struct PositionRow {
  double time_s = 0;
  std::int32_t trace = 0;
  Position at;
  SearchWindow range;
  bool corrected = false;
  static void Fields(const auto& field) {
    field("time_s", &PositionRow::time_s);
    field("trace", &PositionRow::trace);
    field("z_m", [](auto& row) -> auto& { return row.at.z_m; });
    field("u_m", [](auto& row) -> auto& { return row.at.u_m; });
    field("range_z_m", [](auto& row) -> auto& { return row.range.z_m; });
    field("range_u_m", [](auto& row) -> auto& { return row.range.u_m; });
    field("corrected", &PositionRow::corrected);
  }
};

Connection Connect(const Parts& parts, std::size_t from, std::size_t to, double sd_m) {
  const RecordedTrace &a = parts.traces[from], &b = parts.traces[to];
  const Point moved_a = MovedBy(a, parts.nodes), moved_b = MovedBy(b, parts.nodes);
  const Point origin = b.frame.Local({}, b.trace.cell_m());
  const Point seen{origin.x_m + moved_b.x_m - moved_a.x_m, origin.y_m + moved_b.y_m - moved_a.y_m};
  return {static_cast<int>(from), static_cast<int>(to), (b.frame.quarter - a.frame.quarter + 4) % 4,
          a.frame.At(seen, a.trace.cell_m()), sd_m};
}

// The graph as it grows: numbers of traces here and there.
class Growing {
 public:
  Growing(std::size_t robot, const std::vector<RecordedTrace>& traces,
          const std::vector<Connection>& connections)
      : traces_(traces), connections_(connections), here_(traces.size(), -1) {
    for (std::size_t t = 0; t < traces.size(); ++t)
      if (traces[t].robot == robot) next_.push_back(t);
    std::ranges::reverse(next_);
  }
  std::size_t left() const { return next_.size(); }
  const TraceGraph& graph() const { return graph_; }
  std::size_t TraceOf(std::size_t node) const { return there_[node]; }

  // Adds the traces whose recording ended before this scan.
  void GrowUntil(std::size_t scan, const LocalGrids& grids, const SearchWindow& range,
                 TraceLocalizer* localizer) {
    while (!next_.empty() && traces_[next_.back()].end <= scan) {
      const std::size_t t = next_.back();
      next_.pop_back();
      const RecordedTrace& trace = traces_[t];
      here_[t] = graph_.Add(trace.trace, trace.frame.quarter);
      there_.push_back(t);
      for (Connection connection : connections_) {
        const auto from = static_cast<std::size_t>(connection.from),
                   to = static_cast<std::size_t>(connection.to);
        if ((from != t && to != t) || here_[from] < 0 || here_[to] < 0) continue;
        connection.from = here_[from];
        connection.to = here_[to];
        graph_.Connect(connection);
      }
      const Position at = trace.frame.At({grids.pose().x_m, grids.pose().y_m}, trace.trace.cell_m());
      localizer->Begin(here_[t], at, range);
    }
  }

 private:
  const std::vector<RecordedTrace>& traces_;
  const std::vector<Connection>& connections_;
  std::vector<int> here_;           // of each trace its node; -1: not yet
  std::vector<std::size_t> there_;  // of each node its trace
  std::vector<std::size_t> next_;   // the last comes first
  TraceGraph graph_;
};

}  // namespace

std::vector<Connection> MakeConnections(const Parts& parts) {
  std::vector<Connection> connections;
  for (std::size_t t = 1; t < parts.traces.size(); ++t) {
    const RecordedTrace &before = parts.traces[t - 1], &now = parts.traces[t];
    if (before.robot != now.robot) continue;
    const std::vector<Scan>& scans = parts.scans[now.robot];
    const bool cut = scans[before.end - 1].run != scans[now.first].run;
    // [DM98] section 4.1: two successive traces are connected at the turning point.
    connections.push_back(Connect(parts, t - 1, t, cut ? kCutSd_m : kTurnSd_m));
  }
  for (const Loop& loop : parts.loops) {
    const std::int32_t to = TraceAt(parts, parts.nodes[loop.node].robot, parts.nodes[loop.node].scan);
    if (!loop.used || to < 0 || static_cast<std::size_t>(to) == loop.trace) continue;
    // [DM98] section 4.3: a loop adds a weak connection.
    connections.push_back(Connect(parts, loop.trace, static_cast<std::size_t>(to), kLoopSd_m));
  }
  return connections;
}

Blob Follow(ScanReader& scans, std::size_t robot, const std::vector<RecordedTrace>& traces,
            const std::vector<Connection>& connections, const std::vector<double>& moved_m,
            const GridOptions& grid, const LocalizerOptions& options, Progress& progress) {
  GridOptions aligned = grid;
  aligned.align = false;
  LocalGrids grids(aligned, scans.rings());
  Growing growing(robot, traces, connections);
  TraceLocalizer localizer(grids, options, growing.left());
  std::vector<PositionRow> rows;
  const SearchWindow fresh{options.least_m, options.least_m};
  for (std::size_t s = 0; s < scans.size(); ++s) {
    if (s % 20 == 0) progress.Tick();
    grids.Update(scans.pose(s), scans.Read(s));
    localizer.Update(grids, growing.graph(), moved_m[s]);
    for (std::size_t n = 0; n < growing.graph().size(); ++n) {
      const std::optional<Held>& held = localizer.held(static_cast<int>(n));
      if (held && held->active)
        rows.push_back({scans.time_s(s), static_cast<std::int32_t>(growing.TraceOf(n)), held->at, held->range,
                        held->corrected});
    }
    growing.GrowUntil(s + 1, grids, fresh, &localizer);
  }
  return BlobOf(rows);
}

}  // namespace cairn::local_map
