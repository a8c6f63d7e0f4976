#include "pipelines/forward_map/history.h"

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

}  // namespace

Evidence SumOf(const std::vector<Evidence>& evidence) {
  Evidence sum;
  for (const Evidence& e : evidence) sum.Add(e);
  return sum;
}

Blob WithRow(const Blob* history, const Evidence& evidence, double target_nats, const MapState& map) {
  std::vector<HistoryRow> rows;
  if (history != nullptr) AppendRows("history/", *history, &rows);
  rows.push_back({evidence.log_likelihood, target_nats, evidence.log_likelihood - evidence.entropy,
                  static_cast<std::int64_t>(map.CountOccupied())});
  Blob blob;
  PutRows("history/", rows, &blob);
  return blob;
}

}  // namespace cairn::forward_map
