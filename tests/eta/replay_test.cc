#include "tests/eta/replay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "coordinator/core/eta.h"

namespace cairn::eta {
namespace {

std::vector<std::filesystem::path> Traces() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(CAIRN_ETA_TRACES))
    paths.push_back(entry.path());
  std::ranges::sort(paths);
  return paths;
}

constexpr int kMostJumps = 5;

std::string Text(const Said& said, const Said& last) {
  char text[160];
  std::snprintf(text, sizeof text, "after %.1f of %.1f s: about %.1f s (%.1f to %.1f) left, true %.1f s",
                said.at_s, last.at_s + last.true_s, said.said_s, said.least_s, said.most_s, said.true_s);
  return text;
}

class OfEachTrace : public testing::TestWithParam<std::filesystem::path> {
 protected:
  const Trace trace_ = ReadTrace(GetParam());
};

// Looks at what is said from `from_s` on; the job is never asked about before its first quarter is over.
void ExpectNear(const std::vector<Said>& said, double from_s, const std::string& what) {
  ASSERT_FALSE(said.empty());
  const double all_s = said.back().at_s + said.back().true_s;
  int looks = 0;
  for (const Said& one : said) {
    if (one.at_s < std::max(all_s / 4, from_s)) continue;
    EXPECT_TRUE(IsNear(one)) << what << ", " << Text(one, said.back());
    ++looks;
  }
  EXPECT_GT(looks, 0) << what << ": the job is too short to tell";
}

double SecondsOf(const std::vector<Said>& said) { return said.back().at_s + said.back().true_s; }

TEST_P(OfEachTrace, IsOfAJobOfTenSecondsOrMore) { EXPECT_GT(SecondsOf(Replay(trace_)), 9.9); }

// The promise to people.
TEST_P(OfEachTrace, IsNeverMoreThanTwiceOffAfterTheFirstQuarter) {
  for (const int workers : {1, 2, 4})
    ExpectNear(Replay(trace_, {.workers = workers}), 0, std::to_string(workers) + " workers");
}

// A span that holds everything would be near all that is true.
TEST_P(OfEachTrace, IsAFigureButInASearchWhereItIsASpanThatSaysSomething) {
  const bool searches = GetParam().stem().string().starts_with("landmark_map");
  constexpr double kWidest = 12;
  std::vector<double> widths;
  for (const Said& one : Replay(trace_)) {
    if (one.said_s > 0 && one.IsSpan()) widths.push_back(one.most_s / one.least_s);
  }
  EXPECT_EQ(!widths.empty(), searches);
  if (widths.empty()) return;
  std::ranges::sort(widths);
  EXPECT_LT(widths[widths.size() / 2], kWidest) << "the most by the least, in the middle of all looks";
}

TEST_P(OfEachTrace, WorkersThatComeAndGoChangeThePlanAtOnce) {
  const double all_s = SecondsOf(Replay(trace_));
  ExpectNear(Replay(trace_, {.workers = 1, .joins_s = all_s / 2}), all_s / 2 + 1, "a second one joins");
  ExpectNear(Replay(trace_, {.workers = 2, .leaves_s = all_s / 2}), all_s / 2 + 1, "one of two leaves");
}

TEST_P(OfEachTrace, APauseChangesNothing) {
  const double half_s = SecondsOf(Replay(trace_)) / 2;
  ExpectNear(Replay(trace_, {.paused_s = half_s, .resumed_s = 10 * half_s}), 10 * half_s + 1,
             "paused half-way");
}

// It counts down and moves little by little, but where the plan changes: that is a few times in a job.
TEST_P(OfEachTrace, WhatIsShownIsSmooth) {
  const std::vector<Said> said = Replay(trace_);
  int jumps = 0;
  for (std::size_t k = 1; k < said.size(); ++k) {
    const double passed_s = said[k].at_s - said[k - 1].at_s, counted_s = said[k - 1].said_s - passed_s;
    const double share =
        passed_s * (coordinator::Eta::kShare + coordinator::Eta::kYoung / (0.5 * said[k].at_s));
    const double most_s =
        std::max(0.2, counted_s) * (std::exp(share) - 1) + 2 * coordinator::Eta::kSlack * passed_s;
    jumps += said[k - 1].said_s > 0 && std::abs(said[k].said_s - counted_s) > most_s ? 1 : 0;
  }
  EXPECT_LE(jumps, kMostJumps);
}

INSTANTIATE_TEST_SUITE_P(Eta, OfEachTrace, testing::ValuesIn(Traces()),
                         [](const auto& instance) { return instance.param.stem().string(); });

}  // namespace
}  // namespace cairn::eta
