#include "pipelines/localization/space.h"

#include <gtest/gtest.h>

namespace cairn::localization {
namespace {

// A corridor of 80 steps, in whose first half a sample was taken at every second step, in its second half at
// every one.
Source CorridorRecordedTwiceAsDenselyFromItsMiddleOn(double step_m) {
  Source source;
  source.feature_names = {"door"};
  for (int k = 0; k < 80; k += k < 40 ? 2 : 1) {
    source.map_positions.push_back({k * step_m, 0.0});
    source.map_output.push_back(0.5);
  }
  return source;
}

// A robot that knows nothing is as likely in one half as in the other (belief.h: by room), whether positions
// lie nearer to each other than it may err in a step or farther.
TEST(MapOfBlock, RoomDoesNotPreferWhereMoreWasRecorded) {
  for (const double step_m : {0.03, 1.0}) {
    const Source source = CorridorRecordedTwiceAsDenselyFromItsMiddleOn(step_m);
    const Options options;
    const Poses poses = BeliefPositions(options, source);
    const FeatureMap map = MapOfBlock(options, source, poses, 0, poses.positions.size());
    double sparse = 0.0, dense = 0.0;
    for (std::size_t k = 0; k < poses.positions.size(); ++k) {
      const double steps = poses.positions[k].x_m / step_m;
      if (steps > 9.5 && steps < 29.5) sparse += map.room[k];  // 20 steps of each, far from the ends
      if (steps > 49.5 && steps < 69.5) dense += map.room[k];
    }
    EXPECT_NEAR(dense, sparse, 0.01 * sparse) << step_m;
  }
}

}  // namespace
}  // namespace cairn::localization
