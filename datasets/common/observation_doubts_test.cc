#include "datasets/common/observation_doubts.h"

#include <cmath>

#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

const double kNoValue = std::nan("");

Blob LogThatSaw(const std::vector<std::string>& landmarks, const std::vector<double>& range_m,
                const std::vector<double>& bearing_rad) {
  Blob log;
  log.Put("robots", Array::Texts({"1", "2"}));
  log.Put("landmarks", Array::Texts(landmarks));
  const std::string seen = "robot/1/observations/";
  std::vector<double> times;
  for (std::size_t i = 0; i < range_m.size(); ++i) times.push_back(static_cast<double>(i));
  log.PutVector(seen + "time_s", times);
  log.PutVector(seen + "landmark", std::vector<std::int32_t>(times.size(), -1));
  log.PutVector(seen + "range_m", range_m);
  log.PutVector(seen + "bearing_rad", bearing_rad);
  return log;
}

TEST(ObservationDoubts, RobotsAreNoLandmarks) {
  EXPECT_TRUE(ObservationDoubtsOf(LogThatSaw({"6", "7", "11"}, {1}, {0})).empty());
  const auto doubts = ObservationDoubtsOf(LogThatSaw({"2", "6"}, {1}, {0}));
  ASSERT_EQ(doubts.size(), 1U);
  ExpectContains(doubts[0], "robots and landmarks have names in common: '2'. Were the robots");
}

TEST(ObservationDoubts, ARangeOrABearingAloneIsNone) {
  EXPECT_TRUE(ObservationDoubtsOf(LogThatSaw({}, {1, kNoValue}, {0, kNoValue})).empty()) << "and a contact";
  const auto one = ObservationDoubtsOf(LogThatSaw({}, {1, 2}, {0, kNoValue}));
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0],
            "1 observation has a range without a bearing, or a bearing without a range (of robot '2'): "
            "landmark_map needs both, or neither where the robot stands at the landmark");
  const auto bearings = ObservationDoubtsOf(LogThatSaw({}, {kNoValue, kNoValue}, {0, 1}));
  ASSERT_EQ(bearings.size(), 1U);
  ExpectContains(bearings[0], "2 observations have a range");
  const Blob missing = LogThatSaw({}, {1, 2, 3}, {0, 0, 0}).Without("robot/1/observations/bearing_rad");
  ASSERT_EQ(ObservationDoubtsOf(missing).size(), 1U);
  ExpectContains(ObservationDoubtsOf(missing)[0], "3 observations have a range");
}

TEST(ObservationDoubts, BearingsThatAreAllTheSameSayNothing) {
  std::vector<double> range_m;
  for (int i = 0; i < 20; ++i) range_m.push_back(1 + 0.1 * i);
  const auto doubts = ObservationDoubtsOf(LogThatSaw({}, range_m, std::vector<double>(20, 0.0)));
  ASSERT_EQ(doubts.size(), 1U);
  ExpectContains(doubts[0], "robot '2': all bearings of its observations of landmarks are 0 rad");
  EXPECT_TRUE(ObservationDoubtsOf(LogThatSaw({}, range_m, range_m)).empty());
}

}  // namespace
}  // namespace cairn::datasets
