// What readings say of a map, from scratch: nothing here is shared with the search, whose gains every round
// holds against it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipelines/common/range_scans.h"
#include "pipelines/forward_map/forward_model.h"
#include "pipelines/pipeline.h"
#include "schema/kinds/fields.h"

namespace cairn::forward_map {

// Sums over readings, with the responsibilities ([Thr01] eq. 13) of their causes.
struct Evidence {
  double readings = 0;
  double log_likelihood = 0;  // sum_i log p(z_i | m)
  double entropy = 0;         // H(C | Z, m); [Thr01] eq. 11 = log_likelihood - entropy
  double random = 0;          // sum of E[c_*]
  double lost = 0;            // of readings whose echo was lost, whatever stood there
  double hits = 0;            // of E[c_k], k = 1 .. K
  double misses = 0;          // of obstacles that were passed undetected
  double squares_m2 = 0;      // of E[c_k] (z - d_k)^2

  void Add(const Evidence& other);
  static void Fields(const auto& field) {
    field("readings", &Evidence::readings);
    field("log_likelihood", &Evidence::log_likelihood);
    field("entropy", &Evidence::entropy);
    field("random", &Evidence::random);
    field("lost", &Evidence::lost);
    field("hits", &Evidence::hits);
    field("misses", &Evidence::misses);
    field("squares_m2", &Evidence::squares_m2);
  }
};

// Of the scans [first, end). occupied: [rows][columns] of `box`.
Evidence Weigh(const RangeScans& scans, std::size_t first, std::size_t end, const GridBox& box,
               std::span<const std::uint8_t> occupied, const SensorModel& model, bool no_echo,
               Progress& progress);

// The most likely cause of each reading, [scans][beams]: the cell of an obstacle, or one of these.
inline constexpr std::int32_t kNoEchoCause = -1;  // nothing was detected
inline constexpr std::int32_t kRandomCause = -2;
inline constexpr std::int32_t kLostCause = -4;    // the echo was lost, whatever stands there
inline constexpr std::int32_t kBeyondCause = -5;  // something beyond the map's box
inline constexpr std::int32_t kNotUsed = -3;      // held out, or without echo where those are not used
std::vector<std::int32_t> ExplainAll(const RangeScans& scans, const GridBox& box,
                                     std::span<const std::uint8_t> occupied, const SensorModel& model,
                                     bool no_echo, Progress& progress);

// The M-step of the sensor's parameters: of p_hit, p_rand and sigma the ones that make [Thr01] eq. 11
// largest, kept within bounds (sigma at least `least_sigma_m`). p_lost, no_echo_m and z_max_m stay.
SensorModel Improved(const SensorModel& model, const Evidence& evidence, double least_sigma_m);

}  // namespace cairn::forward_map
