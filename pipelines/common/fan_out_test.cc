#include "pipelines/common/fan_out.h"

#include <gtest/gtest.h>

#include "pipelines/testing/in_process.h"

namespace cairn {
namespace {

Blob Number(double value) {
  Blob blob;
  blob.PutScalar<double>("value", value);
  return blob;
}

// A candidate with a scalar, a blob of its own, one that all share, and tasks of which each looks at the one
// before.
Step Candidate(double value, int tasks) {
  Step step;
  State& state = *step.plan.mutable_state();
  (*state.mutable_scalars())["value"].set_d(value);
  (*state.mutable_blobs())["own"] = step.Share(Number(value));
  (*state.mutable_blobs())["shared"] = step.Share(Number(0.5));
  for (int i = 0; i < tasks; ++i) {
    Task& task = *step.plan.add_tasks();
    task.set_index(static_cast<std::uint32_t>(i));
    proto::InputRef& input = *task.add_inputs();
    if (i == 0)
      input.set_blob(state.blobs().at("own"));
    else
      input.set_task(static_cast<std::uint32_t>(i - 1));
  }
  ExpectRounds(tasks, 10.0 * tasks, 1, &step.plan);
  return step;
}

TEST(FanOut, TasksFollowInTheOrderOfCandidatesAndNameTheirOwn) {
  const Step merged = FanOut({Candidate(1, 2), Candidate(2, 0), Candidate(3, 3)});
  ASSERT_EQ(merged.plan.tasks_size(), 5);
  const std::vector<std::int64_t> starts = {0, 0, 2, 2, 2};
  for (int i = 0; i < 5; ++i) {
    const Task& task = merged.plan.tasks(i);
    EXPECT_EQ(task.index(), static_cast<std::uint32_t>(i));
    EXPECT_EQ(task.params().at("start").i(), starts[static_cast<std::size_t>(i)]);
    const bool first = i == 0 || i == 2;
    EXPECT_EQ(task.inputs(0).has_task(), !first);
    EXPECT_EQ(task.inputs(0).task(), first ? 0U : static_cast<std::uint32_t>(i - 1));
  }
  EXPECT_EQ(RoundsLater(merged.plan), 3) << "of the longest";
  EXPECT_EQ(CostLater(merged.plan), 50);
  EXPECT_EQ(merged.plan.later(0).width(), 2) << "the one without tasks expects none to come";
  EXPECT_EQ(merged.blobs.size(), 4U);  // what all share is there once
}

TEST(FanOut, ACandidateSeesWhatItWouldSeeAlone) {
  const Step merged = FanOut({Candidate(1, 2), Candidate(2, 0), Candidate(3, 3)});
  ASSERT_EQ(StartsIn(merged.plan.state()), 3);
  BlobsByHash store;
  for (const BlobPtr& blob : merged.blobs) store[blob->ContentHash().Binary()] = blob;
  const auto log = std::make_shared<const Blob>(Number(7));
  const MapInputs inputs = InputsOfRound(merged.plan.state(), store, {{"log", log}});
  std::vector<BlobPtr> done;
  for (int i = 0; i < 5; ++i) done.push_back(std::make_shared<const Blob>(Number(10 + i)));
  VectorPartials partials(done);
  const std::vector<std::vector<double>> answers = {{10, 11}, {}, {12, 13, 14}};
  for (int k = 0; k < 3; ++k) {
    OneStart one(merged.plan.state(), k, partials, inputs);
    const State alone = Candidate(k + 1, 0).plan.state();
    ASSERT_EQ(one.state().scalars_size(), 1);
    EXPECT_EQ(one.state().scalars().at("value").d(), alone.scalars().at("value").d());
    ASSERT_EQ(one.state().blobs_size(), 2);
    for (const auto& [name, hash] : alone.blobs()) EXPECT_EQ(one.state().blobs().at(name), hash) << name;
    EXPECT_EQ(one.waits(), k == 1);
    const Inputs& own = one;
    EXPECT_EQ(own.Get("own")->Scalar<double>("value"), k + 1);
    EXPECT_EQ(own.Get("log")->Scalar<double>("value"), 7);
    Partials& parts = one;
    ASSERT_EQ(parts.size(), answers[static_cast<std::size_t>(k)].size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      EXPECT_EQ(parts.Get(i)->Scalar<double>("value"), answers[static_cast<std::size_t>(k)][i]);
    }
  }
}

// Others made the State.
TEST(FanOut, ACandidateOfMoreTasksThanThereArePartialsIsRefused) {
  const Step merged = FanOut({Candidate(1, 2), Candidate(3, 3)});
  const MapInputs inputs;
  VectorPartials partials(std::vector<BlobPtr>(5));
  EXPECT_NO_THROW(OneStart(merged.plan.state(), 1, partials, inputs));
  for (const std::int64_t tasks : {std::int64_t{-1}, std::int64_t{4}, std::int64_t{1} << 62}) {
    State state = merged.plan.state();
    (*state.mutable_scalars())["tasks_of_start/1"].set_i(tasks);
    EXPECT_THROW(OneStart(state, 1, partials, inputs), InputError) << tasks;
    (*state.mutable_scalars())["tasks_of_start/0"].set_i(tasks);
    (*state.mutable_scalars())["tasks_of_start/1"].set_i(3);
    EXPECT_THROW(OneStart(state, 1, partials, inputs), InputError) << tasks;
  }
  State state = merged.plan.state();
  (*state.mutable_scalars())["starts"].set_i(std::int64_t{1} << 40);
  EXPECT_THROW(StartsIn(state), InputError);
}

TEST(StartsIn, IsNoneOfAStateThatWasNotFannedOut) { EXPECT_EQ(StartsIn(Candidate(1, 1).plan.state()), 0); }

}  // namespace
}  // namespace cairn
