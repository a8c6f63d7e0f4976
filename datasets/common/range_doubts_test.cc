#include "datasets/common/range_doubts.h"

#include <algorithm>
#include <cmath>

#include "datasets/common/unit_doubts.h"
#include "datasets/import/recorded/carmen.h"
#include "datasets/inspect/inspect.h"
#include "datasets/testing.h"
#include "schema/rng.h"
#include "schema/store/blob_file.h"

namespace cairn::datasets {
namespace {

constexpr std::size_t kFanBeams = 60;

// 100 scans of 60 beams from 0.5 to 8 m, in steps of `step_m`; `share` of them nothing, which is `nothing_m`.
std::vector<double> RandomReadings(double share, double nothing_m, double step_m) {
  Rng rng(3);
  std::vector<double> range_m(100 * kFanBeams);
  for (double& range : range_m) {
    range = 0.5 + 7.5 * rng.Uniform();
    if (step_m > 0) range = step_m * std::round(range / step_m);
    if (rng.Uniform() < share) range = nothing_m;
  }
  return range_m;
}

TEST(RangeDoubts, AReadingThatFillsUpTheTopOfALogIsFound) {
  const auto found = FindConstantReading(RandomReadings(0.2, 8.191, 0.001), kFanBeams);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->range_m, 8.191);
  EXPECT_NEAR(found->share, 0.2, 0.02);
  EXPECT_FALSE(FindConstantReading(RandomReadings(0.02, 8.191, 0.001), kFanBeams)) << "as few as walls have";
  EXPECT_FALSE(FindConstantReading(RandomReadings(0.2, 4, 0.001), kFanBeams)) << "others are larger";
  EXPECT_FALSE(FindConstantReading(RandomReadings(0, 0, 0.01), kFanBeams));
  EXPECT_FALSE(FindConstantReading(RandomReadings(0, 0, 0.5), kFanBeams)) << "coarse steps";
  EXPECT_FALSE(FindConstantReading(std::vector<double>(100 * kFanBeams, 2), kFanBeams)) << "all there is";
  std::vector<double> nothing = RandomReadings(0.2, std::nan(""), 0);
  EXPECT_FALSE(FindConstantReading(nothing, kFanBeams));
}

TEST(RangeDoubts, OneBeamsReadingIsAWall) {
  std::vector<double> standing = RandomReadings(0, 0, 0.01);
  for (std::size_t i = 0; i < standing.size(); ++i)
    if (i % kFanBeams < 5) standing[i] = 9;
  EXPECT_FALSE(FindConstantReading(standing, kFanBeams));
}

// A fifth of its laser's readings, of a reach of 10 m, say `nothing_m`.
Blob LogThatWrites(double nothing_m) {
  Blob log;
  log.Put("robots", Array::Texts({"anna"}));
  std::vector<double> time_s;
  for (int i = 0; i < 100; ++i) time_s.push_back(0.1 * i);
  log.PutVector("robot/0/odometry/time_s", time_s);
  log.PutVector("robot/0/odometry/turn_rad", std::vector<double>(100, 0.0));
  log.PutVector("robot/0/odometry/forward_m", std::vector<double>(100, 0.0));
  log.PutVector("robot/0/laser/time_s", time_s);
  log.Put("robot/0/laser/range_m", Array::Of<double>({100, kFanBeams}, RandomReadings(0.2, nothing_m, 0)));
  for (const char* column : {"beam_x_m", "beam_y_m", "beam_heading_rad"})
    log.PutVector(std::string("robot/0/laser/") + column, std::vector<double>(kFanBeams, 0.0));
  log.PutScalar<double>("robot/0/laser/opening_rad", 0);
  log.PutScalar<double>("robot/0/laser/max_range_m", 10);
  return log;
}

std::string InspectedText(const Blob& log) {
  const TestFolder folder;
  EXPECT_TRUE(WriteBlobFile(folder / "a.h5", "log", log).ok());
  return InspectText(Inspect(folder / "a.h5").value());
}

TEST(RangeDoubts, ZerosAreNoReadings) {
  const std::vector<std::string> doubts = FindUnitDoubts(LogThatWrites(0));
  ASSERT_EQ(doubts.size(), 1U);
  ExpectContains(doubts[0], "robot 'anna', its laser: 1");
  ExpectContains(doubts[0], " of its 6000 readings are 0 m (");
  ExpectContains(doubts[0], "write NaN where nothing came back");
  EXPECT_TRUE(FindUnitDoubts(LogThatWrites(std::nan(""))).empty());
  Blob few = LogThatWrites(std::nan(""));
  const auto range_m = few.Get<double>("robot/0/laser/range_m");
  std::vector<double> readings(range_m.begin(), range_m.end());
  for (std::size_t k = 0; k < 7; ++k) {
    readings[k] = 0;
    few.Put("robot/0/laser/range_m", Array::Of<double>({100, kFanBeams}, readings));
    EXPECT_EQ(FindUnitDoubts(few).empty(), k < 6) << k + 1 << " of 6000";
  }
  ExpectContains(InspectedText(LogThatWrites(0)), "write NaN where nothing came back");
}

TEST(RangeDoubts, AConstantBelowTheStatedReachIsWarnedOf) {
  ASSERT_EQ(ConstantReadingsOf(LogThatWrites(9.5)).size(), 1U);
  ExpectContains(ConstantReadingsOf(LogThatWrites(9.5))[0],
                 "exactly 9.5 m, below its reach, which is stated as 10 m");
  ExpectContains(InspectedText(LogThatWrites(9.5)),
                 "is that what its driver writes where nothing came back?");
  EXPECT_TRUE(ConstantReadingsOf(LogThatWrites(std::nan(""))).empty());
  EXPECT_TRUE(ConstantReadingsOf(LogThatWrites(10)).empty()) << "known to be nothing";
}

class ConstantReadingsOfCarmen : public ImportTest {
 protected:
  // FLASER without a word of its reach.
  ImportReport Import(std::optional<double> reach_m) {
    std::string text;
    const std::vector<double> range_m = RandomReadings(0.2, 8.191, 0.001);
    for (std::size_t scan = 0; scan < range_m.size() / kFanBeams; ++scan) {
      text += "FLASER " + std::to_string(kFanBeams);
      for (std::size_t b = 0; b < kFanBeams; ++b) text += " " + std::to_string(range_m[scan * kFanBeams + b]);
      const std::string x = std::to_string(0.1 * static_cast<double>(scan)), time = std::to_string(scan + 1);
      text += " " + x + " 0 0 " + x + " 0 0 " + time + " host " + time + "\n";
    }
    CarmenImportOptions options;
    options.path = folder_.Put("log.log", text);
    options.max_range_m = reach_m;
    return ImportCarmen(options, &log_);
  }
  std::ptrdiff_t Answers() const {
    return std::ranges::count_if(log_.Get<double>("robot/0/laser/range_m"),
                                 [](double range) { return !std::isnan(range); });
  }
};

TEST_F(ConstantReadingsOfCarmen, AreItsReachWhereNobodyStatesOne) {
  const ImportReport report = Import(std::nullopt);
  EXPECT_EQ(log_.Scalar<double>("robot/0/laser/max_range_m"), 8.191);
  EXPECT_NEAR(static_cast<double>(Answers()), 0.8 * 100 * kFanBeams, 0.02 * 100 * kFanBeams);
  const auto says = [](const ImportReport& of, const char* part) {
    return std::ranges::any_of(of.warnings, [&](const auto& w) { return w.find(part) != w.npos; });
  };
  EXPECT_TRUE(says(report, "of its readings are exactly 8.191 m")) << report.warnings.front();
  const ImportReport stated = Import(20);
  EXPECT_EQ(log_.Scalar<double>("robot/0/laser/max_range_m"), 20);
  EXPECT_EQ(Answers(), 100 * kFanBeams);
  EXPECT_TRUE(says(stated, "below its reach, which is stated as 20 m"));
}

}  // namespace
}  // namespace cairn::datasets
