#include "coordinator/scale/policy.h"

#include <gtest/gtest.h>

namespace cairn::coordinator {
namespace {

using State = ScaledWorker::State;

wire::Demand JobOf(std::uint32_t tasks, double work_s) {
  wire::Demand demand;
  demand.set_tasks(tasks);
  demand.set_work_s(work_s);
  return demand;
}

const PolicyOptions kPolicy{.least = 0, .most = 10, .work_s = 30, .idle_s = 60, .cool_down_s = 30};
constexpr double kLongAgo = 1e9;

TEST(WorkersWanted, AreAsManyAsTheWorkIsWorthAndTheTasksAre) {
  EXPECT_EQ(WorkersWanted(kPolicy, {}), 0);
  EXPECT_EQ(WorkersWanted(kPolicy, {JobOf(1, 0.1)}), 1) << "whatever there is to do";
  EXPECT_EQ(WorkersWanted(kPolicy, {JobOf(8, 65)}), 3) << "no more than the work is worth";
  EXPECT_EQ(WorkersWanted(kPolicy, {JobOf(2, 1e6)}), 2) << "no more than lie side by side";
  EXPECT_EQ(WorkersWanted(kPolicy, {JobOf(2, 1e6), JobOf(3, 1e6)}), 5);
  EXPECT_EQ(WorkersWanted(kPolicy, std::vector<wire::Demand>(100, JobOf(1, 1))), 4)
      << "jobs of a second each";
  EXPECT_EQ(WorkersWanted(kPolicy, {JobOf(1000, 1e9)}), 10);
  PolicyOptions kept = kPolicy;
  kept.least = 4;
  EXPECT_EQ(WorkersWanted(kept, {}), 4);
}

TEST(Decide, StartsWhatIsMissing) {
  const auto start = [](int others, const std::vector<ScaledWorker>& ours) {
    return Decide(kPolicy, {JobOf(6, 1e6)}, others, ours, 0).start;
  };
  EXPECT_EQ(start(0, {}), 6);
  EXPECT_EQ(start(0, {{State::kWaiting}, {State::kStarting}, {State::kBusy}, {State::kIdle}}), 2)
      << "what was asked for is not asked for again";
  EXPECT_EQ(start(0, {{State::kLeaving}}), 6);
  EXPECT_EQ(start(4, {}), 2) << "others serve too";
  EXPECT_EQ(start(9, {}), 0);
}

TEST(Decide, NeverRunsMoreThanIsAllowedAndThoseThatLeaveCount) {
  std::vector<ScaledWorker> ours(8, {State::kLeaving});
  EXPECT_EQ(Decide(kPolicy, {JobOf(100, 1e6)}, 0, ours, 0).start, 2);
  EXPECT_EQ(Decide(kPolicy, {JobOf(100, 1e6)}, 50, {}, 0).start, 10) << "the limit is of ours";
}

TEST(Decide, LetsGoWhatHasLongHadNothingToDoTheLongestFirst) {
  const std::vector<ScaledWorker> ours = {{State::kBusy, 500},
                                          {State::kIdle, 59},
                                          {State::kIdle, 61},
                                          {State::kIdle, 300},
                                          {State::kWaiting, 70}};
  const auto leave = [&](const std::vector<wire::Demand>& demand, double started_s = kLongAgo) {
    return Decide(kPolicy, demand, 0, ours, started_s).leave;
  };
  EXPECT_EQ(leave({}), (std::vector<std::size_t>{4, 3, 2}));
  EXPECT_EQ(leave({JobOf(3, 1e6)}), (std::vector<std::size_t>{4, 3})) << "three are wanted";
  EXPECT_TRUE(leave({JobOf(5, 1e6)}).empty());
  EXPECT_TRUE(leave({}, 29).empty()) << "it is too soon after a start";
}

TEST(Decide, WhereThereAreTooManyThoseThatComputeFinishAndGo) {
  std::vector<ScaledWorker> ours(10, {State::kBusy, 5});
  EXPECT_TRUE(Decide(kPolicy, {JobOf(100, 1e6)}, 0, ours, 0).leave.empty());
  ours.insert(ours.begin(), {{State::kStarting, 1}, {State::kBusy, 50}, {State::kIdle, 1}});
  EXPECT_EQ(Decide(kPolicy, {JobOf(100, 1e6)}, 0, ours, 0).leave, (std::vector<std::size_t>{2, 1}));
}

TEST(Decide, KeepsTheLeast) {
  PolicyOptions kept = kPolicy;
  kept.least = 2;
  const std::vector<ScaledWorker> ours(3, {State::kIdle, 1000});
  EXPECT_EQ(Decide(kept, {}, 0, ours, kLongAgo).leave.size(), 1U);
  EXPECT_EQ(Decide(kept, {}, 5, {}, kLongAgo).start, 2) << "of ours, whoever else is there";
}

}  // namespace
}  // namespace cairn::coordinator
