#include "datasets/verdicts/verdict.h"

#include <gtest/gtest.h>

namespace cairn::datasets {
namespace {

TEST(Verdict, IsNoBetterThanTheWorstDoubtAndSaysEachOnce) {
  Verdict verdict{.trust = Confidence::kHigh, .why = "20 loops closed"};
  verdict.Add({.at_most = Confidence::kHigh});
  EXPECT_EQ(verdict.Text(), "high: 20 loops closed");
  verdict.Add({.at_most = Confidence::kLow, .text = "walls are bent"});
  verdict.Add({.at_most = Confidence::kFair, .text = "odometry slips"});
  verdict.Add({.at_most = Confidence::kLow, .text = "walls are bent"});
  EXPECT_EQ(verdict.Text(), "low: 20 loops closed; walls are bent; odometry slips");
}

// No rate was measured, say; but that walls are bent is known.
TEST(Verdict, WhatIsNotKnownIsLowWhereADoubtSaysSo) {
  Verdict verdict{.trust = Confidence::kNone, .why = "no loop was closed"};
  verdict.Add({.at_most = Confidence::kFair, .text = "odometry slips"});
  EXPECT_EQ(verdict.Text(), "not known: no loop was closed; odometry slips");
  verdict.Add({.at_most = Confidence::kLow, .text = "walls are bent"});
  EXPECT_EQ(verdict.Text(), "low: no loop was closed; odometry slips; walls are bent");
}

TEST(AtMost, IsTheLessTheMoreIsOff) {
  EXPECT_EQ(AtMost(0.07, 0.07, 0.15), Confidence::kHigh);
  EXPECT_EQ(AtMost(0.15, 0.07, 0.15), Confidence::kFair);
  EXPECT_EQ(AtMost(0.16, 0.07, 0.15), Confidence::kLow);
}

}  // namespace
}  // namespace cairn::datasets
