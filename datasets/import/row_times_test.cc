#include "datasets/import/row_times.h"

#include "datasets/import/csv.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

class TimeOrderTest : public ImportTest {
 protected:
  CsvImportOptions options_;

  std::string FailureOf(const std::string& odometry, bool skip_bad) {
    options_.odometry = folder_.Put("o.csv", odometry);
    options_.skip_bad = skip_bad;
    return InputErrorOf([this] { ImportCsv(options_, &log_); });
  }
};

TEST_F(TimeOrderTest, RowsThatAreNotSortedAreToBeSorted) {
  for (const std::string columns : {"x_m,y_m,heading_rad", "v_mps,omega_radps"}) {
    std::string rows = "time_s," + columns + "\n";
    for (int i = 0; i < 20; ++i)
      rows += std::to_string(7 * i % 20) + (columns.starts_with("x") ? ",0,0,0\n" : ",0,0\n");
    ExpectContains(
        FailureOf(rows, false),
        "o.csv:5: time runs backwards: 1.000000 after 14.000000, as in 12 of 20 rows: sort the rows by "
        "time; rows of several robots need a column 'robot' (--skip-bad");
    ExpectContains(FailureOf(rows, true),
                   "o.csv: --skip-bad leaves 8 of its 20 rows, less than half; skipped: "
                   "time runs backwards (12); sort the rows by time. ");
  }
}

// Robots one after the other, and one row of a wrong time: in order but for that row.
TEST_F(TimeOrderTest, FewRowsOutOfOrderAreNotToBeSorted) {
  std::string rows = "time_s,robot,turn_rad,forward_m\n";
  for (int i = 0; i < 60; ++i)
    rows += std::to_string(i == 30 ? 5 : i % 20) + ",r" + std::to_string(i / 20) + ",0,0\n";
  ExpectContains(FailureOf(rows, false),
                 "o.csv:32: time runs backwards: 5.000000 after 9.000000 (--skip-bad");
  EXPECT_EQ(FailureOf(rows, true), "");
}

TEST_F(TimeOrderTest, EachRobotHasAnOrderOfItsOwn) {
  std::string rows = "time_s,robot,turn_rad,forward_m\n";
  for (int i = 0; i < 40; ++i) rows += std::to_string(i) + ",a,0,0\n" + std::to_string(40 - i) + ",b,0,0\n";
  ExpectContains(
      FailureOf(rows, false),
      "o.csv:5: time runs backwards: 39.000000 after 40.000000, as in 39 of 80 rows: sort the rows");
}

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
