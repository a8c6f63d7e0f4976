// Logs in which some observations name their landmark and some do not: those may be of a landmark that others
// name.
#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"
#include "pipelines/testing/in_process.h"
#include "schema/rng.h"

namespace cairn::landmark_map {
namespace {

constexpr const char* kNameOf = "robot/0/observations/landmark";

BlobPtr PartlyNamedMap(const Blob& log) {
  return RunInProcess(LandmarkMap(Options{}), {{"log", std::make_shared<const Blob>(log)}});
}

// Without the names of so many of a hundred observations, and of all of `nameless`.
Blob WithoutNames(Blob log, int of_hundred, std::int32_t nameless = -1) {
  Rng rng(5);
  std::vector<std::int32_t> named;
  for (const std::int32_t k : log.Get<std::int32_t>(kNameOf))
    named.push_back(k == nameless || 100.0 * rng.Uniform() < of_hundred ? -1 : k);
  log.PutVector(kNameOf, named);
  return log;
}

std::multiset<std::int32_t> NamesIn(const Blob& result) {
  const auto identity = result.Get<std::int32_t>("map/landmark_identity");
  return {identity.begin(), identity.end()};
}

TEST(PartlyNamed, ALandmarkThatIsNamedNowAndThenIsThereOnce) {
  const Blob log = PostsLog{.drift_rad_per_m = 0.002, .named = true}.Make();
  for (const int of_hundred : {50, 95}) {
    const BlobPtr result = PartlyNamedMap(WithoutNames(log, of_hundred));
    EXPECT_EQ(NamesIn(*result), (std::multiset<std::int32_t>{0, 1, 2, 3, 4, 5})) << of_hundred;
    const auto named = log.Get<std::int32_t>(kNameOf);
    const auto found = result->Get<std::int32_t>("robot/0/observations/map_landmark");
    std::size_t right = 0;
    for (std::size_t i = 0; i < named.size(); ++i) right += named[i] == found[i] ? 1 : 0;
    EXPECT_GT(right, named.size() * 98 / 100) << of_hundred;
  }
}

TEST(PartlyNamed, ALandmarkThatNobodyNamesStays) {
  const Blob log = PostsLog{.drift_rad_per_m = 0.002, .named = true}.Make();
  EXPECT_EQ(NamesIn(*PartlyNamedMap(WithoutNames(log, 50, 5))),
            (std::multiset<std::int32_t>{-1, 0, 1, 2, 3, 4}));
}

TEST(PartlyNamed, AButtonThatIsNamedNowAndThenIsThereOnce) {
  const Blob log = SquareLog{.laps = 6, .side_m = 20.0, .identified = true}.Make();
  EXPECT_EQ(NamesIn(*PartlyNamedMap(WithoutNames(log, 50))), (std::multiset<std::int32_t>{0, 1, 2, 3}));
}

// One of the robots reads names, the first or the other.
TEST(PartlyNamed, ARobotWithoutNamesIsPlacedByWhereLandmarksStand) {
  const Blob named = PostsLog{.drift_rad_per_m = 0.002, .named = true}.Make();
  const Blob nameless =
      WithoutNames(PostsLog{.drift_rad_per_m = 0.002, .seed = 2, .named = true}.Make(), 100);
  for (const bool first : {true, false}) {
    Blob log = first ? named : nameless;
    log.Put("robots", Array::Texts({"one", "two"}));
    log.PutAll("robot/1/", (first ? nameless : named).Sub("robot/0/"));
    const BlobPtr result = PartlyNamedMap(log);
    EXPECT_EQ(NamesIn(*result), (std::multiset<std::int32_t>{0, 1, 2, 3, 4, 5})) << first;
    EXPECT_EQ(result->Scalar<std::int64_t>("robot/1/shared_landmarks"), 6) << first;
    EXPECT_GT(result->Scalar<double>("robot/1/place_lead_nats"), 10.0) << first;
  }
}

// It makes a landmark of its own, which goes, for nothing confirms it.
TEST(PartlyNamed, AContactWithoutANameIsOfNoLandmarkThatOthersName) {
  Blob log = PostsLog{.drift_rad_per_m = 0.002, .named = true}.Make();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string seen = "robot/0/observations/";
  const auto append = [&](const std::string& name, auto value) {
    const auto before = log.Get<decltype(value)>(seen + name);
    std::vector column(before.begin(), before.end());
    column.push_back(value);
    log.PutVector(seen + name, column);
  };
  append("time_s", log.Get<double>(seen + "time_s").back());
  append("range_m", nan);
  append("bearing_rad", nan);
  append("landmark", std::int32_t{-1});
  const BlobPtr result = PartlyNamedMap(log);
  EXPECT_EQ(NamesIn(*result), (std::multiset<std::int32_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(result->Get<std::int32_t>(seen + "map_landmark").back(), -1);
}

// A robot that gives two names of the map is placed by these alone.
TEST(PartlyNamed, NamesAloneAreThoseOfTheMap) {
  Perception map;
  for (const double value : {1.0, 2.0, 3.0}) {
    Layer& layer = map.likelihood.layers.emplace_back();
    layer.box = {0, 0, 1, 1};
    layer.values = {value};
  }
  const Perception names = NamesAlone(map, 2);
  ASSERT_EQ(names.likelihood.layers.size(), 3U);
  EXPECT_EQ(names.likelihood.layers[1].values, map.likelihood.layers[1].values);
  EXPECT_TRUE(names.likelihood.layers[2].box.empty()) << "what has no name says nothing";
}

}  // namespace
}  // namespace cairn::landmark_map
