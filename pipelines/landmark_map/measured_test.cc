// That the simulated logs themselves are like themselves tests/worlds shows.
#include "pipelines/landmark_map/measured.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pipelines/landmark_map/testing.h"
#include "schema/kinds/log.h"

namespace cairn::landmark_map {
namespace {

bool Says(const std::vector<std::string>& unlike, const std::string& what) {
  return std::ranges::any_of(unlike, [&](const std::string& s) { return s.find(what) != std::string::npos; });
}

TEST(MeasureLog, AreTheLogsOwn) {
  Blob log = SquareLog{.laps = 2, .side_m = 15.0}.Make();
  log.PutScalar("noise/contact_m", 0.3);
  log.PutScalar("noise/heading_drift_rad_per_m", 0.0017453292519943296);
  const LogStatistics statistics = MeasureLog(log);
  EXPECT_EQ(statistics.observations, 8);
  EXPECT_NEAR(statistics.travelled_m, 120.0, 2.0);
  EXPECT_NEAR(statistics.between_m, 15.0, 0.5);
  EXPECT_LT(statistics.between_spread, 0.1) << "a square's corners lie at even distances";
  EXPECT_EQ(statistics.contact_m, 0.3);
  EXPECT_EQ(statistics.heading_drift_rad_per_m, 0.0017453292519943296);
  EXPECT_EQ(statistics.turn_ratio, 0.0);
}

// What is not stated is called as the log calls it: so the imports call the option that states it, too.
TEST(LogStatistics, HaveTheLogsNames) {
  std::vector<std::string> of_noise;
  kinds::Log::Noise::Fields([&](const Field& field, auto) { of_noise.emplace_back(field.name); });
  const LogStatistics statistics;
  std::size_t k = 0, stated = 0;
  VisitLogStatistics(statistics, [&](const std::string& name, double) {
    if (k++ < kMeasuredFigures) return;
    ++stated;
    EXPECT_NE(std::ranges::find(of_noise, name), of_noise.end()) << name;
  });
  EXPECT_GT(stated, 0U);
}

TEST(UnlikeMeasured, NamesEachDifference) {
  const Blob log = SquareLog{.laps = 2, .side_m = 15.0}.Make();
  const auto unlike = UnlikeMeasured({}, log, 4);
  EXPECT_TRUE(Says(unlike, "observations is 8, not "));
  EXPECT_TRUE(Says(unlike, "it does not state contact_m"));
  EXPECT_TRUE(Says(unlike, "between_spread is "))
      << "landmarks at even distances: each may be taken for the next";
  EXPECT_TRUE(Says(unlike, "the number of landmarks in the search's map is 4, not "));
  EXPECT_FALSE(Says(unlike, "option"));
  EXPECT_FALSE(Says(unlike, "robots"));
  EXPECT_TRUE(Says(UnlikeMeasured({}, SquareLog{.identified = true}.Make(), 4), "have identities"));
  EXPECT_TRUE(Says(UnlikeMeasured({}, SquareLog{.ranged = true}.Make(), 4), "seen at a distance"));
  Blob many = log;
  many.Put("robots", Array::Texts({"a", "b", "c", "d"}));
  EXPECT_FALSE(Says(UnlikeMeasured({}, many, 4), "robots"));
  many.Put("robots", Array::Texts({"a", "b", "c", "d", "e"}));
  EXPECT_TRUE(Says(UnlikeMeasured({}, many, 4), "it has 5 robots"));
}

TEST(UnlikeMeasured, LogsWhoseObservationsAreFalseOrMissed) {
  Blob log = SquareLog{.laps = 2, .side_m = 15.0}.Make();
  log.PutScalar("noise/false_ratio", 0.0);
  EXPECT_FALSE(Says(UnlikeMeasured({}, log, 4), "it states"));
  log.PutScalar("noise/false_ratio", 0.02);
  EXPECT_TRUE(Says(UnlikeMeasured({}, log, 4), "it states noise/false_ratio"));
  log.PutScalar("noise/miss_ratio", 0.1);
  EXPECT_TRUE(Says(UnlikeMeasured({}, log, 4), "it states noise/miss_ratio"));
}

TEST(UnlikeMeasured, OptionsThatChangeTheResultCount) {
  const Blob log = SquareLog{.laps = 2, .side_m = 15.0}.Make();
  EXPECT_TRUE(Says(UnlikeMeasured({.revise = false}, log, 4), "the option revise is not the default"));
  EXPECT_TRUE(Says(UnlikeMeasured({.cell_m = 0.5}, log, 4), "the option cell_m is not the default"));
  EXPECT_TRUE(Says(UnlikeMeasured({.motion_error = "triangular"}, log, 4), "the option motion_error"));
  EXPECT_FALSE(
      Says(UnlikeMeasured({.memory_mb = 100, .slice_mcells = 1, .speculate = false}, log, 4), "the option"));
}

}  // namespace
}  // namespace cairn::landmark_map
