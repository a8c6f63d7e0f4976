#include "datasets/import/time_digits.h"

#include "datasets/import/csv.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

// Of rows a tenth of a second apart, of which each `rows` have the time of the first.
std::string DoubtOf(int rows) {
  TimeDigits digits;
  for (int i = 0; i < 4000; ++i) {
    const int first = i / rows * rows;
    digits.Add(1.7e9 + 0.1 * first);
  }
  return digits.Doubt();
}

TEST(TimeDigits, AreTooFewWhereHundredsOfRowsHaveOneTime) {
  EXPECT_EQ(DoubtOf(4000), "4000 rows have 1 time: were they written with too few digits?");
  EXPECT_EQ(DoubtOf(1000), "4000 rows have 4 times: were they written with too few digits?");
  EXPECT_EQ(DoubtOf(1), "");
  EXPECT_EQ(DoubtOf(10), "") << "whole seconds";
  EXPECT_EQ(TimeDigits().Doubt(), "");
}

TEST(TimeDigits, AreAskedForBeforeObservationsAre) {
  const TestFolder folder;
  for (const std::string columns : {"x_m,y_m,heading_rad", "v_mps,omega_radps", "turn_rad,forward_m"}) {
    std::string rows = "time_s,robot," + columns + "\n";
    for (int i = 0; i < 50; ++i) {
      rows += "1.7e+09,anna,0,0" + std::string(columns.starts_with("x") ? ",0\n" : "\n");
      rows += std::to_string(1700000000 + i) + ",bert,0,0" + (columns.starts_with("x") ? ",0\n" : "\n");
    }
    CsvImportOptions options;
    options.odometry = folder.Put("o.csv", rows);
    options.observations =
        folder.Put("s.csv", "time_s,robot,landmark,range_m,bearing_rad\n1700000001,anna,door,2,0\n");
    Blob log;
    ExpectContains(InputErrorOf([&] { ImportCsv(options, &log); }),
                   "o.csv: robot 'anna': 50 rows have 1 time: were they written with too few digits?");
  }
}

}  // namespace
}  // namespace cairn::datasets
