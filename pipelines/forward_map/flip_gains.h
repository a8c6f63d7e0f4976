// What the log-likelihood of readings gains where a cell of the map flips, kept up to date from flip to flip.
//
// The cells of a beam that lie more than kReach sigma beyond its reading cannot matter and are not looked at;
// of those more than that before it only the number of occupied ones matters; the others, the reading's
// window, have a weight w = sound p_hit N(z; d, sigma) each. With K0 obstacles before the window and K
// in it, q = 1 - p_hit,
//   p(z | m) = floor + q^K0 S,   S = sum_k q^(k-1) w_k + q^K none,
// where sound = 1 - p_rand - p_lost, none = sound N(z; z_max, no_echo) (beyond the map: sound / z_max) and
// floor = p_rand / z_max + p_lost N(z; z_max, no_echo): [Thr01] eqs 4 to 9. So a flip before the window
// changes K0 alone, and its gain is one number for all those cells; a flip in it changes S, and what S would
// be after each flip in the window is kept beside it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipelines/forward_map/forward_model.h"

namespace cairn::forward_map {

// A cell that a beam meets.
struct Crossing {
  std::int32_t cell;  // kElsewhere: an obstacle that stays
  double distance_m;
};
inline constexpr std::int32_t kElsewhere = -1;

class FlipGains {
 public:
  // Of `cells` cells; readings name one of `models`.
  FlipGains(std::int32_t cells, std::vector<SensorModel> models);

  // First all readings, each with the cells of its beam in any order …
  void Add(double z_m, std::size_t model, std::span<const Crossing> beam, End end = End::kInMap);
  // … then once the map, [cells], 1: occupied.
  void Start(std::span<const std::uint8_t> occupied);

  const std::vector<std::uint8_t>& occupied() const { return occupied_; }
  // What sum_i log p(z_i | m) gains where the cell flips, in nats; costs the number of its readings.
  double GainOf(std::int32_t cell) const;
  void Flip(std::int32_t cell);
  // The search may flip a cell to see what comes of it and flip it back. A flip that stays is kept: gains of
  // cells of which no reading has changed since `kept` flips were kept are what they were then.
  void Keep(std::int32_t cell);
  std::uint64_t kept() const { return kept_; }
  bool ChangedSince(std::int32_t cell, std::uint64_t kept) const;

  // Cells in the window of some reading, ascending: no other can gain by becoming occupied.
  const std::vector<std::int32_t>& near_ends() const { return near_ends_; }
  // Whether any reading's beam meets the cell.
  bool Seen(std::int32_t cell) const;
  // What the readings that meet an occupied cell, in the order in which they were added, say of it.
  struct Look {
    std::uint32_t reading;
    double caught;  // P(the reading is of the cell): E[c_ik] of [Thr01] eq. 13
    double missed;  // P(it was passed undetected)
  };
  std::vector<Look> LooksAt(std::int32_t cell) const;
  double MissProbability(std::uint32_t reading) const { return 1 - models_[readings_[reading].model].p_hit; }
  // The cells that share a window with `cell`, ascending, without it.
  std::vector<std::int32_t> Sharing(std::int32_t cell) const;

 private:
  struct Reading {
    double floor, none, sum = 0;  // S
    std::int32_t before = 0;      // K0
    std::uint32_t model = 0;
  };
  // What a reading says of flips, as the map is.
  struct Answer {
    double more = 0, less = 0;       // gain of an obstacle more, less, before its window
    double constant = 1, slope = 0;  // p(z | m) after a flip in it, over that now: constant + slope S
  };
  // Lists of T, one for each key.
  template <class T>
  struct Lists {
    std::vector<std::uint64_t> first;
    std::vector<T> value;
    std::span<const T> Of(std::size_t key) const {
      return {value.data() + first[key], value.data() + first[key + 1]};
    }
  };
  struct Place {  // of a cell in a reading's window
    std::uint32_t reading, entry;
  };

  void Change(std::size_t cell);  // without what follows
  void RefreshWindow(std::uint32_t reading);
  void RefreshAnswer(std::uint32_t reading);
  void Transpose();

  std::vector<SensorModel> models_;
  std::vector<std::vector<double>> power_;  // [model][n] (1 - p_hit)^n
  std::size_t longest_ = 0;                 // beam
  std::vector<Reading> readings_;
  std::vector<Answer> answers_;           // [reading]
  std::vector<Crossing> window_of_beam_;  // work space of Add
  std::vector<double> tails_;             // work space of RefreshWindow
  // Entries: the windows of all readings, each by distance, one after the other.
  Lists<std::int32_t> window_;                         // [reading] the entries' cells
  std::vector<double> weight_, other_;                 // [entry] w; S after a flip of it
  std::vector<std::vector<std::uint32_t>> obstacles_;  // [reading] the occupied entries, by distance
  // As the readings came: cells before the windows.
  std::vector<std::uint64_t> before_end_;
  std::vector<std::int32_t> before_cell_;
  // By cell.
  Lists<std::uint32_t> before_;
  Lists<Place> places_;
  std::vector<std::uint8_t> occupied_;
  std::vector<std::int32_t> near_ends_;
  // Flips that were kept: how many in all, and at the last one that changed a reading.
  std::uint64_t kept_ = 0;
  std::vector<std::uint64_t> kept_at_;  // [reading]
};

}  // namespace cairn::forward_map
