#include "datasets/import/near_repeats.h"

#include <cmath>
#include <cstdio>
#include <string>

#include "datasets/import/csv.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

class NearRepeatsTest : public ImportTest {
 protected:
  // What the import says of odometry whose rows nearly repeat others; empty: nothing.
  std::string Said(const std::string& rows) {
    CsvImportOptions options;
    options.odometry = folder_.Put("odometry.csv", "time_s,turn_rad,forward_m\n" + rows);
    for (const std::string& warning : ImportCsv(options, &log_).warnings)
      if (warning.find("with other digits") != std::string::npos) return warning;
    return "";
  }
};

std::string StepRow(const char* format, double time_s, double turn_rad, double forward_m) {
  char row[100];
  std::snprintf(row, sizeof row, format, time_s, turn_rad, forward_m);
  return row;
}

constexpr char kFine[] = "%.6f,%.6f,%.6f\n", kCoarse[] = "%.3f,%.4f,%.3f\n";

// A hundred steps, of which those from `from` to `end` stand there once more, with fewer digits.
std::string StepsOfTwoPrograms(int from, int end, double change) {
  std::string rows;
  for (int i = 0; i < 100; ++i) {
    const double time_s = 0.1234564 * i, turn_rad = 0.05 * std::sin(change * i),
                 forward_m = 0.2 + 0.1 * std::cos(change * i);
    const std::string fine = StepRow(kFine, time_s, turn_rad, forward_m),
                      coarse = StepRow(kCoarse, time_s, turn_rad, forward_m);
    const bool coarse_first = std::stod(coarse) < std::stod(fine);
    const bool twice = i >= from && i < end;
    rows += twice && coarse_first ? coarse + fine : twice ? fine + coarse : fine;
  }
  return rows;
}

TEST_F(NearRepeatsTest, StepsOfFilesThatOverlapWrittenWithOtherDigitsAreSaid) {
  ExpectContains(
      Said(StepsOfTwoPrograms(40, 60, 0.3)),
      "odometry.csv: robot 'robot': at least 17 of 120 rows say the same as the row beside them, with other "
      "digits (the first: lines 48 and 49)");
  ExpectContains(Said(StepsOfTwoPrograms(0, 100, 0.3)), "at least 84 of 199 rows");
  EXPECT_EQ(Said(StepsOfTwoPrograms(0, 0, 0.3)), "");
  EXPECT_EQ(Said(StepsOfTwoPrograms(50, 54, 0.3)), "") << "a few may be chance";
}

// Of a robot that goes evenly each step is nearly the next one; and a coarse clock gives several one time.
TEST_F(NearRepeatsTest, EvenMotionAndCoarseClocksAreNone) {
  std::string even, coarse;
  for (int i = 0; i < 400; ++i) {
    const double jitter = 0.0001 * (i * 7 % 5), change = 0.01 * (i * 37 % 23);
    even += StepRow("%.1f,%.4f,%.4f\n", 0.1 * i, 0.0001 * (i * 3 % 4), 0.1 + jitter);
    coarse += StepRow("%.0f,%.4f,%.4f\n", std::floor(0.1 * i), 0.01 * (i % 3), 0.1 + change);
  }
  EXPECT_EQ(Said(even), "");
  EXPECT_EQ(Said(coarse), "");
}

}  // namespace
}  // namespace cairn::datasets
