#include "datasets/common/landmark_labels.h"

#include <gtest/gtest.h>

#include <set>

namespace cairn::datasets {
namespace {

using Labels = std::vector<std::string>;

kinds::LandmarkMap::Map WithIdentities(const std::vector<std::int32_t>& identity) {
  kinds::LandmarkMap::Map map;
  map.landmark_x_m = std::vector<double>(identity.size(), 1.0);
  map.landmark_identity = identity;
  return map;
}

TEST(LandmarkLabels, AreNamesAndElseNumbersThatAreNoNames) {
  EXPECT_EQ(LandmarkLabels(WithIdentities({2, -1, 0, -1}), {"1", "2", "3"}), (Labels{"3", "#1", "1", "#3"}));
  EXPECT_EQ(LandmarkLabels(WithIdentities({-1, -1}), {}), (Labels{"#0", "#1"}));
  kinds::LandmarkMap::Map old;
  old.landmark_x_m = std::vector<double>{1};
  EXPECT_EQ(LandmarkLabels(old, {}), Labels{"#0"});
}

// A name of the log that no landmark of the map bears counts, too: people know the log.
TEST(LandmarkLabels, AreNeverANameThatTheLogHas) {
  EXPECT_EQ(LandmarkLabels(WithIdentities({0, -1}), {"#1"}), (Labels{"#1", "##1"}));
  EXPECT_EQ(LandmarkLabels(WithIdentities({-1}), {"##3", "#7"}), Labels{"###0"});
  EXPECT_EQ(LandmarkLabels(WithIdentities({-1}), {"#", "#door", "##2"}), Labels{"#0"});
}

TEST(LandmarkLabels, AreAllDifferent) {
  const std::vector<std::string> names = {"0", "#0", "1", "##1", "2"};
  const Labels labels = LandmarkLabels(WithIdentities({-1, 1, 0, -1, 3, 4, 2, -1}), names);
  EXPECT_EQ(std::set<std::string>(labels.begin(), labels.end()).size(), labels.size());
}

}  // namespace
}  // namespace cairn::datasets
