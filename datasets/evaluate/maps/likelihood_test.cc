#include "datasets/evaluate/maps/likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/evaluate/testing/grid.h"
#include "schema/rng.h"

namespace cairn::datasets {
namespace {

constexpr double kNoReading = std::numeric_limits<double>::quiet_NaN();

double Normal(double x, double sigma) {
  return std::exp(-x * x / (2 * sigma * sigma)) / (sigma * std::sqrt(2 * std::numbers::pi));
}

TEST(LogDensity, OfTwoCellsByHand) {
  const ReadingModel model{0.6, 0.1, 0.2};
  ScoredReading reading{2.1, true, 10, {{2, 0.5}, {2.5, 0.9}}};
  const double first = 0.5 * 0.6, second = 0.7 * 0.9 * 0.6;
  EXPECT_NEAR(LogDensity(reading, model),
              std::log(0.1 / 10 + 0.9 * (first * Normal(0.1, 0.2) + second * Normal(0.4, 0.2))), 1e-12);
  reading.echo = false;
  reading.z_m = 10;
  EXPECT_NEAR(LogDensity(reading, model), std::log(0.1 / 10 + 0.9 * 0.7 * (1 - 0.54) * Normal(0, kNoEchoSdM)),
              1e-12);
}

TEST(LogDensity, IntegratesToWhatIsHeard) {
  const ReadingModel model{0.7, 0.05, 0.1};
  ScoredReading reading{0, true, 10, {{3, 0.2}, {4, 0.8}, {7, 1}}};
  double mass = 0;
  constexpr double kStepM = 1e-3;
  for (reading.z_m = kStepM / 2; reading.z_m < 10; reading.z_m += kStepM)
    mass += std::exp(LogDensity(reading, model)) * kStepM;
  const double silent = (1 - 0.14) * (1 - 0.56) * (1 - 0.7);
  EXPECT_NEAR(mass, 0.05 + 0.95 * (1 - silent), 1e-6);
}

ScoredSensor Sensor(double opening_rad, const std::vector<double>& ranges) {
  ScoredSensor sensor;
  sensor.name = "robot/0/sonar/";
  sensor.opening_rad = opening_rad;
  sensor.max_range_m = 6;
  sensor.beams = {{0, 0, 0}};
  for (const double range : ranges) {
    sensor.time_s.push_back(static_cast<double>(sensor.time_s.size()));
    sensor.poses.push_back({0.5, 1.5, 0});
    sensor.held_out.push_back(0);
    sensor.range_m.push_back(range);
  }
  return sensor;
}

TEST(BeamReader, MeetsTheCellsOfARayAtTheMiddleOfItsWayThroughThem) {
  const Occupancy map = ReadOccupancy(DrawnMap({"....", "..# ", "...."}));
  const BeamReader reader(map);
  const ScoredReading reading = reader.Read(Sensor(0, {kNoReading}), 0, 0);
  ASSERT_EQ(reading.cells.size(), 4U);
  EXPECT_NEAR(reading.cells[0].distance_m, 0.25, 1e-12);
  EXPECT_NEAR(reading.cells[2].distance_m, 2, 1e-12);
  EXPECT_EQ(reading.cells[2].q, 0.9);
  EXPECT_NEAR(reading.cells[3].q, (10 * 0.1 + 0.9) / 11, 1e-12);  // unknown: the mean
  EXPECT_FALSE(reading.echo);
  EXPECT_EQ(reading.z_m, 6);
}

// Against every cell of the map asked one by one.
TEST(BeamReader, MeetsTheCellsOfAConeInOrderOfDistance) {
  Rng rng(1);
  std::vector<std::string> rows(40, std::string(40, '.'));
  const Occupancy map = ReadOccupancy(DrawnMap(rows, 0.1));
  const BeamReader reader(map);
  for (int k = 0; k < 30; ++k) {
    ScoredSensor sensor = Sensor(0.4, {kNoReading});
    sensor.max_range_m = 1.7;
    sensor.poses[0] = {rng.Uniform(-0.5, 4.5), rng.Uniform(-0.5, 4.5), rng.Uniform(-4, 4)};
    const ScoredReading reading = reader.Read(sensor, 0, 0);
    std::size_t inside = 0;
    for (int row = 0; row < 40; ++row) {
      for (int column = 0; column < 40; ++column) {
        const double dx = 0.1 * column + 0.05 - sensor.poses[0].x_m,
                     dy = 0.1 * row + 0.05 - sensor.poses[0].y_m;
        const double off = WrapAngle(std::atan2(dy, dx) - sensor.poses[0].heading_rad);
        if (std::abs(off) < 0.2 && std::hypot(dx, dy) < 1.7) ++inside;
      }
    }
    EXPECT_GE(reading.cells.size(), inside);
    EXPECT_LE(reading.cells.size(), inside + 12);  // those on the axis near the tip
    for (std::size_t i = 1; i < reading.cells.size(); ++i)
      EXPECT_LE(reading.cells[i - 1].distance_m, reading.cells[i].distance_m);
  }
}

// Readings drawn by the model itself.
TEST(FitReadingModel, FindsTheParametersOfReadingsThatTheModelDrew) {
  const ReadingModel truth{0.6, 0.08, 0.04};
  Rng rng(3);
  std::vector<ScoredReading> readings;
  for (int i = 0; i < 4000; ++i) {
    ScoredReading reading{6, false, 6, {}};
    for (double d = 0.5; d < 5.5; d += 0.5) reading.cells.push_back({d, rng.Uniform() < 0.3 ? 1.0 : 0.0});
    for (const MetCell& cell : reading.cells) {
      if (reading.echo || rng.Uniform() >= cell.q * truth.p_hit) continue;
      reading.echo = true;
      reading.z_m = cell.distance_m + truth.sigma_m * rng.Normal();
    }
    if (rng.Uniform() < truth.p_rand) {
      reading.echo = true;
      reading.z_m = rng.Uniform(0, 6);
    }
    readings.push_back(std::move(reading));
  }
  const ReadingModel fitted = FitReadingModel(readings);
  EXPECT_NEAR(fitted.p_hit, truth.p_hit, 0.03);
  EXPECT_NEAR(fitted.p_rand, truth.p_rand, 0.015);
  EXPECT_NEAR(fitted.sigma_m, truth.sigma_m, 0.003);
}

// The fit does not look at what is held out, and the score at nothing else.
TEST(ScoreHeldOut, FitsOnTheMapsReadingsAndScoresTheOthers) {
  const Occupancy map = ReadOccupancy(DrawnMap({"....", "...#", "...."}));
  ScoredSensor sensor = Sensor(0, {2.9, 3.0, 3.1, 2.95, 1.0});
  EXPECT_FALSE(ScoreHeldOut(map, {sensor}).has_value());
  sensor.held_out.back() = 1;
  const auto score = ScoreHeldOut(map, {sensor});
  ASSERT_TRUE(score.has_value());
  EXPECT_EQ(score->readings, 1);
  const BeamReader reader(map);
  const ReadingModel model = score->sensors[0].model;
  EXPECT_NEAR(score->log_likelihood_per_reading, LogDensity(reader.Read(sensor, 4, 0), model), 1e-12);
  sensor.range_m.back() = 3.0;
  const auto better = ScoreHeldOut(map, {sensor});
  EXPECT_EQ(better->sensors[0].model.sigma_m, model.sigma_m);
  EXPECT_GT(better->log_likelihood_per_reading, score->log_likelihood_per_reading);
}

}  // namespace
}  // namespace cairn::datasets
