#include "pipelines/localization/position_index.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "schema/rng.h"

namespace cairn::localization {
namespace {

// Some on a grid, so that many are equally far away and many lie on a split; some twice at one position.
std::vector<Position> ManyPositions() {
  Rng rng(5);
  std::vector<Position> positions;
  for (int i = 0; i < 150; ++i) positions.push_back({rng.Uniform(0, 20), rng.Uniform(0, 4)});
  for (int i = 0; i < 150; ++i)
    positions.push_back({static_cast<double>(rng.Below(12)), static_cast<double>(rng.Below(5))});
  return positions;
}

std::vector<std::size_t> AllByDistance(const std::vector<Position>& positions, const Position& from) {
  std::vector<std::pair<double, std::size_t>> all;
  for (std::size_t i = 0; i < positions.size(); ++i) all.emplace_back(DistanceM(positions[i], from), i);
  std::ranges::sort(all);
  std::vector<std::size_t> order;
  for (const auto& [distance_m, position] : all) order.push_back(position);
  return order;
}

TEST(PositionIndex, FindsTheNearestThatALinearScanFinds) {
  const std::vector<Position> positions = ManyPositions();
  const PositionIndex index(positions);
  Rng rng(6);
  for (int query = 0; query < 200; ++query) {
    const Position from = query % 2 == 0 ? Position{rng.Uniform(-3, 23), rng.Uniform(-2, 6)}
                                         : positions[static_cast<std::size_t>(query)];
    for (const std::size_t count : {std::size_t{1}, std::size_t{7}, positions.size()}) {
      std::vector<std::size_t> expected = AllByDistance(positions, from);
      expected.resize(count);
      EXPECT_EQ(index.Nearest(from, count), expected) << "query " << query << ", " << count;
    }
  }
}

TEST(PositionIndex, FindsAllWithinARadiusItsRimToo) {
  const std::vector<Position> positions = ManyPositions();
  const PositionIndex index(positions);
  Rng rng(7);
  std::size_t found = 0;
  for (int query = 0; query < 200; ++query) {
    const Position from{static_cast<double>(rng.Below(12)), static_cast<double>(rng.Below(5))};
    const double radius_m = query % 3 == 0 ? 1.0 : rng.Uniform(0, 5);
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (DistanceM(positions[i], from) <= radius_m) expected.push_back(i);
    }
    found += expected.size();
    EXPECT_EQ(index.Within(from, radius_m), expected);
  }
  EXPECT_GT(found, 1000U);
}

}  // namespace
}  // namespace cairn::localization
