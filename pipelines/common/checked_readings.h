// How well a map of occupancy predicts readings that it was not made of, beside a map that knows nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipelines/common/grid_box.h"
#include "pipelines/common/range_scans.h"

namespace cairn {

// What a reading of a sensor is like: forward_map's model (its README).
struct ReadingModel {
  double p_hit = 0.7;       // P(an obstacle in the beam is detected)
  double p_rand = 0.05;     // P(a reading is of nothing), evenly distributed up to z_max_m
  double p_lost = 0.01;     // P(there is no echo, whatever stands there)
  double sigma_m = 0.05;    // of a reading about the obstacle that was detected
  double no_echo_m = 0.05;  // of a reading without echo about z_max_m
  double z_max_m = 10;
  bool no_echo = true;  // a reading without echo tells of something
};

// What a beam meets: with probability q there is an obstacle.
struct MetCell {
  double distance_m, q;
};

// p(z | map) in 1/m, of a map that holds probabilities. `cells`: nearest first; `ends_beyond`: the reading is
// an echo from beyond the map, of something that this does not hold.
double DensityOf(double z_m, std::span<const MetCell> cells, const ReadingModel& model, bool ends_beyond);

// Those scans alone that a map is checked with and that it would be made of: for whoever takes them out; and
// all others.
RangeScans CheckedOnly(RangeScans scans);
RangeScans WithoutChecked(RangeScans scans);

// Of readings, summed up; nats, of densities in 1/m.
struct CheckedReadings {
  std::int64_t readings = 0;
  double log_likelihood = 0;  // in the map
  double ignorant =
      0;  // in the best of the maps whose cells are all alike, which knows no place from another

  void Add(const CheckedReadings& other);
};

// Of the scans that are `checked`, 500 readings at most, spread evenly. Each map has the p_hit, p_rand and
// sigma of its own that explain them best, `model` or of a few others. probability: [cells] of a map without
// these scans, which is read as people do: above 1/2 there is an obstacle, below there is none. NaN, and 1/2:
// nothing is known, and the map that knows nothing is asked.
CheckedReadings Check(const RangeScans& scans, const GridBox& box, std::span<const double> probability,
                      const ReadingModel& model);

// In steps, where scans are read part by part: how many readings of a part could be taken; those that are,
// where `before` of `all` lie in parts before; and the check with what was taken of all parts, in their
// order.
struct TakenReading {
  Pose from;  // where the beam begins and points
  double range_m = 0;
};
inline constexpr std::size_t kMostChecked = 500;  // of a sensor
std::int64_t CountReadings(const RangeScans& part, const ReadingModel& model);
std::vector<TakenReading> TakeReadings(const RangeScans& part, const ReadingModel& model, std::int64_t before,
                                       std::int64_t all);
CheckedReadings Check(std::span<const TakenReading> taken, double opening_rad, const GridBox& box,
                      std::span<const double> probability, const ReadingModel& model);

// `fit/` of a grid_map (schema/FORMAT.md); nothing where no reading was checked.
void PutCheck(const CheckedReadings& checked, Blob* result);

}  // namespace cairn
