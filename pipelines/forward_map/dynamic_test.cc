#include "pipelines/forward_map/dynamic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/forward_map/testing.h"

namespace cairn::forward_map {
namespace {

constexpr SensorModel kDynamicModel{
    .p_hit = 0.5, .p_rand = 0.05, .sigma_m = 0.1, .no_echo_m = 0.1, .z_max_m = 10};
const std::vector<Crossing> kBeam = {{0, 1}, {1, 3}};

// A wall in cell 1; in cell 0 something that a beam met or passed, one reading a second.
double Nats(const std::vector<bool>& met) {
  std::vector<BeamReading> readings;
  std::vector<double> time_s;
  for (const bool m : met) {
    readings.push_back({m ? 1.0 : 3.0, kBeam});
    time_s.push_back(static_cast<double>(time_s.size()));
  }
  return CameAndWentNats(GainsOf(readings, {1, 1}, kDynamicModel), time_s, 0);
}

// A reading of the wall, the cell before it being occupied, was certainly not caught there; it was random
// with a probability of `floor` in all.
TEST(CameAndWent, CountsTheBeamsThatPassedAtOtherTimes) {
  const double floor = 0.005, far = 0.95 * 0.25 * 3.989422804014327;
  const double each = std::log(2) * far / (floor + far);
  EXPECT_NEAR(Nats({true, true, false, false, false, false, false}), 5 * each, 1e-9);
  EXPECT_NEAR(Nats({false, true, false, true, false, false, false, false}), 5 * each, 1e-9);
}

TEST(CameAndWent, IsNotWhatIsMissedWhileItIsMet) {
  EXPECT_EQ(Nats({true, false, false, false, true}), 0);        // no more often elsewhen than it was met
  EXPECT_EQ(Nats({true, true, true, false, false, false}), 0);  // less than twice as often
  EXPECT_EQ(Nats({false, false, false}), 0);                    // never met
}

}  // namespace
}  // namespace cairn::forward_map
