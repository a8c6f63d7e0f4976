// What the search knows at a round's start: the map and the sensors' parameters; and what tiles propose.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/common/grid_box.h"
#include "pipelines/forward_map/forward_model.h"
#include "pipelines/forward_map/search.h"
#include "schema/blob.h"
#include "schema/kinds/fields.h"

namespace cairn::forward_map {

struct MapState {
  GridBox box;
  std::vector<std::uint8_t> occupied;  // [rows][columns]
  std::vector<SensorModel> models;     // of each sensor

  static void Fields(const auto& field) {
    field("box", &MapState::box);
    field("occupied", &MapState::occupied);
    field("model", &MapState::models);
  }
  double CountOccupied() const;
  // log p(m) but for a constant.
  double LogPrior(const MapPrior& prior) const;
};

// Cells of the map that a tile's search would flip.
struct Proposal {
  std::vector<std::int64_t> cells;
  double gain = 0;  // with all else as it is
};

Blob ToBlob(const std::vector<Proposal>& proposals);
std::vector<Proposal> ProposalsOf(const Blob& blob);
// Flips what the first `count` propose.
void Apply(const std::vector<Proposal>& proposals, std::size_t count, std::vector<std::uint8_t>* occupied);

}  // namespace cairn::forward_map
