#include "pipelines/landmark_map/refinement/contradictions.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

MapRules RulesOfContradictions() {
  MapRules rules;
  rules.types = 1;
  rules.observation_m = 0.3;
  return rules;
}

LayeredGrid CountsAt(double here, double there) {
  LayeredGrid counts;
  counts.layers.resize(2);
  counts.layers[0] = Layer(Box{0, 0, 21, 3});
  counts.layers[0].Row(1)[2] = here;
  counts.layers[0].Row(1)[18] = there;
  return counts;
}

std::string ReasonOf(const Blob& log, const Options& options = {}) {
  try {
    RunInProcess(LandmarkMap(options), {{"log", std::make_shared<const Blob>(log)}});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void ExpectContains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(CheckOnePositionPerLandmark, NamesTheLandmarkAndBothPlaces) {
  try {
    CheckOnePositionPerLandmark(CountsAt(10.0, 6.0), RulesOfContradictions(), {"tower"});
    FAIL();
  } catch (const InputError& error) {
    ExpectContains(error.what(), "'tower' stands in two places: 10 of its 16");
    ExpectContains(error.what(), "(2.00, 1.00)");
    ExpectContains(error.what(), "6 around (18.00, 1.00)");
    for (const char* cause : {"do bearings grow counter-clockwise", "are ranges in metres", "use one clock",
                              "were identities mixed up?"})
      ExpectContains(error.what(), cause);
  }
}

TEST(CheckOnePositionPerLandmark, AFewMisreadNamesAreNone) {
  EXPECT_NO_THROW(CheckOnePositionPerLandmark(CountsAt(100.0, 12.0), RulesOfContradictions(), {"tower"}));
  EXPECT_NO_THROW(CheckOnePositionPerLandmark(CountsAt(5.0, 3.0), RulesOfContradictions(), {"tower"}));
}

TEST(LandmarkMap, ARobotThatNeverMeetsTheOthersLandmarksIsRefused) {
  Blob log = SquareLog{.laps = 4, .side_m = 20.0, .ranged = true, .identified = true}.Make();
  Blob other = SquareLog{.laps = 4, .side_m = 20.0, .ranged = true, .identified = true, .seed = 2}.Make();
  const auto named = other.Get<std::int32_t>("robot/0/observations/landmark");
  std::vector<std::int32_t> renamed;
  for (const std::int32_t k : named) renamed.push_back(k + 4);
  other.PutVector("robot/0/observations/landmark", renamed);
  log.Put("landmarks", Array::Texts({"a", "b", "c", "d", "e", "f", "g", "h"}));
  log.Put("robots", Array::Texts({"one", "two"}));
  log.PutAll("robot/1/", other.Sub("robot/0/"));
  ExpectContains(ReasonOf(log), "robot 'two' has seen nothing that the first robot saw too");
}

}  // namespace
}  // namespace cairn::landmark_map
