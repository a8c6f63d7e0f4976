// Traces and how one comes from one to another ([DM98] section 4.3). There is no common frame: a connection
// tells where the origin of one trace lies in the frame of the other, and how well.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pipelines/local_map/traces/edge_trace.h"

namespace cairn::local_map {

struct Connection {
  int from = 0, to = 0;
  int quarter = 0;  // `to` runs so many quarter turns left of `from`
  Position origin;  // of `to`, in the frame of `from`
  double sd_m = 0;  // of that, each axis: small where one led to the other, large for a loop or across a cut
  // Throws InputError where it is none of so many traces.
  void Check(std::size_t traces) const;
  static void Fields(const auto& field) {
    field("from", &Connection::from);
    field("to", &Connection::to);
    field("quarter", &Connection::quarter);
    field("origin", &Connection::origin);
    field("sd_m", &Connection::sd_m);
  }
};

// A position in the frame of `from`, in that of `to`; and back.
Position Through(const Connection& connection, const Position& at);
Position Back(const Connection& connection, const Position& at);

class TraceGraph {
 public:
  struct Node {
    EdgeTrace trace;
    int quarter = 0;               // direction in the local frame
    std::vector<int> connections;  // from or to it
  };

  // Returns its number.
  int Add(EdgeTrace trace, int quarter);
  // One of the same two traces that is weaker is replaced, one that is stronger stays.
  void Connect(const Connection& connection);

  std::size_t size() const { return nodes_.size(); }
  const Node& node(int n) const { return nodes_[static_cast<std::size_t>(n)]; }
  const Connection& connection(int c) const { return connections_[static_cast<std::size_t>(c)]; }
  std::span<const Connection> connections() const { return connections_; }

 private:
  std::vector<Node> nodes_;
  std::vector<Connection> connections_;
};

}  // namespace cairn::local_map
