#include "datasets/evaluate/associations.h"

#include <gtest/gtest.h>

#include <limits>

namespace cairn::datasets {
namespace {

TEST(SamePartition, LooksAtTheClassesNotTheirNumbers) {
  const Associations truth = {{4, 7, 4, -1}, {7, 9}};
  EXPECT_TRUE(SamePartition({{1, 0, 1, -1}, {0, 2}}, truth, 3));
  EXPECT_FALSE(SamePartition({{1, 0, 1, -1}, {0, 2}}, truth, 4)) << "a landmark is extra";
  EXPECT_FALSE(SamePartition({{1, 0, 1, -1}, {0, 0}}, truth, 2)) << "two joined";
  EXPECT_FALSE(SamePartition({{1, 0, 3, -1}, {0, 2}}, truth, 4)) << "one split";
  EXPECT_FALSE(SamePartition({{1, 0, -1, -1}, {0, 2}}, truth, 3)) << "one left out";
  EXPECT_FALSE(SamePartition({{1, 0, 1, 2}, {0, 2}}, truth, 3)) << "a false one taken in";
  EXPECT_TRUE(SamePartition({{}, {}}, {{}, {}}, 0));
}

TEST(MajorityPairs, GivesEachMapLandmarkItsMostFrequentTruth) {
  EXPECT_EQ(MajorityPairs({{0, 0, 0, 1, -1}}, {{5, 5, 6, -1, 8}}, 3), (IndexPairs{{0, 5}}));
}

Blob Log() {
  Blob log;
  log.Put("robots", Array::Texts({"a"}));
  log.PutVector("robot/0/observations/time_s", std::vector<double>{1, 2});
  log.PutVector("truth/robot/0/observations/landmark", std::vector<std::int32_t>{0, 1});
  return log;
}

TEST(ReadAssociations, RefusesWrongLengthsAndIndices) {
  Blob result;
  result.PutVector("robot/0/observations/map_landmark", std::vector<std::int32_t>{0, -1});
  EXPECT_EQ(ReadMapAssociations(result, Log(), 1), (Associations{{0, -1}}));
  EXPECT_THROW(ReadMapAssociations(result, Log(), 0), InputError);
  EXPECT_THROW(ReadMapAssociations(Blob(), Log(), 1), InputError);
  result.PutVector("robot/0/observations/map_landmark", std::vector<std::int32_t>{0});
  EXPECT_THROW(ReadMapAssociations(result, Log(), 1), InputError);
  EXPECT_THROW(ReadTrueAssociations(Log(), 1), InputError);
  EXPECT_EQ(ReadTrueAssociations(Log(), 2), (Associations{{0, 1}}));
  EXPECT_FALSE(ReadTrueAssociations(Log().Without("truth/"), 2));
}

}  // namespace
}  // namespace cairn::datasets
