// How the search went: a row for each map or set of parameters that it took over.
#pragma once

#include "pipelines/forward_map/state.h"
#include "pipelines/forward_map/weigh.h"
#include "schema/blob.h"

namespace cairn::forward_map {

// Sums of the sensors' evidence.
Evidence SumOf(const std::vector<Evidence>& evidence);

// `history` (may be null) and one more row: history/log_likelihood, target, expected_log_likelihood,
// occupied, and which cells changed from the row before, changed_iteration, changed_cell.
Blob WithRow(const Blob* history, const Evidence& evidence, double target_nats, const MapState& map);

}  // namespace cairn::forward_map
