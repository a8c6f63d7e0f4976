#include "pipelines/landmark_map/refinement/moved_landmarks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::landmark_map {
namespace {

Blob MapOf(const Blob& log) {
  return *RunInProcess(LandmarkMap(Options{}), {{"log", std::make_shared<const Blob>(log)}});
}

std::string RefusalOf(const Blob& log) {
  try {
    MapOf(log);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// A robot at rest that presses a button whenever it observes; `kinds` of landmarks.
AssociatedPath PathOver(const std::vector<std::pair<int, Point>>& seen) {
  AssociatedPath path;
  path.steps.first_observation = {0};
  for (const auto& [type, place] : seen) {
    path.steps.time_s.push_back(static_cast<double>(path.steps.time_s.size()));
    path.steps.observations.push_back({.type = type});
    path.steps.first_observation.push_back(static_cast<std::int32_t>(path.steps.observations.size()));
    path.x_m.push_back(place.x_m);
    path.y_m.push_back(place.y_m);
    path.correction_rad.push_back(0);
  }
  return path;
}

// Four landmarks in turn, of which the last stands `later` in the second half.
std::vector<std::pair<int, Point>> FourOf(const Point& later) {
  std::vector<std::pair<int, Point>> seen;
  for (int round = 0; round < 12; ++round) {
    for (int type = 0; type < 3; ++type) seen.push_back({type, {10.0 * type, 0}});
    seen.push_back({3, round < 7 ? Point{0, 20} : later});
  }
  return seen;
}

std::vector<Landmark> LandmarksOf() {
  std::vector<Landmark> landmarks(4);
  for (int type = 0; type < 4; ++type) landmarks[static_cast<std::size_t>(type)].type = type;
  for (int type = 0; type < 3; ++type) landmarks[static_cast<std::size_t>(type)].x_m = 10.0 * type;
  landmarks[3].y_m = 20;
  return landmarks;
}

MapRules RulesOfFour() {
  MapRules rules;
  rules.types = 4;
  rules.observation_m = 0.3;
  return rules;
}

TEST(FindMoved, SaysWhenAndWhatIsLeftOut) {
  const InTwoPlaces found{3, 20, "two places", {0, 20}, {20, 20}};
  const auto moved = FindMoved({found}, {PathOver(FourOf({20, 20}))}, LandmarksOf(), RulesOfFour());
  ASSERT_EQ(moved.size(), 1U);
  EXPECT_EQ(moved[0].type, 3);
  EXPECT_EQ(moved[0].until_s, 27);
  EXPECT_EQ(moved[0].from_s, 31);
  EXPECT_FALSE(moved[0].LeavesOut(27));
  EXPECT_TRUE(moved[0].LeavesOut(31));
  const InTwoPlaces turned{3, 20, "two places", {20, 20}, {0, 20}};
  const auto later = FindMoved({turned}, {PathOver(FourOf({20, 20}))}, LandmarksOf(), RulesOfFour());
  EXPECT_TRUE(later.at(0).LeavesOut(27));
  EXPECT_FALSE(later.at(0).LeavesOut(31));
}

TEST(FindMoved, NotWhereTheTwoPlacesTakeTurns) {
  std::vector<std::pair<int, Point>> seen = FourOf({20, 20});
  for (std::size_t i = 3; i < seen.size(); i += 8) std::swap(seen[i].second, seen[seen.size() - 1].second);
  for (std::size_t i = 3; i < seen.size(); i += 8) seen[i].second = {20, 20};
  EXPECT_THROW(
      FindMoved({{3, 20, "two places", {0, 20}, {20, 20}}}, {PathOver(seen)}, LandmarksOf(), RulesOfFour()),
      InputError);
}

TEST(FindMoved, NotToWhereAnotherLandmarkStands) {
  EXPECT_THROW(FindMoved({{3, 28, "two places", {0, 20}, {20, 0}}}, {PathOver(FourOf({20, 0}))},
                         LandmarksOf(), RulesOfFour()),
               InputError);
}

TEST(FindMoved, NotWhereTooFewOthersStayed) {
  std::vector<std::pair<int, Point>> seen = FourOf({20, 20});
  std::erase_if(seen, [](const auto& one) { return one.first == 1; });
  EXPECT_THROW(
      FindMoved({{3, 20, "two places", {0, 20}, {20, 20}}}, {PathOver(seen)}, LandmarksOf(), RulesOfFour()),
      InputError);
}

// Two of seven; not of six.
TEST(FindMoved, TwoWhereMoreThanTwiceAsManyOthersStay) {
  for (const int staying : {5, 4}) {
    std::vector<std::pair<int, Point>> seen;
    for (int round = 0; round < 12; ++round) {
      const double moved_m = round < 7 ? 0 : 20;
      for (int type = 0; type < staying; ++type) seen.push_back({type, {10.0 * type, 0}});
      seen.push_back({5, {moved_m, 20}});
      seen.push_back({6, {moved_m, 30}});
    }
    const std::vector<InTwoPlaces> found{{5, 20, "two places", {0, 20}, {20, 20}},
                                         {6, 20, "two places", {0, 30}, {20, 30}}};
    MapRules rules = RulesOfFour();
    rules.types = 7;
    std::vector<Landmark> landmarks(5);
    for (int type = 0; type < 5; ++type) {
      landmarks[static_cast<std::size_t>(type)].type = type;
      landmarks[static_cast<std::size_t>(type)].x_m = 10.0 * type;
    }
    if (staying == 5)
      EXPECT_EQ(FindMoved(found, {PathOver(seen)}, landmarks, rules).size(), 2U);
    else
      EXPECT_THROW(FindMoved(found, {PathOver(seen)}, landmarks, rules), InputError);
  }
}

TEST(LandmarkMap, ALandmarkThatWasMovedIsNamedAndTheMapIsMade) {
  const PostsLog stayed{.named = true, .times = 8};
  const Blob log = PostsLog{.named = true, .times = 8, .moved = true}.Make();
  const Blob map = MapOf(log), expected = MapOf(stayed.Make());
  EXPECT_FALSE(expected.Has("moved/landmark"));
  const auto moved = Read<kinds::LandmarkMap>(map).moved;
  ASSERT_EQ(moved.landmark.OrNone().size(), 1U);
  EXPECT_EQ(moved.landmark[0], 2);
  EXPECT_LE(moved.until_s[0], 400.2);  // when the robot is half-way
  EXPECT_GE(moved.from_s[0], 400.2);
  const auto x = map.Get<double>("map/landmark_x_m"), y = map.Get<double>("map/landmark_y_m");
  const auto was_x = expected.Get<double>("map/landmark_x_m"),
             was_y = expected.Get<double>("map/landmark_y_m");
  ASSERT_EQ(x.size(), 6U);
  for (const std::size_t a : {0U, 1U, 3U, 4U, 5U})
    for (const std::size_t b : {0U, 1U, 3U, 4U, 5U})
      EXPECT_NEAR(std::hypot(x[a] - x[b], y[a] - y[b]), std::hypot(was_x[a] - was_x[b], was_y[a] - was_y[b]),
                  0.1);
}

// From the seventh round on its tag lies half-way between two corners.
TEST(LandmarkMap, ATagThatWasMovedIsNamedToo) {
  Blob log = SquareLog{.laps = 12, .identified = true}.Make();
  const auto landmark = log.Get<std::int32_t>("robot/0/observations/landmark");
  const auto seen = log.Get<double>("robot/0/observations/time_s");
  std::vector<double> seen_s(seen.begin(), seen.end());
  for (std::size_t i = 24; i < seen_s.size(); ++i)
    if (landmark[i] == 3) seen_s[i] -= 5;
  log.PutVector("robot/0/observations/time_s", seen_s);
  const Blob map = MapOf(log);
  const auto moved = Read<kinds::LandmarkMap>(map).moved;
  ASSERT_EQ(moved.landmark.OrNone().size(), 1U);
  EXPECT_EQ(moved.landmark[0], 3);
  EXPECT_EQ(moved.until_s[0], 230);
  EXPECT_EQ(moved.from_s[0], 265);
  EXPECT_EQ(moved.left_out[0], 6);
  EXPECT_TRUE(map.Texts("refinement/reason")[0].starts_with("not tried: a landmark stands in two places"));
}

TEST(LandmarkMap, NamesThatAreExchangedHalfWayAreRefused) {
  const std::string reason = RefusalOf(PostsLog{.named = true, .times = 8, .swapped = true}.Make());
  EXPECT_NE(reason.find("stands in two places"), std::string::npos) << reason;
  EXPECT_NE(reason.find("give it another name from then on"), std::string::npos) << reason;
}

}  // namespace
}  // namespace cairn::landmark_map
