#include "datasets/import/recorded/ranges.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

constexpr double kPiOfRanges = std::numbers::pi;

std::string ManyRanges(int count, const std::string& value) {
  std::string text;
  for (int i = 0; i < count; ++i) text += " " + value;
  return text;
}

class ImportRangesTest : public ImportTest {
 protected:
  RangeImportOptions options_;
  void PutPioneer(const std::string& sonar) {
    options_.path = folder_ / "";
    folder_.Put("od.txt", "1000 0 0 0\n1200 500 0 2700\n1400 500 -500 2700\n");
    folder_.Put("sonar.txt.gz", sonar);
    folder_.Put("laser.txt", "1000" + ManyRanges(361, "2000") + "\n1200" + ManyRanges(361, "81910") +
                                 "\n1400" + ManyRanges(361, "3000") + "\n");
  }
  template <class Import>
  std::string Refusal(Import import, const std::string& text) {
    options_.path = folder_.Put("log.txt", text);
    return InputErrorOf([&] { import(options_, &log_); });
  }
};

TEST_F(ImportRangesTest, PioneersRowsBelongTogetherByTheirNumbers) {
  PutPioneer("1000" + ManyRanges(8, "1000") + "\n1200" + ManyRanges(8, "5110") + "\n1400" +
             ManyRanges(8, "500") + "\n");
  EXPECT_EQ(ImportPioneer(options_, &log_).scans, 6);
  EXPECT_EQ(Column<double>("robot/0/sonar/time_s"), (std::vector<double>{1, 1.2, 1.4}));
  const auto sonar = Column<double>("robot/0/sonar/range_m");
  EXPECT_EQ(sonar[0], 1);
  EXPECT_TRUE(std::isnan(sonar[8])) << "5110 is no echo";
  EXPECT_TRUE(std::isnan(Column<double>("robot/0/laser/range_m")[361])) << "81910 is no return";
  EXPECT_EQ(Column<double>("robot/0/sonar/beam_y_m")[0], -0.19) << "from right to left";
  EXPECT_NEAR(Column<double>("robot/0/laser/beam_heading_rad")[1], -kPiOfRanges / 2 + kPiOfRanges / 360,
              1e-12);
  double turned = 0;
  for (const double turn : Column<double>("robot/0/odometry/turn_rad")) turned += turn;
  EXPECT_NEAR(turned, -kPiOfRanges / 2, 1e-9) << "270 degrees are 90 to the right";
}

TEST_F(ImportRangesTest, PioneersBadRowsAreNamedOrLeftOutOfAllFiles) {
  PutPioneer("1000" + ManyRanges(8, "1000") + "\n1200" + ManyRanges(7, "5110") + "\n1400" +
             ManyRanges(8, "500") + "\n");
  ExpectContains(InputErrorOf([&] { ImportPioneer(options_, &log_); }), "sonar.txt.gz:2: line cut short");
  options_.skip_bad = true;
  const ImportReport report = ImportPioneer(options_, &log_);
  EXPECT_EQ(report.scans, 4);
  EXPECT_EQ(report.dropped.at("row that is bad in one of the files"), 1);
  PutPioneer("1000" + ManyRanges(8, "1000") + "\n1200" + ManyRanges(8, "5110") + "\n");
  ExpectContains(InputErrorOf([&] { ImportPioneer(options_, &log_); }), "differ in length");
  options_.skip_bad = false;
  PutPioneer("1000" + ManyRanges(8, "1000") + "\n1201" + ManyRanges(8, "5110") + "\n1400" +
             ManyRanges(8, "500") + "\n");
  ExpectContains(InputErrorOf([&] { ImportPioneer(options_, &log_); }), "od.txt:2: another time than in");
}

TEST_F(ImportRangesTest, DpSlamScansAreNumbered) {
  options_.path =
      folder_.Put("loop.log.gz", "Odometry 1 0 0 \nLaser 3 1 8.191 2\nOdometry 2 0 0\nLaser 3 1 2 3\n");
  EXPECT_EQ(ImportDpSlam(options_, &log_).scans, 2);
  EXPECT_EQ(Column<double>("robot/0/laser/time_s"), (std::vector<double>{0, 1}));
  EXPECT_NEAR(Column<double>("robot/0/odometry/forward_m")[1], 1, 1e-12);
  EXPECT_TRUE(std::isnan(Column<double>("robot/0/laser/range_m")[1]));
  EXPECT_NEAR(Column<double>("robot/0/laser/beam_heading_rad")[1], 0, 1e-12);
  ExpectContains(Refusal(ImportDpSlam, "Laser 3 1 1 1\n"), "log.txt:1: scan without odometry before it");
  ExpectContains(Refusal(ImportDpSlam, "Odometry 0 0 0\nLaser 3 1 1\n"), "log.txt:2: line cut short");
  ExpectContains(Refusal(ImportDpSlam, "Odometry 0 0\n"), "log.txt:1: line cut short");
  ExpectContains(Refusal(ImportDpSlam, "Sonar 0 0\n"), "log.txt:1: unknown message");
  ExpectContains(Refusal(ImportDpSlam, "Odometry 0 0 0\n"), "neither odometry nor a pose");
}

TEST_F(ImportRangesTest, WeanIsInCentimetresAndItsLaserSitsAhead) {
  options_.path =
      folder_.Put("wean.log", "O 0 0 0 0.1\nL 100 0 0 125 0 0" + ManyRanges(179, "200") + " 8183 0.2\n");
  EXPECT_EQ(ImportWean(options_, &log_).scans, 1);
  EXPECT_NEAR(Column<double>("robot/0/odometry/forward_m")[1], 1, 1e-12);
  EXPECT_EQ(Column<double>("robot/0/laser/beam_x_m")[0], 0.25);
  EXPECT_EQ(Column<double>("robot/0/laser/range_m")[0], 2);
  EXPECT_TRUE(std::isnan(Column<double>("robot/0/laser/range_m")[179]));
  ExpectContains(Refusal(ImportWean, "O 0 0 0 1\nO 0 0 1\n"), "log.txt:2: line cut short");
  ExpectContains(Refusal(ImportWean, "O 0 0 0 1\nX 0 0 1\n"), "log.txt:2: unknown message");
  ExpectContains(Refusal(ImportWean, "L 1 0 0 1 0 0" + ManyRanges(180, "-2") + " 1\n"),
                 "log.txt:1: negative range");
}

// The recordings themselves hold what their READMEs counted.
TEST(ImportRangesData, HoldsWhatIsKnownOfIt) {
  if (DataFolder().empty()) GTEST_SKIP() << "CAIRN_DATA is not set (docs/datasets.md)";
  const struct {
    ImportReport (*import)(const RangeImportOptions&, Blob*);
    const char* path;
    std::int64_t scans;
    double travelled_m, silent_sonar;
  } logs[] = {{ImportPioneer, "pioneer-sonar-laser/run1", 2 * 413, 25.0, 0.323},
              {ImportPioneer, "pioneer-sonar-laser/run2", 2 * 214, 9.1, 0.334},
              {ImportPioneer, "pioneer-sonar-laser/run4", 2 * 505, 28.9, 0.107},
              {ImportDpSlam, "dpslam-loop5/loop5.log.gz", 551, 56.1, 0},
              {ImportWean, "wean-hall/robotdata1.log.gz", 713, 89.2, 0},
              {ImportWean, "wean-hall/robotdata2.log.gz", 2251, 161.5, 0},
              {ImportWean, "wean-hall/robotdata3.log.gz", 1241, 78.4, 0}};
  for (const auto& expected : logs) {
    SCOPED_TRACE(expected.path);
    Blob log;
    RangeImportOptions options;
    options.path = DataFolder() + "/" + expected.path;
    EXPECT_EQ(expected.import(options, &log).scans, expected.scans);
    double travelled_m = 0;
    for (const double forward : log.Get<double>("robot/0/odometry/forward_m"))
      travelled_m += std::abs(forward);
    EXPECT_NEAR(travelled_m, expected.travelled_m, 0.01 * expected.travelled_m);
    if (expected.silent_sonar == 0) continue;
    const auto sonar = log.Get<double>("robot/0/sonar/range_m");
    const auto silent = std::ranges::count_if(sonar, [](double r) { return std::isnan(r); });
    EXPECT_NEAR(static_cast<double>(silent) / static_cast<double>(sonar.size()), expected.silent_sonar,
                0.002);
  }
}

}  // namespace
}  // namespace cairn::datasets
