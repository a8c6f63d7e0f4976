// The M-step as it has to be: flips of cells that raise the log-likelihood of the readings, each weighed with
// the correspondences as they are after it ([Thr01] section 3.3; with those of before, an empty cell has none
// and the empty map stays empty). Then moves that get out of where single flips end.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "pipelines/forward_map/flip_gains.h"

namespace cairn::forward_map {

// What is known of maps before any reading; nothing by default.
struct MapPrior {
  double logit = 0;       // log-odds of a cell being occupied
  double smoothness = 0;  // nats that each pair of unlike cells side by side costs
};

struct Moves {
  bool swaps = true;  // an obstacle to a neighbouring cell
  bool pairs = true;  // two flips at once, of cells that share a reading's window
};

// A rectangle of cells, row by row, within a rim of one cell that does not change.
struct Patch {
  std::int32_t columns = 0, rows = 0;
  std::vector<std::uint8_t> rimmed;  // [rows + 2][columns + 2], 1: occupied

  static Patch Empty(std::int32_t columns, std::int32_t rows);
  std::int32_t cells() const { return columns * rows; }
  std::size_t Rimmed(std::int32_t cell) const {
    return static_cast<std::size_t>((cell / columns + 1) * (columns + 2) + cell % columns + 1);
  }
  std::vector<std::uint8_t> Inside() const;  // [cells]
};

class MapSearch {
 public:
  // `gains` has been started with the inside of `patch`, and changes with the map.
  MapSearch(FlipGains* gains, Patch patch, const MapPrior& prior);

  double GainOf(std::int32_t cell) const { return gains_->GainOf(cell) + PriorGainOf(cell); }
  std::uint8_t occupied(std::int32_t cell) const { return patch_.rimmed[patch_.Rimmed(cell)]; }
  void Flip(std::int32_t cell);

  // Each returns what it gained, at least 0. `tick` is called every few milliseconds.
  using Tick = std::function<void()>;
  // Flips the cell that gains most, again and again, until none gains.
  double Climb(const Tick& tick);
  double Swaps(const Tick& tick);
  double Pairs(const Tick& tick);
  // All of them until nothing gains.
  double Run(const Moves& moves, const Tick& tick);

 private:
  double PriorGainOf(std::int32_t cell) const;
  std::vector<std::int32_t> Candidates() const;
  std::vector<std::int32_t> Neighbours(std::int32_t cell) const;
  bool IsNear(std::int32_t a, std::int32_t b) const;
  // A flip that may be taken back.
  void Try(std::int32_t cell);
  // The cell's gain, and that it was looked at.
  double Look(std::int32_t cell);
  // Whether the cell's gain is what it was when `kept` flips had been kept.
  bool AsWhen(std::int32_t cell, std::uint64_t kept) const;
  double FlipWithBestOf(std::int32_t cell, double gain, const std::vector<std::int32_t>& others);

  FlipGains* gains_;
  Patch patch_;
  MapPrior prior_;
  // [cells] flips kept when it was found that the cell gains nothing, and its swaps were last tried.
  std::vector<std::uint64_t> lost_at_, swapped_at_;
};

}  // namespace cairn::forward_map
