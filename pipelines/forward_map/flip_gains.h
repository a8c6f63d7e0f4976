// What the log-likelihood of readings gains where a cell of the map flips, kept up to date from flip to flip.
//
// The cells of a beam that lie more than kReach sigma beyond its reading cannot matter and are not looked at;
// of those more than that before it only the number of occupied ones matters; the others, the reading's
// window, have a weight w = (1 - p_rand) p_hit N(z; d, sigma) each. With K0 obstacles before the window and K
// in it, q = 1 - p_hit,
//   p(z | m) = floor + q^K0 S,   S = sum_k q^(k-1) w_k + q^K none,
// where floor = p_rand / z_max and none = (1 - p_rand) N(z; z_max, no_echo): [T01] eqs 4 to 9. So a flip
// before the window changes K0 alone, and its gain is one number for all those cells.
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
  void Add(double z_m, std::size_t model, std::span<const Crossing> beam);
  // … then once the map, [cells], 1: occupied.
  void Start(std::span<const std::uint8_t> occupied);

  const std::vector<std::uint8_t>& occupied() const { return occupied_; }
  // What sum_i log p(z_i | m) gains where the cell flips, in nats; costs the number of its readings.
  double GainOf(std::int32_t cell) const;
  void Flip(std::int32_t cell);

  // Cells in the window of some reading, ascending: no other can gain by becoming occupied.
  const std::vector<std::int32_t>& near_ends() const { return near_ends_; }
  // Whether any reading's beam meets the cell.
  bool Seen(std::int32_t cell) const;
  // What the readings that meet an occupied cell, in the order in which they were added, say of it.
  struct Look {
    std::uint32_t reading;
    double caught;  // P(the reading is of the cell): E[c_ik] of (13)
    double missed;  // P(it was passed undetected)
  };
  std::vector<Look> LooksAt(std::int32_t cell) const;
  double MissProbability(std::uint32_t reading) const { return 1 - models_[readings_[reading].model].p_hit; }
  // The cells that share a window with `cell`, ascending, without it.
  std::vector<std::int32_t> Sharing(std::int32_t cell) const;
  std::size_t byte_count() const;

 private:
  struct Obstacle {
    std::uint32_t order;  // in the window, by distance
    double weight;
    double sum_before = 0, passed = 1;  // sum of S over the obstacles before it; q^(k-1)
  };
  struct Reading {
    double floor, none, sum;  // S
    std::int32_t before = 0;  // K0
    std::uint32_t model = 0;
  };
  struct Entry {  // a cell in a reading's window
    std::uint32_t reading, order;
    double weight;
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

  double SumWith(const Reading& reading, std::span<const Obstacle> obstacles, const Entry& entry) const;
  double SumWithout(const Reading& reading, std::span<const Obstacle> obstacles, const Entry& entry) const;
  double RatioOf(const Entry& entry, bool occupied) const;
  void Change(std::size_t cell);  // without Refresh
  void Refresh(std::uint32_t reading);
  void Transpose();

  std::vector<SensorModel> models_;
  std::vector<std::vector<double>> power_;  // [model][n] (1 - p_hit)^n
  std::size_t longest_ = 0;                 // beam
  std::vector<Reading> readings_;
  std::vector<Crossing> window_of_beam_;          // work space of Add
  std::vector<std::vector<Obstacle>> obstacles_;  // [reading] in its window, in order
  std::vector<double> more_, less_;  // [reading] gain of an obstacle more, less, before its window
  // As the readings came: cells before the windows, and in them.
  std::vector<std::uint64_t> before_end_;
  std::vector<std::int32_t> before_cell_;
  Lists<std::int32_t> window_cell_;  // by reading
  std::vector<Entry> window_entry_;  // beside window_cell_
  // By cell.
  Lists<std::uint32_t> before_;
  Lists<Entry> window_;
  std::vector<std::uint8_t> occupied_;
  std::vector<std::int32_t> near_ends_;
};

}  // namespace cairn::forward_map
