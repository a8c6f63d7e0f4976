// How good a grid map is: against the truth of a simulated log, against another map, on readings held out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/evaluate/maps/likelihood.h"
#include "datasets/evaluate/maps/truth.h"
#include "datasets/evaluate/scores.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct DoorScore {
  bool truly_open = false;
  double passage_m = 0;  // of the widest body that gets through (maps/doors.h)
  bool open = false;     // as the map has it: passage_m is kPassageM at least
};

// One layer of a map.
struct LayerScore {
  std::optional<CellScore> cells;  // none: the truth has no walls
  std::vector<DoorScore> doors;
  std::optional<HeldOutScore> held_out;  // none: nothing was held out
};

struct GridEvaluation {
  LayerScore map;                         // map/grid/probability
  std::optional<LayerScore> most_likely;  // map/grid/occupied, where the map has it
  double cell_m = 0;
  // Which cells are free and which are due is by the poses that the map was made with: the truth has none.
  bool by_own_path = false;
  Similarity to_map;  // from the truth's frame; the identity where the poses are the true ones
  // Of the poses of the map's scans, after that; none: no true poses.
  std::optional<double> pose_rmse_m, pose_heading_rmse_deg;
  std::optional<double> seconds;
};

// `truth`: the log that the map was made of, with or without truth. Poses of the map in a frame of their own
// are laid over the true ones by the rigid motion that fits best.
// Throws InputError that says what does not fit.
GridEvaluation EvaluateGrid(const Blob& map, const Blob& truth_log);

// The map at other thresholds than 1/2: cells count as occupied from these log-odds on. A cell of which the
// map says nothing (kSaysNothingNats) is unknown at every threshold. As EvaluateGrid; throws InputError where
// the truth has no walls.
struct ThresholdScore {
  double log_odds = 0;
  CellScore cells;
  bool doors_right = true;
};
std::vector<ThresholdScore> ScoreByThreshold(const Blob& map, const Blob& truth_log,
                                             const std::vector<double>& log_odds);

// Against another map of the same place, in the same frame. Throws InputError where that tells of no cell.
GridEvaluation CompareGrids(const Blob& map, const Blob& reference);

Scores MakeScores(const GridEvaluation& evaluation);

}  // namespace cairn::datasets
