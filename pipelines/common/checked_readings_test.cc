#include "pipelines/common/checked_readings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pipelines/common/testing_room.h"

namespace cairn {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr GridBox kRoomBox{-1, -1, 0.1, 80, 70};

RangeScans ScansOfRoom(const Room& room, double heldout = 0) {
  GridOptions options;
  options.heldout = heldout;
  return ReadRangeScans(room.Log(), nullptr, options).sensors.at(0);
}

// Of the room with its box, moved by `off_m`: walls `q`, else nothing.
std::vector<double> RoomMap(double off_m, double q) {
  std::vector<double> probability(static_cast<std::size_t>(kRoomBox.cells()), 0.0);
  const auto wall = [&](double x0, double y0, double x1, double y1) {
    for (double t = 0; t <= 1; t += 1e-3) {
      const auto column = kRoomBox.ColumnOf(x0 + t * (x1 - x0) + off_m),
                 row = kRoomBox.RowOf(y0 + t * (y1 - y0));
      if (kRoomBox.Holds(column, row)) probability[kRoomBox.Index(column, row)] = q;
    }
  };
  for (const auto& [x0, y0, x1, y1] : {std::array{0.0, 0.0, 6.0, 5.0}, std::array{2.0, 2.0, 3.0, 3.0}}) {
    wall(x0, y0, x1, y0);
    wall(x0, y1, x1, y1);
    wall(x0, y0, x0, y1);
    wall(x1, y0, x1, y1);
  }
  return probability;
}

ReadingModel RoomModel() { return {.sigma_m = 0.06, .no_echo_m = 0.06, .z_max_m = 4}; }

TEST(CheckedReadings, DensityByHand) {
  const ReadingModel model{0.5, 0.1, 0.2, 0.1, 0.1, 10, true};
  const double peak = 1 / (0.1 * std::sqrt(2 * 3.14159265358979));
  EXPECT_NEAR(DensityOf(4, {}, model, false), 0.01, 1e-12);
  EXPECT_NEAR(DensityOf(4, {}, model, true), 0.01 + 0.7 / 10, 1e-12);
  EXPECT_NEAR(DensityOf(10, {}, model, false), 0.01 + 0.2 * peak + 0.7 * peak, 1e-9);
  const std::vector<MetCell> cells = {{2, 0.4}, {4, 1}};
  EXPECT_NEAR(DensityOf(2, cells, model, false), 0.01 + 0.7 * 0.2 * peak, 1e-9);
  EXPECT_NEAR(DensityOf(4, cells, model, false), 0.01 + 0.7 * 0.8 * 0.5 * peak, 1e-9);
  EXPECT_NEAR(DensityOf(10, cells, model, false), 0.01 + 0.2 * peak + 0.7 * 0.8 * 0.5 * peak, 1e-9);
}

TEST(CheckedReadings, AMapThatKnowsNothingIsTheIgnorantOne) {
  const std::vector<double> nothing(static_cast<std::size_t>(kRoomBox.cells()), kUnknown);
  for (const double opening_rad : {0.0, 0.26}) {
    const auto checked =
        Check(ScansOfRoom({.scans = 200, .opening_rad = opening_rad}), kRoomBox, nothing, RoomModel());
    EXPECT_EQ(checked.readings, 20 * 24);
    EXPECT_NEAR(checked.log_likelihood, checked.ignorant, 0.1 * 480);
  }
}

TEST(CheckedReadings, TheTrueMapForetellsThemAndAMovedOneDoesNot) {
  for (const double opening_rad : {0.0, 0.26}) {
    const RangeScans scans = ScansOfRoom({.scans = 200, .opening_rad = opening_rad});
    const auto gain = [&](double off_m) {
      const CheckedReadings checked = Check(scans, kRoomBox, RoomMap(off_m, 0.99), RoomModel());
      return (checked.log_likelihood - checked.ignorant) / static_cast<double>(checked.readings);
    };
    EXPECT_GT(gain(0), 1) << opening_rad;
    EXPECT_LT(gain(0.7), gain(0) - 1) << opening_rad;
  }
}

TEST(CheckedReadings, AreTheLastTenthOfEachTenthUnlessSomeAreHeldOut) {
  const RangeScans scans = ScansOfRoom({.scans = 300});
  EXPECT_EQ(std::ranges::count(scans.held_out, 1), 0);
  for (std::size_t s = 0; s < 300; ++s) EXPECT_EQ(scans.checked[s], s % 30 >= 27 ? 1 : 0) << s;
  const RangeScans only = CheckedOnly(scans);
  const RangeScans others = WithoutChecked(scans);
  for (std::size_t s = 0; s < 300; ++s) {
    EXPECT_EQ(only.held_out[s], 1 - scans.checked[s]) << s;
    EXPECT_EQ(others.held_out[s], scans.checked[s]) << s;
  }
  const RangeScans held = ScansOfRoom({.scans = 300}, 0.2);
  EXPECT_EQ(held.checked, held.held_out);
  EXPECT_EQ(std::ranges::count(CheckedOnly(held).held_out, 0), 0) << "the map is made without them";
}

TEST(CheckedReadings, AreFiveHundredAtMostOfASensor) {
  const std::vector<double> nothing(static_cast<std::size_t>(kRoomBox.cells()), kUnknown);
  EXPECT_EQ(Check(ScansOfRoom({.scans = 1000}), kRoomBox, nothing, RoomModel()).readings, 500);
}

TEST(CheckedReadings, WithoutEchoCountOnlyWhereTheyTellOfSomething) {
  RangeScans scans = ScansOfRoom({.scans = 200});
  std::int64_t echoes = 0;
  for (std::size_t at = 0; at < scans.range_m.As<double>().size(); ++at)
    echoes += scans.checked[at / 24] != 0 && !std::isnan(scans.range_m.As<double>()[at]);
  ReadingModel model = RoomModel();
  model.no_echo = false;
  EXPECT_EQ(Check(scans, kRoomBox, RoomMap(0, 1), model).readings, echoes);
  EXPECT_LT(echoes, 20 * 24);
}

TEST(CheckedReadings, LeaveNothingWhereThereAreNone) {
  Blob result;
  PutCheck(Check(ScansOfRoom({.scans = 1}), kRoomBox, RoomMap(0, 1), RoomModel()), &result);
  EXPECT_TRUE(result.fields().empty());
  PutCheck({4, -6, -10}, &result);
  EXPECT_EQ(result.Scalar<std::int64_t>("fit/checked_readings"), 4);
  EXPECT_EQ(result.Scalar<double>("fit/checked_nats"), -1.5);
  EXPECT_EQ(result.Scalar<double>("fit/ignorant_nats"), -2.5);
}

}  // namespace
}  // namespace cairn
