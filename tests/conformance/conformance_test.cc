// What every pipeline promises, whatever its method. A new one gets a branch in FixturesOf (cases.cc), and
// nothing here.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "pipelines/testing/in_process.h"
#include "schema/numerics.h"
#include "schema/rng.h"
#include "tests/conformance/replay.h"

namespace cairn::conformance {
namespace {

class Conformance : public ::testing::TestWithParam<Case> {
 protected:
  static void SetUpTestSuite() {
    FixNumericsOfProcess();
    FixNumericsOfThread();
  }
  // The undisturbed run, computed once a pipeline.
  const Trace& Undisturbed() const {
    static std::map<std::string, Trace> traces;
    const auto it = traces.find(GetParam().name);
    if (it != traces.end()) return it->second;
    return traces[GetParam().name] = Replay(GetParam(), GetParam().inputs);
  }
  void ExpectSame(const Trace& other) const {
    ASSERT_EQ(other.plans.size(), Undisturbed().plans.size());
    for (std::size_t i = 0; i < other.plans.size(); ++i) {
      EXPECT_EQ(other.plans[i], Undisturbed().plans[i]) << "step " << i;
    }
    EXPECT_EQ(other.partials, Undisturbed().partials);
    EXPECT_EQ(other.result->ContentHash(), Undisturbed().result->ContentHash());
  }
};

TEST_P(Conformance, TheFixtureHasSeveralRoundsOfSeveralTasks) {
  ASSERT_FALSE(GetParam().inputs.empty())
      << "add a fixture for " << GetParam().name << " to FixturesOf in cases.cc";
  ASSERT_GE(Undisturbed().moments.size(), GetParam().rounds + 1);
  std::size_t most = 0;
  for (const auto& partials : Undisturbed().partials) most = std::max(most, partials.size());
  EXPECT_GE(most, GetParam().tasks);
  EXPECT_FALSE(Undisturbed().result->fields().empty());
}

// Or nobody can be told how long it will take (tests/eta holds jobs that are long enough to what they are
// told).
TEST_P(Conformance, EveryStepSaysWhatItsTasksCostAndThatRoundsFollow) {
  const std::vector<Moment>& moments = Undisturbed().moments;
  for (std::size_t k = 0; k + 1 < moments.size(); ++k) {
    const proto::Step& plan = moments[k].plan;
    for (const Task& task : plan.tasks()) EXPECT_GE(task.cost(), 1U) << "step " << k << ", " << task.kind();
    const bool last = k + 2 == moments.size();
    if (!last) {
      EXPECT_GT(RoundsLater(plan), 0) << "step " << k << " of " << moments.size();
    }
  }
}

TEST_P(Conformance, StartAndAdvanceAreDeterministic) { ExpectSame(Replay(GetParam(), GetParam().inputs)); }

TEST_P(Conformance, TheReplayEqualsTheInProcessRunner) {
  const auto pipeline = Make(GetParam().stage, GetParam().seed);
  const BlobPtr result = RunInProcess(*pipeline, GetParam().inputs);
  EXPECT_EQ(result->ContentHash(), Undisturbed().result->ContentHash());
}

TEST_P(Conformance, RunIsPure) {
  ExpectSame(Replay(GetParam(), GetParam().inputs, {.pick = {}, .times = 2}));
}

TEST_P(Conformance, TheOrderOfTasksChangesNothing) {
  ExpectSame(Replay(GetParam(), GetParam().inputs, {.pick = [](std::size_t n) { return n - 1; }}));
  Rng rng(3);
  ExpectSame(Replay(GetParam(), GetParam().inputs, {.pick = [&rng](std::size_t n) { return rng.Below(n); }}));
}

TEST_P(Conformance, ResumedAtAnyStepEqualsUndisturbed) {
  const Trace& whole = Undisturbed();
  ASSERT_GT(whole.moments.size(), 1U);
  for (std::size_t k = 0; k < whole.moments.size(); ++k) {
    const Trace rest = ReplayFrom(GetParam(), CopyElsewhere(GetParam().inputs), whole.moments[k]);
    const auto from = static_cast<std::ptrdiff_t>(k);
    EXPECT_EQ(rest.plans, (std::vector(whole.plans.begin() + from, whole.plans.end())))
        << "resumed at step " << k;
    EXPECT_EQ(rest.result->ContentHash(), whole.result->ContentHash()) << "resumed at step " << k;
  }
}

TEST_P(Conformance, ACheckpointNeedsOnlyTheBlobsThatItsStepNames) {
  ASSERT_GT(Undisturbed().moments.size(), 1U);
  for (Moment moment : Undisturbed().moments) {
    BlobsByHash named;
    const auto keep = [&](const std::string& hash) { named[hash] = moment.store.at(hash); };
    for (const auto& [name, hash] : moment.plan.state().blobs()) keep(hash);
    for (const Task& task : moment.plan.tasks()) {
      for (const proto::InputRef& ref : task.inputs()) {
        if (ref.has_blob()) keep(ref.blob());
      }
    }
    if (!moment.plan.result().empty()) keep(moment.plan.result());
    moment.store = std::move(named);
    const Trace rest = ReplayFrom(GetParam(), GetParam().inputs, moment);
    EXPECT_EQ(rest.result->ContentHash(), Undisturbed().result->ContentHash());
  }
}

TEST_P(Conformance, TheTruthInTheLogChangesNothing) {
  InputMap stripped;
  bool had_truth = false;
  for (const auto& [name, blob] : GetParam().inputs) {
    const auto without = std::make_shared<const Blob>(blob->Without("truth/"));
    had_truth |= without->fields().size() < blob->fields().size();
    stripped[name] = without;
  }
  ASSERT_TRUE(had_truth) << "a fixture without truth shows nothing";
  const Trace trace = Replay(GetParam(), stripped);
  EXPECT_EQ(trace.partials, Undisturbed().partials);
  EXPECT_EQ(trace.result->ContentHash(), Undisturbed().result->ContentHash());
}

TEST_P(Conformance, WhereTheInputLiesInMemoryChangesNothing) {
  const InputMap first = CopyElsewhere(GetParam().inputs);
  const InputMap second = CopyElsewhere(GetParam().inputs);  // both live: other addresses
  ExpectSame(Replay(GetParam(), first));
  ExpectSame(Replay(GetParam(), second));
}

// Or slices side by side would go untested.
TEST(SideBySide, TheFixtureGuessesRightAndWrong) {
  const std::vector<Case> cases = AllCases();
  const auto c = std::ranges::find(cases, "landmark_map_side_by_side", &Case::name);
  ASSERT_NE(c, cases.end());
  const BlobPtr result = RunInProcess(*Make(c->stage, c->seed), c->inputs);
  const auto guessed = result->Get<std::int64_t>("history/guessed");
  const auto confirmed = result->Get<std::int64_t>("history/confirmed");
  const auto all = std::reduce(guessed.begin(), guessed.end());
  const auto right = std::reduce(confirmed.begin(), confirmed.end());
  EXPECT_GT(right, 0);
  EXPECT_GT(all, right);
}

INSTANTIATE_TEST_SUITE_P(AllPipelines, Conformance, ::testing::ValuesIn(AllCases()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace cairn::conformance
