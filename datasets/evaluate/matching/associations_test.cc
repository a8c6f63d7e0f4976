#include "datasets/evaluate/matching/associations.h"

#include <gtest/gtest.h>

#include <limits>

namespace cairn::datasets {
namespace {

using Flags = std::vector<std::vector<bool>>;

Flags All(const Associations& map, bool value) {
  Flags flags;
  for (const auto& of_robot : map) flags.emplace_back(of_robot.size(), value);
  return flags;
}

bool Correct(const Associations& contacts, const Associations& truth, std::size_t landmarks) {
  return ScoreTopology(contacts, All(contacts, true), All(contacts, true), truth, landmarks).correct;
}

TEST(ScoreTopology, LooksAtTheClassesNotTheirNumbers) {
  const Associations truth = {{4, 7, 4, -1}, {7, 9}};
  EXPECT_TRUE(Correct({{1, 0, 1, -1}, {0, 2}}, truth, 3));
  EXPECT_FALSE(Correct({{1, 0, 1, -1}, {0, 2}}, truth, 4)) << "a landmark is extra";
  EXPECT_FALSE(Correct({{1, 0, 1, -1}, {0, 0}}, truth, 2)) << "two joined";
  EXPECT_FALSE(Correct({{1, 0, 3, -1}, {0, 2}}, truth, 4)) << "one split";
  EXPECT_FALSE(Correct({{1, 0, -1, -1}, {0, 2}}, truth, 3)) << "a contact detection left out";
  EXPECT_FALSE(Correct({{1, 0, 1, 2}, {0, 2}}, truth, 3)) << "a false one taken in";
  EXPECT_FALSE(Correct({{1, 0, 1, -1}, {0, -1}}, truth, 2)) << "a landmark is missed";
  EXPECT_FALSE(Correct({{-1, -1, -1, -1}, {-1, -1}}, truth, 0)) << "an empty map";
  EXPECT_TRUE(Correct({{}, {}}, {{}, {}}, 0));
}

TEST(ScoreTopology, WhatWasNotLookedAtIsUnusedAndNotWrong) {
  const Associations truth = {{4, 4, 4, -1, 7, 7, 7}}, map = {{0, -1, -1, -1, -1, 1, -1}};
  const Flags looked_at = {{true, false, false, false, false, true, false}};
  for (const bool contact : {true, false}) {
    const TopologyScore score = ScoreTopology(map, looked_at, All(map, contact), truth, 2);
    EXPECT_TRUE(score.correct);
    EXPECT_EQ(score.observations, 6);
    EXPECT_EQ(score.unused, 4);
    EXPECT_EQ(score.associations, 2);
    EXPECT_EQ(score.wrong, 0);
    EXPECT_FALSE(ScoreTopology(map, looked_at, All(map, contact), {{4, 4, 4, 9, 7, 7, 7}}, 2).correct)
        << "of landmark 9 nothing was looked at: the map misses it";
  }
}

// Twenty range-bearing observations each of two landmarks.
TEST(ScoreTopology, OneObservationInTwentyMayBeOfTheNeighbour) {
  Associations truth(1), map(1);
  for (int i = 0; i < 40; ++i) {
    truth[0].push_back(i % 2);
    map[0].push_back(i % 2);
  }
  const auto score = [&](bool contact) {
    return ScoreTopology(map, All(map, true), All(map, contact), truth, 2);
  };
  map[0][0] = map[0][2] = 1;
  EXPECT_TRUE(score(false).correct);
  EXPECT_FALSE(score(true).correct) << "a contact detection is a visit";
  EXPECT_EQ(score(false).wrong, 2);
  map[0][4] = 1;
  EXPECT_FALSE(score(false).correct);
  EXPECT_EQ(score(false).wrong, 3);
}

TEST(ScoreTopology, OfObservationsThatWereLookedAtMostAreInTheirLandmark) {
  const Associations truth = {{4, 4, 4, 4, 7}};
  const auto correct = [&](const Associations& map) {
    return ScoreTopology(map, All(map, true), All(map, false), truth, 2).correct;
  };
  EXPECT_TRUE(correct({{0, 0, 0, -1, 1}}));
  EXPECT_FALSE(correct({{0, 0, -1, -1, 1}})) << "half of them held to be of nothing";
}

TEST(ReadLookedAt, IsToldByTheProbabilityOfBeingOfNone) {
  Blob result;
  result.PutVector("robot/0/observations/probability", std::vector<double>{0.9, 0.0, 0.4, 0.0});
  const Associations map = {{0, -1, -1, 0}};
  EXPECT_EQ(ReadLookedAt(Read<kinds::LandmarkMap>(result), map), (Flags{{true, false, true, true}}));
  EXPECT_EQ(ReadLookedAt({}, map), (Flags{{true, false, false, true}}));
  EXPECT_THROW(ReadLookedAt(Read<kinds::LandmarkMap>(result), {{0, -1}}), InputError);
}

TEST(MajorityPairs, GivesEachMapLandmarkItsMostFrequentTruth) {
  EXPECT_EQ(MajorityPairs({{0, 0, 0, 1, -1}}, {{5, 5, 6, -1, 8}}, 3), (IndexPairs{{0, 5}}));
}

kinds::Log DriveLog(bool truth = true) {
  Blob log;
  log.Put("robots", Array::Texts({"a"}));
  log.PutVector("robot/0/observations/time_s", std::vector<double>{1, 2});
  if (truth) log.PutVector("truth/robot/0/observations/landmark", std::vector<std::int32_t>{0, 1});
  return Read<kinds::Log>(log);
}

TEST(ReadAssociations, RefusesWrongLengthsAndIndices) {
  Blob result;
  result.PutVector("robot/0/observations/map_landmark", std::vector<std::int32_t>{0, -1});
  const auto map = [&] { return Read<kinds::LandmarkMap>(result); };
  EXPECT_EQ(ReadMapAssociations(map(), DriveLog(), 1), (Associations{{0, -1}}));
  EXPECT_THROW(ReadMapAssociations(map(), DriveLog(), 0), InputError);
  EXPECT_THROW(ReadMapAssociations({}, DriveLog(), 1), InputError);
  result.PutVector("robot/0/observations/map_landmark", std::vector<std::int32_t>{0});
  EXPECT_THROW(ReadMapAssociations(map(), DriveLog(), 1), InputError);
  EXPECT_THROW(ReadTrueAssociations(DriveLog(), 1), InputError);
  EXPECT_EQ(ReadTrueAssociations(DriveLog(), 2), (Associations{{0, 1}}));
  EXPECT_FALSE(ReadTrueAssociations(DriveLog(false), 2));
}

}  // namespace
}  // namespace cairn::datasets
