#include "pipelines/landmark_map/m_step_task.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/round.h"
#include "pipelines/landmark_map/state/speculation.h"
#include "pipelines/landmark_map/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::landmark_map {
namespace {

// The first round of a log: what its task `m_step` returns, and the partials that it was made of.
struct Round {
  Round() {
    const Blob log = SquareLog{.laps = 6, .side_m = 20.0}.Make();
    const Step step = pipeline.Start(MapInputs({{"log", std::make_shared<const Blob>(log)}}));
    plan = step.plan;
    for (const BlobPtr& blob : step.blobs) store[blob->ContentHash().Binary()] = blob;
    NoProgress progress;
    for (const Task& task : step.plan.tasks()) {
      MapInputs inputs;
      for (const proto::InputRef& ref : task.inputs()) inputs.Put(ref.name(), InputOf(ref, store, partials));
      partials.push_back(std::make_shared<const Blob>(pipeline.Run(task, inputs, progress)));
    }
  }

  Settings settings() const { return Settings::FromBlob(*store.at(plan.state().blobs().at("settings"))); }

  LandmarkMap pipeline{Options{.cell_m = 0.5, .growth_start = 1.0, .starts = 1, .slice_mcells = 0.5}};
  proto::Step plan;
  BlobsByHash store;
  std::vector<BlobPtr> partials;
};

// What Advance gets to see is what the partials, added up here, say.
TEST(MStepTask, ReturnsTheSumOfThePartialsAndTheMapOfIt) {
  const Round round;
  ASSERT_GT(round.partials.size(), 3U);
  const MStep made = MStep::FromBlob(round.settings(), *round.partials.back(), 1);
  RoundSum sum(round.settings(), 1);
  for (std::size_t i = 0; i + 1 < round.partials.size(); ++i) sum.Add(*round.partials[i]);
  EXPECT_EQ(made.sum.ToBlob().ContentHash(), sum.ToBlob().ContentHash());
  EXPECT_NEAR(made.sum.counts().Sum(), 6 * 4.0, 1e-6);  // a contact detection at each corner
  EXPECT_FALSE(made.landmarks.empty());
  EXPECT_FALSE(made.perception.likelihood.layers.empty());
}

// The same bits whether all partials are added up at once or a few at a time.
TEST(MStepTask, GoesOnFromWhatTasksBeforeItHaveAddedUp) {
  const Round round;
  const std::size_t last = round.partials.size() - 1;
  std::vector<BlobPtr> backward;
  for (std::size_t i = 0; i < last; ++i)
    if (round.partials[i]->Has("log_likelihood")) backward.push_back(round.partials[i]);
  ASSERT_GE(backward.size(), 3U);
  Task task = round.plan.tasks(static_cast<int>(last));
  ASSERT_EQ(task.kind(), "m_step");
  BlobPtr before;
  for (std::size_t i = 0; i < backward.size(); ++i) {
    MapInputs inputs({{"settings", round.store.at(round.plan.state().blobs().at("settings"))},
                      {PartialInput(0), backward[i]}});
    if (before) inputs.Put("sum", before);
    task.set_kind(i + 1 < backward.size() ? "sum" : "m_step");
    NoProgress progress;
    before = std::make_shared<const Blob>(round.pipeline.Run(task, inputs, progress));
  }
  EXPECT_EQ(before->ContentHash(), round.partials[last]->ContentHash());
}

// A round whose partials do not all fit into memory: no task reads more of them than may lie there at a time,
// and each is read once, in order.
TEST(MStepTask, LargePartialsAreAddedUpAFewAtATime) {
  RobotStates robot_states;
  robot_states.blobs = {{"settings", "s"}, {"steps/0", "a"}, {"steps/1", "b"}};
  robot_states.step_counts = {1000, 1000};
  robot_states.work = {1000 * 0.4 * kSumBytes / sizeof(double), 1000 * 3.0 * kSumBytes / sizeof(double)};
  robot_states.sharp = robot_states.work;
  robot_states.refined_rows = {0.0, 0.0};
  robot_states.overlap = {kOverlap, kOverlap};
  robot_states.odometry.resize(2);
  cairn::Step step;
  PlanRound({.slice_mcells = 2000}, {"small", "large"}, {.robots = 2}, robot_states, {}, &step);
  std::vector<std::uint32_t> backward, read;
  int sums = 0;
  std::int64_t before = -1;
  for (const Task& task : step.plan.tasks()) {
    if (task.kind() == "backward") backward.push_back(task.index());
    if (task.kind() != "sum" && task.kind() != "m_step") continue;
    ++sums;
    double bytes = 0.0;
    int partials = 0;
    std::int64_t sum = -1;
    for (const proto::InputRef& input : task.inputs()) {
      if (input.name() == "sum") sum = input.task();
      if (!input.name().starts_with("partial/")) continue;
      read.push_back(input.task());
      ++partials;
      bytes += (step.plan.tasks(static_cast<int>(input.task())).params().at("robot").i() == 0 ? 0.4 : 3.0);
    }
    EXPECT_EQ(sum, before);
    before = task.index();
    EXPECT_TRUE(partials == 1 || bytes <= 1.0) << partials;
  }
  EXPECT_GT(sums, 3);
  EXPECT_EQ(read, backward);
  EXPECT_EQ(step.plan.tasks().rbegin()->kind(), "m_step");
}

// The maps of the others: a task for each robot but the first, of all `backward` tasks but its own, which the
// State names; and in the round after, each robot is looked up in its own.
TEST(MStepTask, BeforeRobotsAreApartEachGetsTheMapOfTheOthers) {
  RobotStates robot_states;
  robot_states.blobs = {{"settings", "s"}, {"steps/0", "a"}, {"steps/1", "b"}, {"steps/2", "c"}};
  robot_states.step_counts = {10, 10, 10};
  robot_states.work = robot_states.sharp = {10.0, 10.0, 10.0};
  robot_states.refined_rows = {0.0, 0.0, 0.0};
  robot_states.overlap = {kOverlap, kOverlap, kOverlap};
  robot_states.odometry.resize(3);
  const std::vector<std::string> robots = {"one", "two", "three"};
  cairn::Step step;
  PlanRound({}, robots, {.robots = 3, .apart = 1}, robot_states, {}, &step);
  for (const std::size_t robot : {1U, 2U}) {
    const Task& without =
        step.plan.tasks(static_cast<int>(step.plan.state().scalars().at(TaskWithout(robot)).i()));
    EXPECT_EQ(without.kind(), "m_step");
    std::vector<std::int64_t> read;
    for (const proto::InputRef& input : without.inputs())
      if (input.has_task())
        read.push_back(step.plan.tasks(static_cast<int>(input.task())).params().at("robot").i());
    EXPECT_EQ(read, (std::vector<std::int64_t>{0, robot == 1 ? 2 : 1}));
  }
  EXPECT_FALSE(step.plan.state().scalars().contains(TaskWithout(0)));

  cairn::Step apart;
  Blob all, own;
  all.PutScalar<double>("of", 0.0);
  own.PutScalar<double>("of", 1.0);
  PlanRound({}, robots, {.robots = 3, .settled = 1, .apart = 1}, robot_states,
            {{"perception", all}, {PerceptionFor(1), own}}, &apart);
  for (const Task& task : apart.plan.tasks()) {
    if (task.kind() != "backward") continue;
    for (const proto::InputRef& input : task.inputs())
      if (input.name() == "perception") {
        EXPECT_EQ(input.blob(), (task.params().at("robot").i() == 1 ? own : all).ContentHash().Binary());
      }
  }
}

// A result is made of summaries: the tables that come with them may go.
TEST(RoundSum, KeepsOfAPartialNoTable) {
  const Round round;
  const auto backward =
      std::ranges::find_if(round.partials, [](const BlobPtr& p) { return p->Has("counts/box"); });
  ASSERT_NE(backward, round.partials.end());
  Blob partial = **backward;
  const std::vector<double> x = {1.0, 2.0};
  partial.PutVector("pose/x_m", x);
  partial.PutVector("association/landmark", std::vector<std::int32_t>{-1});
  RoundSum sum(round.settings(), 1);
  ASSERT_TRUE(partial.Has("counts/box"));
  sum.Add(partial);
  const std::vector<Blob> summaries = sum.SummariesOf(0);
  ASSERT_EQ(summaries.size(), 1U);
  for (const auto& [name, array] : summaries[0].fields()) {
    EXPECT_TRUE(name == "first" || name.starts_with("pose/") || name.starts_with("association/")) << name;
    EXPECT_NE(array.bytes().data(), partial.at(name).bytes().data())
        << name << " holds all that lies with it";
  }
  EXPECT_EQ(Joined(summaries, "pose/x_m"), x);
}

TEST(MStepTask, ASumOfOtherRobotsIsRefused) {
  const Round round;
  const Settings settings = round.settings();
  EXPECT_THROW(MStep::FromBlob(settings, *round.partials.back(), 2), InputError);
  EXPECT_THROW(MStep::FromBlob(settings, round.partials.back()->Without("sum/counts/"), 1), InputError);
}

}  // namespace
}  // namespace cairn::landmark_map
