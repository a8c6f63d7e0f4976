#include "pipelines/landmark_learning/optimizer/batch.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "schema/rng.h"

namespace cairn::landmark_learning {

std::vector<IndexRange> DrawnStretches(int count, std::int64_t batch, std::uint64_t seed, std::int64_t step) {
  if (batch <= 0 || batch >= count) return {{0, count}};
  std::vector<int> stretches(static_cast<std::size_t>((count + kStretch - 1) / kStretch));
  std::iota(stretches.begin(), stretches.end(), 0);
  const auto drawn = std::min(stretches.size(), static_cast<std::size_t>((batch + kStretch - 1) / kStretch));
  Rng rng(seed, static_cast<std::uint64_t>(step), 1);  // substream 0 draws the first weights
  for (std::size_t i = 0; i < drawn; ++i)
    // [Thr98] section 4.4.2: stochastic gradients
    std::swap(stretches[i], stretches[i + static_cast<std::size_t>(rng.Below(stretches.size() - i))]);
  std::sort(stretches.begin(), stretches.begin() + static_cast<std::ptrdiff_t>(drawn));
  std::vector<IndexRange> ranges;
  for (std::size_t i = 0; i < drawn; ++i)
    ranges.push_back({stretches[i] * kStretch, std::min(count, (stretches[i] + 1) * kStretch)});
  return ranges;
}

int TruePositionsIn(const std::vector<IndexRange>& stretches) {
  int true_positions = 0;
  for (const IndexRange& stretch : stretches) true_positions += stretch.size();
  return true_positions;
}

}  // namespace cairn::landmark_learning
