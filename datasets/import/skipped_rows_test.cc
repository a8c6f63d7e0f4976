#include "datasets/import/skipped_rows.h"

#include "datasets/import/csv.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

constexpr char kSeenHeader[] = "time_s,landmark,range_m,bearing_rad\n";

class SkippedRowsTest : public ImportTest {
 protected:
  CsvImportOptions options_;

  void SetUp() override {
    options_.odometry = folder_.Put("o.csv", "time_s,turn_rad,forward_m\n1,0,1\n2,0,1\n3,0,1\n");
    options_.skip_bad = true;
  }
  std::string Failure() {
    return InputErrorOf([this] { ImportCsv(options_, &log_); });
  }
};

TEST_F(SkippedRowsTest, AFileOfWhichAllRowsAreSkippedIsRefused) {
  options_.observations = folder_.Put("s.csv", std::string(kSeenHeader) + "3600,door,2,0\n3601,door,2,0\n");
  ExpectContains(Failure(),
                 "s.csv: --skip-bad leaves nothing of its 2 rows; skipped: after the last control (2). ");
}

TEST_F(SkippedRowsTest, AFileOfWhichMoreThanHalfIsSkippedIsRefused) {
  const std::string half = std::string(kSeenHeader) + "1,door,2,0\nx,door,2,0\n";
  options_.observations = folder_.Put("s.csv", half);
  EXPECT_EQ(ImportCsv(options_, &log_).observations, 1);
  options_.observations = folder_.Put("s.csv", half + "9,door,2,0\n");
  ExpectContains(Failure(),
                 "s.csv: --skip-bad leaves 1 of its 3 rows, less than half; skipped: after the last "
                 "control (1), not a number (1). Without --skip-bad the first such row is named");
  options_.observations = folder_.Put("s.csv", half);
  options_.truth_poses = folder_.Put("p.csv", "time_s,x_m,y_m,heading_rad\n1,0,0,0\n2,0,0\n3,0,0\n");
  ExpectContains(Failure(),
                 "p.csv: --skip-bad leaves 1 of its 3 rows, less than half; skipped: wrong number of "
                 "columns (2). ");
  options_.odometry = folder_.Put("o.csv", "time_s,turn_rad,forward_m\n1,0,1\nx,0,1\nx,0,1\n");
  ExpectContains(Failure(), "o.csv: --skip-bad leaves 1 of its 3 rows");
}

}  // namespace
}  // namespace cairn::datasets
