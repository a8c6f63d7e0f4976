#include "pipelines/local_map/traces/graph.h"

#include <algorithm>
#include <utility>

#include "pipelines/common/handed_over.h"
#include "pipelines/local_map/traces/frame.h"
#include "schema/error.h"

namespace cairn::local_map {
namespace {

// Turned right by so many quarters; TraceFrame at the origin does it.
Position Turned(int quarter, double x, double y) {
  return TraceFrame{((quarter % 4) + 4) % 4, {}}.At({x, y}, 1);
}

}  // namespace

void Connection::Check(std::size_t traces) const {
  const std::int64_t last = static_cast<std::int64_t>(traces) - 1;
  RequireWithin("a connection's from", std::int64_t{from}, 0, last);
  RequireWithin("a connection's to", std::int64_t{to}, 0, last);
  RequireWithin("a connection's quarter", std::int64_t{quarter}, 0, 3);
  RequireWithin("a connection's z_m", origin.z_m, -kFarthest_m, kFarthest_m);
  RequireWithin("a connection's u_m", origin.u_m, -kFarthest_m, kFarthest_m);
  RequireWithin("a connection's sd_m", sd_m, 0.0, kFarthest_m);
}

Position Through(const Connection& connection, const Position& at) {
  return Turned(connection.quarter, at.z_m - connection.origin.z_m, at.u_m - connection.origin.u_m);
}

Position Back(const Connection& connection, const Position& at) {
  const Position turned = Turned(-connection.quarter, at.z_m, at.u_m);
  return {turned.z_m + connection.origin.z_m, turned.u_m + connection.origin.u_m};
}

int TraceGraph::Add(EdgeTrace trace, int quarter) {
  nodes_.push_back({std::move(trace), quarter, {}});
  return static_cast<int>(nodes_.size()) - 1;
}

void TraceGraph::Connect(const Connection& connection) {
  const auto inside = [&](int n) { return n >= 0 && static_cast<std::size_t>(n) < nodes_.size(); };
  CAIRN_DEMAND(inside(connection.from) && inside(connection.to),
               "a connection is of two traces of the graph");
  for (const int c : node(connection.from).connections) {
    Connection& old = connections_[static_cast<std::size_t>(c)];
    if (std::pair(old.from, old.to) != std::pair(connection.from, connection.to)) continue;
    // [DM98] section 4.3: the quality of a connection
    if (connection.sd_m < old.sd_m) old = connection;
    return;
  }
  const int number = static_cast<int>(connections_.size());
  connections_.push_back(connection);
  nodes_[static_cast<std::size_t>(connection.from)].connections.push_back(number);
  nodes_[static_cast<std::size_t>(connection.to)].connections.push_back(number);
}

}  // namespace cairn::local_map
