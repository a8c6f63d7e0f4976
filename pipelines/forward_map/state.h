// What a round goes on from: where the job stands, the map and the sensors' parameters, what tiles propose.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipelines/common/grid_box.h"
#include "pipelines/common/range_scans.h"
#include "pipelines/common/state_scalars.h"
#include "pipelines/forward_map/forward_model.h"
#include "pipelines/forward_map/search.h"
#include "pipelines/pipeline.h"
#include "schema/blob.h"
#include "schema/kinds/fields.h"

namespace cairn::forward_map {

// What a round is for. A search is followed by a round that weighs what the tiles propose together.
enum class Phase : std::uint8_t {
  kBegin,       // weighs the empty map
  kSearch,      // each tile proposes flips
  kWeigh,       // the first `taken` proposals together, from scratch
  kParameters,  // weighs the map with other parameters of the sensors
  kCertainty    // what is sure of the map, and what explains each reading
};

struct Schedule {
  Phase phase = Phase::kBegin;
  std::int64_t searches = 0;  // rounds of it that were begun
  std::int64_t split = 0;     // which of the two ways to cut tiles
  std::int64_t quiet = 0;     // ways in a row by which no tile found anything
  std::int64_t taken = 0;     // proposals that are weighed
  std::int64_t steps = 0;     // of the parameters since the last search
  bool settled = false;       // the parameters are what they will be
  bool cut_short = false;     // the searches were as many as are allowed before nothing was left to find
  double target_nats = 0;     // log p(Z | m) + log p(m) of the map that the search holds
  double begun_nats = 0;      // the same when the parameters last began to change

  static void Fields(const auto& field) {
    field("phase", &Schedule::phase);
    field("searches", &Schedule::searches);
    field("split", &Schedule::split);
    field("quiet", &Schedule::quiet);
    field("taken", &Schedule::taken);
    field("steps", &Schedule::steps);
    field("settled", &Schedule::settled);
    field("cut_short", &Schedule::cut_short);
    field("target_nats", &Schedule::target_nats);
    field("begun_nats", &Schedule::begun_nats);
  }
};

// Ways to cut tiles: their borders differ, so that none is in the way of both.
inline constexpr int kSplits = 2;
// Scalars of the State beside the Schedule's: how many sensors, tiles of each split; of each sensor the
// scans, and those of a slice.
inline constexpr const char* kSensors = "sensors";
std::string TilesKey(std::int64_t split);
std::string ScansKey(std::int64_t sensor);
std::string SliceKey(std::int64_t sensor);
inline constexpr const char* kCrossings = "crossings";  // of all beams with cells, as Load estimates them
// Its blobs: the map, what is proposed, the tiles of each split, of each sensor what it is and its scans; and
// what only Advance reads, of the map the Evidence of each sensor, the map before the last change of
// parameters, the history.
inline constexpr const char* kLogBlob = "log";
inline constexpr const char* kMapBlob = "map";
inline constexpr const char* kProposalsBlob = "proposals";
inline constexpr const char* kEvidenceBlob = "evidence";
inline constexpr const char* kBeforeBlob = "before";
inline constexpr const char* kHistoryBlob = "history";
std::string TilesBlob(std::int64_t split);
std::string SensorBlobName(std::int64_t sensor);
std::string ScansBlobName(std::int64_t sensor);

// The map as it is held, sent and written: occupied, difference, probability, dynamic, and copies.
inline constexpr double kBytesOfCell = 64;

// What the search knows at a round's start.
struct MapState {
  GridBox box;
  std::vector<std::uint8_t> occupied;  // [rows][columns]
  std::vector<SensorModel> models;     // of each sensor

  static void Fields(const auto& field) {
    field("box", &MapState::box);
    field("occupied", &MapState::occupied);
    field("model", &MapState::models);
  }
  // Throws InputError where it is none, or has more cells.
  void Check(double most_cells) const;
  double CountOccupied() const;
  // log p(m) but for a constant.
  double LogPrior(const MapPrior& prior) const;
};
// A map of the State, checked.
MapState MapIn(const GridOptions& options, const Inputs& inputs, const char* blob = kMapBlob);

// Cells of the map that a tile's search would flip.
struct Proposal {
  std::vector<std::int64_t> cells;
  double gain = 0;  // with all else as it is
};

Blob ToBlob(const std::vector<Proposal>& proposals);
// Throws InputError where the arrays do not fit each other.
std::vector<Proposal> ProposalsOf(const Blob& blob);
// Flips what the first `count` propose. Throws InputError where there are fewer, or a cell is none of the
// map.
void Apply(const std::vector<Proposal>& proposals, std::size_t count, std::vector<std::uint8_t>* occupied);

}  // namespace cairn::forward_map
