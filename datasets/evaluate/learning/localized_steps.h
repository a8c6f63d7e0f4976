// A result of kind `localization` (schema/FORMAT.md), step by step.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

struct LocalizedStep {
  std::int32_t traverse = 0, run = 0, sample = 0;
  std::size_t sensations = 0;  // so far on this traverse
  double travelled_m = 0, spread_m = 0;
  Point mean, mode;
  std::size_t first = 0, end = 0;  // of its belief's entries
};

// Lives as long as the result.
struct LocalizedSteps {
  // Throws InputError: no localization, arrays that do not fit each other, no steps, a position that is no
  // number, a belief that does not sum to 1.
  explicit LocalizedSteps(const Blob& result);

  std::vector<LocalizedStep> steps;
  std::vector<Point> positions;
  std::span<const double> heading_rad;     // of each position; empty where headings do not count
  std::span<const std::int32_t> position;  // of each entry, an index into `positions`
  std::span<const float> probability;      // of each entry

 private:
  void CheckBelief(std::span<const std::int64_t> entries) const;
};

}  // namespace cairn::datasets
