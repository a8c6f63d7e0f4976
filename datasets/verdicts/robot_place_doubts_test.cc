#include "datasets/verdicts/robot_place_doubts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "datasets/verdicts/landmark_map_verdict.h"
#include "datasets/verdicts/testing_landmark_map.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {
namespace {

// As many robots as leads; below 0: another place, or none, is likelier.
Verdict WithLeads(const std::vector<double>& lead_nats, std::int64_t shared = 3,
                  std::int64_t one_sided = 11) {
  Blob map = FittedMap(200, 0, 0, 0);
  std::vector<std::string> robots;
  for (std::size_t r = 0; r < lead_nats.size(); ++r) {
    const std::string prefix = "robot/" + std::to_string(r) + "/";
    robots.push_back("rob" + std::to_string(r));
    map.PutVector<std::int32_t>(prefix + "observations/map_landmark", {0, 0});
    if (std::isnan(lead_nats[r])) continue;
    map.PutScalar<std::int64_t>(prefix + "shared_landmarks", shared);
    map.PutScalar<std::int64_t>(prefix + "one_sided_landmarks", one_sided);
    map.PutScalar<double>(prefix + "place_lead_nats", lead_nats[r]);
  }
  map.Put("robots", Array::Texts(robots));
  return LandmarkMapVerdict(map);
}

TEST(RobotPlaceDoubts, ARobotWhosePlaceIsUncertainIsNamed) {
  const Verdict loose = WithLeads({-25.6, -25.6});
  EXPECT_EQ(loose.trust, Confidence::kLow);
  EXPECT_NE(loose.why.find("; where rob1 is in the map of the others is uncertain: 3 landmarks in common, 11 "
                           "that one side alone has seen though the other looked there, 25.6 nats behind the "
                           "next place or none; two landmarks that both name would tell; the path of each "
                           "robot alone may be right"),
            std::string::npos)
      << loose.why;
  const Verdict placed_second = WithLeads({-5.2, std::nan("")});
  EXPECT_EQ(placed_second.trust, Confidence::kLow) << "the second one was the frame's";
  EXPECT_NE(placed_second.why.find("where rob0 is in the map"), std::string::npos) << placed_second.why;
  EXPECT_NE(WithLeads({5.0, 40.0, 9.9}).why.find("where rob0, rob2 is in"), std::string::npos);
  EXPECT_NE(WithLeads({5.0, 40.0, 9.9}).why.find("5.0 nats ahead of the next place"), std::string::npos);
  for (const Verdict& tied : {WithLeads({10.0, 10.0}, 14, 0), WithLeads({std::nan(""), std::nan("")})}) {
    EXPECT_GE(tied.trust, Confidence::kFair);
    EXPECT_EQ(tied.why.find("uncertain"), std::string::npos) << tied.why;
  }
}

// By how many nats they are where they are sooner than chance puts them there.
TEST(RobotPlaceDoubts, ARobotThatChanceMayHavePutThereIsNamed) {
  const auto with_odds = [](double odds_nats) {
    Blob map = FittedMap(200, 0, 0, 0);
    map.Put("robots", Array::Texts({"rob0", "rob1"}));
    for (const char* prefix : {"robot/0/", "robot/1/"}) {
      map.PutVector<std::int32_t>(std::string(prefix) + "observations/map_landmark", {0, 0});
      map.PutScalar<std::int64_t>(std::string(prefix) + "shared_landmarks", 4);
      map.PutScalar<std::int64_t>(std::string(prefix) + "one_sided_landmarks", 2);
      map.PutScalar<double>(std::string(prefix) + "place_lead_nats", 12);
      map.PutScalar<double>(std::string(prefix) + "place_odds_nats", odds_nats);
    }
    return LandmarkMapVerdict(map);
  };
  const Verdict chance = with_odds(-0.7);
  EXPECT_EQ(chance.trust, Confidence::kLow);
  EXPECT_NE(chance.why.find("where rob1 is in the map of the others may well be chance"), std::string::npos)
      << chance.why;
  EXPECT_EQ(with_odds(3).trust, Confidence::kFair);
  EXPECT_NE(with_odds(3).why.find("may be chance"), std::string::npos) << with_odds(3).why;
  EXPECT_EQ(with_odds(7).why.find("chance"), std::string::npos) << with_odds(7).why;
}

// The figures of two robots one of which saw all bearings a fifth too small, and of healthy ones.
TEST(RobotPlaceDoubts, LandmarksThatOneRobotAloneSawThoughTheOtherLookedThereAreADoubt) {
  const Verdict wrong = WithLeads({43.1, 43.1}, 13, 5);
  EXPECT_EQ(wrong.trust, Confidence::kLow);
  EXPECT_NE(wrong.why.find("rob1 and the others have 13 landmarks in common, and 5 that one side alone"),
            std::string::npos)
      << wrong.why;
  EXPECT_EQ(WithLeads({43.1, std::nan("")}, 13, 5).trust, Confidence::kLow);
  EXPECT_EQ(WithLeads({43.1, 43.1}, 20, 3).trust, Confidence::kFair);
  const Verdict twins =
      WithLeads({43.1, 43.1}, 7, 2);  // two halls alike but for one landmark, of a robot each
  EXPECT_EQ(twins.trust, Confidence::kFair);
  EXPECT_NE(twins.why.find("one side alone"), std::string::npos) << twins.why;
  for (const std::int64_t few : {0, 1, 2}) {
    const Verdict healthy = WithLeads({43.1, 43.1}, 14, few);
    EXPECT_GE(healthy.trust, Confidence::kFair);
    EXPECT_EQ(healthy.why.find("one side alone"), std::string::npos) << healthy.why;
  }
}

}  // namespace
}  // namespace cairn::datasets
