#include "pipelines/forward_map/history.h"

#include "pipelines/common/handed_over.h"

namespace cairn::forward_map {
namespace {

struct HistoryRow {
  double log_likelihood = 0, target = 0, expected_log_likelihood = 0;
  std::int64_t occupied = 0;
  static void Fields(const auto& field) {
    field("log_likelihood", &HistoryRow::log_likelihood);
    field("target", &HistoryRow::target);
    field("expected_log_likelihood", &HistoryRow::expected_log_likelihood);
    field("occupied", &HistoryRow::occupied);
  }
};

// One that was taken over as occupied, or as free again.
struct ChangedCell {
  std::int64_t iteration = 0, cell = 0;
  static void Fields(const auto& field) {
    field("iteration", &ChangedCell::iteration);
    field("cell", &ChangedCell::cell);
  }
};

}  // namespace

Evidence SumOf(const std::vector<Evidence>& evidence) {
  Evidence sum;
  for (const Evidence& e : evidence) sum.Add(e);
  return sum;
}

Blob WithRow(const Blob* history, const Evidence& evidence, double target_nats, const MapState& map) {
  std::vector<HistoryRow> rows;
  std::vector<ChangedCell> changed;
  if (history != nullptr) {
    AppendRows("history/", *history, &rows);
    AppendRows("history/changed_", *history, &changed);
  }
  const auto now = static_cast<std::int64_t>(rows.size());
  std::vector<std::uint8_t> before(map.occupied.size());
  for (const ChangedCell& c : changed) {
    RequireWithin("a cell that changed", c.cell, 0, std::ssize(before) - 1);
    before[static_cast<std::size_t>(c.cell)] ^= 1;
  }
  for (std::size_t cell = 0; cell < before.size(); ++cell)
    if (before[cell] != map.occupied[cell]) changed.push_back({now, static_cast<std::int64_t>(cell)});
  rows.push_back({evidence.log_likelihood, target_nats, evidence.log_likelihood - evidence.entropy,
                  static_cast<std::int64_t>(map.CountOccupied())});
  Blob blob;
  PutRows("history/", rows, &blob);
  PutRows("history/changed_", changed, &blob);
  return blob;
}

}  // namespace cairn::forward_map
