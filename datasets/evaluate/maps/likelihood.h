// How well a grid map predicts range readings that it was not made of, by the forward model of [Thr01] eqs 4
// to 9, with probabilities in place of obstacles. Shares nothing with the pipelines: its own cells of cones
// and rays, its own fit.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "datasets/common/occupancy.h"
#include "datasets/evaluate/maps/scored_scans.h"

namespace cairn::datasets {

// Of (6): a reading without echo is taken for one of max_range_m by a normal density of this fixed width, so
// that the fit of sigma_m is not about readings that have no error.
inline constexpr double kNoEchoSdM = 0.05;

struct ReadingModel {
  double p_hit = 0.7, p_rand = 0.05, sigma_m = 0.05;
};

// What a beam meets, by distance: the probability q that there is an obstacle.
struct MetCell {
  double distance_m, q;
};
struct ScoredReading {
  double z_m = 0;  // max_range_m where there was no echo
  bool echo = true;
  double max_range_m = 0;
  std::vector<MetCell> cells;
};

// ln p(z), 1/m: p_rand / max_range + (1 - p_rand) (sum_k hit_k N(z; d_k, sigma) + prod_k (1 - q_k p_hit)
// N(z; max_range, kNoEchoSdM)), where hit_k = q_k p_hit prod_{j < k} (1 - q_j p_hit); the last term of
// readings without echo alone, the sum of those with one.
double LogDensity(const ScoredReading& reading, const ReadingModel& model);

// The cells of a beam, nearest first: of a cone those whose centre lies in it, and those on its axis;
// distances are to centres, on rays and axes to the middle of the way through a cell. Cells of which the map
// knows nothing count as occupied by the mean probability of those of which it does; beyond the map there is
// nothing.
class BeamReader {
 public:
  explicit BeamReader(const Occupancy& map);
  ScoredReading Read(const ScoredSensor& sensor, std::size_t scan, std::size_t beam) const;
  double unknown_probability() const { return unknown_; }

 private:
  void AddCone(const Pose& from, double half_rad, double reach_m, ScoredReading* reading) const;
  void AddRay(const Pose& from, double half_rad, double reach_m, ScoredReading* reading) const;
  void Add(std::int64_t column, std::int64_t row, double distance_m, ScoredReading* reading) const;

  const Occupancy& map_;
  double unknown_ = 0;
};

// The model under which `readings` are likeliest: by coordinate search over a grid that gets finer. Without
// readings the default.
ReadingModel FitReadingModel(const std::vector<ScoredReading>& readings);

struct SensorLikelihood {
  std::string name;
  ReadingModel model;  // fitted on readings that the map was made of, of 2,000 at most
  std::int64_t readings = 0;
  double log_likelihood = 0;  // of the held-out readings, their sum
};

struct HeldOutScore {
  std::vector<SensorLikelihood> sensors;  // those that have any held out
  std::int64_t readings = 0;
  double log_likelihood_per_reading = 0;
};

// None where no scan is held out.
std::optional<HeldOutScore> ScoreHeldOut(const Occupancy& map, const std::vector<ScoredSensor>& sensors);

}  // namespace cairn::datasets
