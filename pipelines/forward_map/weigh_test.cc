#include "pipelines/forward_map/weigh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "pipelines/forward_map/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::forward_map {
namespace {

// A ray along a row of cells of 1 m, of which the third and the fifth are obstacles, that measures `z_m`.
RangeScans OneRay(double z_m) {
  RangeScans scans;
  scans.beams = {{0, 0, 0}};
  scans.max_range_m = 10;
  scans.time_s = {0};
  scans.pose = {{0, 0.5, 0}};
  scans.held_out = {0};
  scans.range_m = Array::Of<double>({1, 1}, std::vector<double>{z_m});
  return scans;
}
constexpr GridBox kRow{0, 0, 1, 6, 1};
const std::vector<std::uint8_t> kObstacles = {0, 0, 1, 0, 1, 0};
constexpr SensorModel kWeighModel{
    .p_hit = 0.6, .p_rand = 0.1, .sigma_m = 0.1, .no_echo_m = 0.1, .z_max_m = 10};

TEST(Weigh, OfOneRayIsTheModelByHand) {
  NoProgress progress;
  const Evidence near = Weigh(OneRay(2.6), 0, 1, kRow, kObstacles, kWeighModel, true, progress);
  const double floor = 0.01, hit = 0.9 * 0.6 * 3.989422804014327 * std::exp(-0.5);
  EXPECT_EQ(near.readings, 1);
  EXPECT_NEAR(near.log_likelihood, std::log(floor + hit), 1e-9);
  EXPECT_NEAR(near.hits, hit / (floor + hit), 1e-9);
  EXPECT_NEAR(near.random, floor / (floor + hit), 1e-9);
  EXPECT_NEAR(near.squares_m2, near.hits * 0.01, 1e-9);
  EXPECT_EQ(near.misses, 0);
  const Evidence far = Weigh(OneRay(4.5), 0, 1, kRow, kObstacles, kWeighModel, true, progress);
  EXPECT_NEAR(far.misses, far.hits, 1e-12);  // passed the first
  const Evidence none = Weigh(OneRay(std::nan("")), 0, 1, kRow, kObstacles, kWeighModel, true, progress);
  EXPECT_NEAR(none.log_likelihood, std::log(floor + 0.9 * 0.16 * 3.989422804014327), 1e-9);
  EXPECT_NEAR(none.misses, 2 * (1 - none.random), 1e-12);
  EXPECT_EQ(Weigh(OneRay(std::nan("")), 0, 1, kRow, kObstacles, kWeighModel, false, progress).readings, 0);
}

TEST(Weigh, OfSlicesAddsUp) {
  const Room room{.opening_rad = 0.26};
  const std::vector<RangeScans> sensors = SensorsOf(room);
  MapState map = EmptyMapOf(room, 0.1);
  for (std::size_t cell = 0; cell < map.occupied.size(); cell += 7) map.occupied[cell] = 1;
  NoProgress progress;
  Evidence sum;
  for (const auto& [first, end] : {std::pair<std::size_t, std::size_t>{0, 11}, {11, 12}, {12, 30}})
    sum.Add(Weigh(sensors[0], first, end, map.box, map.occupied, map.models[0], true, progress));
  const Evidence whole = Weigh(sensors[0], 0, 30, map.box, map.occupied, map.models[0], true, progress);
  EXPECT_EQ(sum.readings, whole.readings);
  EXPECT_NEAR(sum.log_likelihood, whole.log_likelihood, 1e-9 * std::abs(whole.log_likelihood));
  EXPECT_NEAR(Read<Evidence>(BlobOf(sum)).misses, whole.misses, 1e-9 * whole.misses);
  EXPECT_NEAR(whole.random + whole.hits, whole.readings, 0.5 * whole.readings);
}

TEST(ExplainAll, NamesTheMostLikelyCause) {
  NoProgress progress;
  SensorModel model = kWeighModel;
  const auto cause = [&](double z_m, bool no_echo = true) {
    return ExplainAll(OneRay(z_m), kRow, kObstacles, model, no_echo, progress).front();
  };
  EXPECT_EQ(cause(2.5), 2);
  EXPECT_EQ(cause(4.4), 4);
  EXPECT_EQ(cause(1), kRandomCause);
  EXPECT_EQ(cause(std::nan("")), kNoEchoCause);
  EXPECT_EQ(cause(std::nan(""), false), kNotUsed);
  EXPECT_EQ(cause(7), kBeyondCause);
  model.p_lost = 0.3;
  EXPECT_EQ(cause(std::nan("")), kLostCause);
  EXPECT_EQ(cause(2.5), 2);
}

// The M-step by hand, and that it climbs: EM's promise for the parameters, the map being as it is.
TEST(Improved, IsTheMStepAndClimbs) {
  const SensorModel by_hand =
      Improved(kWeighModel, {.readings = 10, .random = 2, .hits = 6, .misses = 3, .squares_m2 = 0.24}, 0.01);
  EXPECT_NEAR(by_hand.p_rand, 0.2, 1e-12);
  EXPECT_NEAR(by_hand.p_hit, 2.0 / 3, 1e-12);
  EXPECT_NEAR(by_hand.sigma_m, 0.2, 1e-12);
  EXPECT_EQ(by_hand.no_echo_m, kWeighModel.no_echo_m);
  EXPECT_EQ(Improved(kWeighModel, {.readings = 10, .hits = 6, .squares_m2 = 0}, 0.01).sigma_m, 0.01);
  EXPECT_EQ(Improved(kWeighModel, {}, 0.01), kWeighModel);
  SensorModel losing = kWeighModel;
  losing.p_lost = 0.2;
  const SensorModel of_losing = Improved(losing, {.readings = 10, .random = 2, .lost = 2}, 0.01);
  EXPECT_NEAR(of_losing.p_rand, 0.8 * 2 / 8, 1e-12);
  EXPECT_EQ(of_losing.p_lost, 0.2);

  const Room room{};
  const std::vector<RangeScans> sensors = SensorsOf(room);
  MapState map = EmptyMapOf(room, 0.1);
  Rng rng(9);
  for (std::uint8_t& cell : map.occupied) cell = rng.Uniform() < 0.1 ? 1 : 0;
  NoProgress progress;
  map.models[0].p_lost = 0.02;
  double before = -std::numeric_limits<double>::infinity();
  for (int step = 0; step < 10; ++step) {
    const Evidence evidence =
        Weigh(sensors[0], 0, sensors[0].scans(), map.box, map.occupied, map.models[0], true, progress);
    EXPECT_GT(evidence.log_likelihood, before - 1e-6);
    before = evidence.log_likelihood;
    map.models[0] = Improved(map.models[0], evidence, 0.001);
  }
}

}  // namespace
}  // namespace cairn::forward_map
