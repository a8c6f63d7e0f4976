// Imports of bags that tests make.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "datasets/bag/import_bag.h"
#include "datasets/bag/testing_bag.h"
#include "datasets/testing.h"

namespace cairn::datasets {

using To = bag::Encoder::To;

class ImportBagTest : public ImportTest {
 protected:
  BagImportOptions options_;

  ImportReport Import(const std::string& bytes, const std::string& name = "drive.bag") {
    options_.files = {folder_.Put(name, bytes)};
    return ImportBag(options_, &log_);
  }
  ImportReport Import(const std::vector<bag::BagMessage>& messages) {
    return Import(bag::Ros1Bytes(messages));
  }
  std::string Refusal(const std::string& bytes) {
    return InputErrorOf([&] { Import(bytes); });
  }
  std::string Refusal(const std::vector<bag::BagMessage>& messages) {
    return Refusal(bag::Ros1Bytes(messages));
  }
  void ExpectSmallDrive(const std::string& what) {
    SCOPED_TRACE(what);
    const auto time_s = Column<double>("robot/0/laser/time_s");
    ASSERT_EQ(time_s.size(), 11U);
    EXPECT_EQ(time_s[3], 1001.5);
    const auto range_m = Column<double>("robot/0/laser/range_m");
    ASSERT_EQ(range_m.size(), 55U);
    EXPECT_EQ(range_m[1], 2.5);
    EXPECT_TRUE(std::isnan(range_m[3])) << "beyond the reach";
    EXPECT_TRUE(std::isnan(range_m[4])) << "below the least range";
    EXPECT_EQ(log_.Scalar<double>("robot/0/laser/max_range_m"), 20);
    EXPECT_EQ(Column<double>("robot/0/laser/beam_heading_rad"), (std::vector<double>{-1, -0.5, 0, 0.5, 1}));
    double way_m = 0, turn_rad = 0;
    for (const double step : Column<double>("robot/0/odometry/forward_m")) way_m += step;
    for (const double turn : Column<double>("robot/0/odometry/turn_rad")) turn_rad += turn;
    EXPECT_NEAR(way_m, 1, 0.01);
    EXPECT_NEAR(turn_rad, 0.1, 1e-9);
    log_ = {};
  }
};

}  // namespace cairn::datasets
