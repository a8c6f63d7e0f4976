#include "pipelines/local_map/traces/find_on.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/local_map/testing/trace.h"

namespace cairn::local_map {
namespace {

FindOptions Options() {
  FindOptions options;
  return options;
}

TEST(FindOn, FindsATraceThatIsMetresOff) {
  const EdgeTrace recorded = HandTrace(Corridor(), {}, -15, 60);
  const EdgeTrace other = HandTrace(Corridor(), {1.3, -0.21}, -15, 40);
  const auto found = FindOn(recorded, other, {-1.5, 0.3}, {4, 1}, Options());
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(found[0].z_m, 1.3, 0.05);
  EXPECT_NEAR(found[0].u_m, -0.21, 0.03);
  EXPECT_GT(found[0].confidence, 0.9);
}

TEST(FindOn, FindsACorridorDrivenBack) {
  const EdgeTrace recorded = HandTrace(Corridor(), {}, -15, 60);
  const EdgeTrace back = Reversed(HandTrace(Corridor(), {0.4, 0.1}, -10, 40));
  const auto found = FindOn(Reversed(recorded), back, {0, 0}, {3, 0.6}, Options());
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(found[0].z_m, -0.4, 0.06);
  EXPECT_NEAR(found[0].u_m, -0.1, 0.03);
}

// The same niche every two metres.
TEST(FindOn, HasLittleConfidenceWhereSeveralPlacesAreAlike) {
  HandWorld row{{{-99, 1}}, {{-99, 1}}, {}, {}};
  for (int k = -5; k < 10; ++k) {
    row.left.push_back({2.0 * k, 1.3});
    row.left.push_back({2.0 * k + 0.8, 1.0});
  }
  const auto found =
      FindOn(HandTrace(row, {}, -60, 120), HandTrace(row, {2.3, 0}, -15, 16), {2.3, 0}, {3, 0.5}, Options());
  ASSERT_EQ(found.size(), 3U);
  EXPECT_LT(found[0].confidence, 0.6);
  EXPECT_NEAR(found[1].score, found[0].score, 0.1 * found[0].score);
}

TEST(FindOn, HasNoConfidenceInAnotherPlace) {
  const HandWorld other{{{-9, 1.7}, {1, 1.2}}, {{-9, 0.6}, {2, 1.4}}, {1}, {2}};
  for (const Candidate& candidate :
       FindOn(HandTrace(Corridor(), {}, -15, 60), HandTrace(other, {}, -15, 40), {}, {3, 1}, Options()))
    EXPECT_LT(candidate.confidence, 0.5);
}

TEST(FindOn, InABlankCorridorKnowsUOnly) {
  const HandWorld blank{{{-99, 1}}, {{-99, 1.1}}, {}, {}};
  const auto found =
      FindOn(HandTrace(blank, {}, -60, 120), HandTrace(blank, {0, 0.12}, -20, 30), {}, {2, 0.6}, Options());
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(std::isinf(found[0].sd_z_m));
  EXPECT_LT(found[0].confidence, 0.7);
  EXPECT_NEAR(found[0].u_m, 0.12, 0.03);
}

TEST(FindOn, FindsNothingWhereNothingIsKnown) {
  EXPECT_TRUE(
      FindOn(HandTrace(Corridor(), {}, -15, 60), HandTrace({}, {}, -15, 40), {}, {3, 1}, Options()).empty());
}

}  // namespace
}  // namespace cairn::local_map
