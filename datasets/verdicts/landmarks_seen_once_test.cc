#include "datasets/verdicts/landmarks_seen_once.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/verdicts/landmark_map_verdict.h"

namespace cairn::datasets {
namespace {

// Of as many landmarks as `observed` says how often; `passes` as often, where the map has it.
kinds::LandmarkMap MapOf(const std::vector<int>& observed, const std::vector<std::int64_t>& passes = {}) {
  kinds::LandmarkMap map;
  map.robots = std::vector<std::string>{"robot"};
  map.robot.resize(1);
  std::vector<std::int32_t> rows;
  for (std::size_t k = 0; k < observed.size(); ++k)
    rows.insert(rows.end(), static_cast<std::size_t>(observed[k]), static_cast<std::int32_t>(k));
  map.robot[0].map_landmark = rows;
  map.map.landmark_x_m = std::vector<double>(observed.size(), 0.0);
  map.map.landmark_identity = std::vector<std::int32_t>(observed.size(), -1);
  if (!passes.empty()) map.map.landmark_passes = passes;
  return map;
}

// As a search leaves it of a log that is like those on which rates were measured.
std::string SearchedText(kinds::LandmarkMap map) {
  map.search.support = 7;
  map.search.starts = 12;
  map.search.lead_nats = 57.0;
  Blob blob = BlobOf(map);
  blob.Put("search/unlike", Array::Texts({}));
  return LandmarkMapVerdict(blob).Text();
}

std::string NamedText(kinds::LandmarkMap map) {
  const auto rows = static_cast<std::int64_t>(map.robot[0].map_landmark.size());
  for (std::size_t k = 0; k < map.map.landmark_x_m.size(); ++k)
    map.landmarks = std::vector<std::string>(k + 1, "name");
  std::vector<std::int32_t> names;
  for (std::size_t k = 0; k < map.map.landmark_x_m.size(); ++k) names.push_back(static_cast<std::int32_t>(k));
  map.map.landmark_identity = names;
  map.fit.observations = rows;
  map.fit.misfits = 0;
  map.fit.longest_run = 0;
  return LandmarkMapVerdict(BlobOf(map)).Text();
}

TEST(SeenOnce, CountsThoseOfOneObservationAndThoseThatWerePassedAgain) {
  const SeenOnce seen = CountSeenOnce(MapOf({3, 1, 1, 2, 1}, {3, 1, 2, 4, 5}));
  EXPECT_EQ(seen.landmarks, 5U);
  EXPECT_EQ(seen.once, 3U);
  EXPECT_EQ(seen.passed_again, 2U);
  EXPECT_EQ(CountSeenOnce(MapOf({3, 1})).passed_again, 0U) << "an older file does not say";
}

TEST(SeenOnce, AMapThatHangsOnALandmarkThatWasPassedAgainIsNeitherHighNorIsItsRateKnown) {
  EXPECT_EQ(SearchedText(MapOf({4, 4, 4, 4, 1}, {4, 4, 4, 4, 1})),
            "high: right in 99 of 100 such simulations, which have no false observations; found from 7 of 12 "
            "starts, 57.0 nats ahead of the next different map; 1 of 5 landmarks was observed once: nothing "
            "confirms it");
  EXPECT_EQ(
      SearchedText(MapOf({4, 4, 4, 4, 1}, {4, 4, 5, 4, 2})),
      "fair: found from 7 of 12 starts, 57.0 nats ahead of the next different map; 1 of 5 landmarks was "
      "observed once: nothing confirms it, and it was passed again and not observed: is it false, or missed? "
      "(`cairn import csv --false-ratio` states what share is false, 0 that none is)");
  const std::string many = SearchedText(MapOf({4, 4, 4, 1, 1, 1}, {4, 4, 4, 3, 1, 4}));
  EXPECT_TRUE(many.starts_with("low: ")) << many;
  EXPECT_NE(many.find("3 of 6 landmarks were observed once: nothing confirms them, and 2 of them were passed "
                      "again and not observed: are they false, or missed?"),
            std::string::npos)
      << many;
}

TEST(SeenOnce, WhatIsSeenOnceAtADistanceTestsNothing) {
  const std::vector<int> seen(11, 9);
  EXPECT_EQ(NamedText(MapOf(seen)), "high: 99 observations fit the map");
  std::vector<int> one = seen, two = seen;
  one.back() = 1;
  two[0] = two.back() = 1;
  EXPECT_EQ(NamedText(MapOf(one)),
            "high: 90 observations fit the map; 1 of 11 landmarks was observed once: nothing confirms it");
  EXPECT_EQ(NamedText(MapOf(two)),
            "fair: 81 observations fit the map; 2 of 11 landmarks were observed once: nothing confirms them");
  EXPECT_TRUE(NamedText(MapOf({49, 1})).starts_with("fair: 49 observations")) << "too few to tell";
  EXPECT_EQ(
      NamedText(MapOf({1})),
      "not known: no landmark was observed twice, so nothing tests the map; 1 of 1 landmark was observed "
      "once: nothing confirms it");
}

}  // namespace
}  // namespace cairn::datasets
