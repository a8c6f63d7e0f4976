#include "coordinator/core/round_facts.h"

#include <algorithm>
#include <utility>

namespace cairn::coordinator {
namespace {

std::uint64_t RoundsOf(const proto::RoundFacts& row) { return std::max<std::uint64_t>(1, row.rounds()); }

// `into`, a row before `row`, takes it in.
void Merge(const proto::RoundFacts& row, proto::RoundFacts* into) {
  into->set_rounds(RoundsOf(*into) + RoundsOf(row));
  into->set_note(row.note());
  into->set_tasks(into->tasks() + row.tasks());
  into->set_seconds(into->seconds() + row.seconds());
  into->set_compute_seconds(into->compute_seconds() + row.compute_seconds());
}

}  // namespace

void AddRoundFacts(proto::RoundFacts row, proto::StageFacts* facts) {
  auto& rows = *facts->mutable_rounds();
  *rows.Add() = std::move(row);
  if (rows.size() <= kMostRoundFacts) return;
  const int pairs = (rows.size() - 1 - kRecentRoundFacts) / 2;
  for (int pair = 0; pair < pairs; ++pair) {
    proto::RoundFacts merged = rows.Get(1 + 2 * pair);
    Merge(rows.Get(2 + 2 * pair), &merged);
    *rows.Mutable(1 + pair) = std::move(merged);
  }
  rows.DeleteSubrange(1 + pairs, pairs);
}

}  // namespace cairn::coordinator
