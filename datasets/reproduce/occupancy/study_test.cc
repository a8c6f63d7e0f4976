#include "datasets/reproduce/occupancy/study.h"

#include <gtest/gtest.h>

#include <set>

#include "datasets/evaluate/testing/grid.h"
#include "datasets/reproduce/occupancy/figures.h"
#include "datasets/reproduce/occupancy/scores.h"
#include "datasets/reproduce/occupancy/thresholds.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

TEST(OccupancyStudy, StagesUseWhatThereIs) {
  for (const OccupancyStudy& study : {MakeOccupancyStudy(7, 2, nullptr), MakeCurveStudy(7, 1)}) {
    std::set<std::string> known;
    for (const auto& [name, path] : study.job.inputs()) known.insert(name);
    EXPECT_EQ(known.size(), study.inputs.size());
    for (const proto::Stage& stage : study.job.stages()) {
      for (const auto& [input, source] : stage.inputs()) EXPECT_TRUE(known.contains(source)) << source;
      EXPECT_TRUE(known.insert(stage.name()).second) << stage.name();
    }
  }
  EXPECT_EQ(MakeOccupancyStudy(7, 2, nullptr).halls.size(), 12U);
}

TEST(OccupancyStudy, AMissingResultIsNamed) {
  ExpectContains(InputErrorOf([] { OccupancyFigures(MakeOccupancyStudy(7, 1, nullptr), {}); }),
                 "crossing_default");
}

TEST(LeastMissed, IsOfTheBestPointThatIsAllowed) {
  const std::vector<ThresholdPoint> curve{{900, 0.0, 0.5}, {40, 0.1, 1}, {7, 0.3, 1}};
  EXPECT_EQ(LeastMissed(curve, 1000), 0);
  EXPECT_EQ(LeastMissed(curve, 899), 0.1);
  EXPECT_EQ(LeastMissed(curve, 40), 0.1);
  EXPECT_EQ(LeastMissed(curve, 5), 1);
}

// By hand: of 4 m of wall the middle 2 have obstacles beside them.
TEST(WallFound, IsTheShareOfPointsWithAnObstacleBesideThem) {
  const Occupancy map = ReadOccupancy(DrawnMap({"........", "..####..", "........", "........"}, 0.5));
  EXPECT_NEAR(WallFound(map, {{0, 1.25}, {4, 1.25}}, 0, 4), 12.0 / 17, 1e-9);  // a cell more at each end
  EXPECT_EQ(WallFound(map, {{0, 0.25}, {4, 0.25}}, 0, 4), 0);
  EXPECT_NEAR(WallFound(map, {{0, 1.25}, {4, 1.25}}, 1, 3), 1, 1e-9);
}

TEST(Stripes, AreChangesAlongTheWallNotAcrossIt) {
  const std::vector<std::string> across{"........", "........", "########", "########"};
  const std::vector<std::string> along{"........", ".#.#.#.#", ".#.#.#.#", ".#.#.#.#"};
  EXPECT_EQ(Stripes(ReadOccupancy(DrawnMap(across, 0.25)), 1, 0, 1.75), 0);
  EXPECT_NEAR(Stripes(ReadOccupancy(DrawnMap(along, 0.25)), 1, 0, 1.75), 2 * 0.8 / 3,
              1e-9);  // one row of three is even
}

}  // namespace
}  // namespace cairn::datasets
