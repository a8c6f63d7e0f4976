// What the tests of `cairn import csv` share: a log of two robots.
#pragma once

#include <string>

#include "datasets/import/csv.h"
#include "datasets/testing.h"

namespace cairn::datasets {

inline constexpr char kOdometry[] =
    "time_s,robot,turn_rad,forward_m\n1,Rosa,0,1\n1.5,Ugo,0.5,1\n2,Rosa,0.25,2\n3,Rosa,-0.25,0\n2.5,Ugo,0,"
    "1\n";
inline constexpr char kHeader[] = "time_s,robot,landmark,range_m,bearing_rad\n";

class ImportCsvTest : public ImportTest {
 protected:
  CsvImportOptions options_;

  void SetUp() override { options_.odometry = folder_.Put("odometry.csv", kOdometry); }
  void PutObservations(const std::string& rows) {
    options_.observations = folder_.Put("observations.csv", kHeader + rows);
  }
  ImportReport Import() { return ImportCsv(options_, &log_); }
  std::string Failure() {
    return InputErrorOf([this] { Import(); });
  }
};

}  // namespace cairn::datasets
