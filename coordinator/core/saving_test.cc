// Checkpoints, full disks, restarts, and which blobs may go.
#include <gtest/gtest.h>

#include <algorithm>

#include "coordinator/core/testing/core_fixture.h"

namespace cairn::coordinator {
namespace {

// Plays one round of one task to its ADVANCE; the next step shares the blob `state`.
void PlayRound(CoreFixture& fixture, std::uint64_t n) {
  fixture.AnswerRun(fixture.Next(), H(100 + n));
  proto::Step step = TestStep(1, "round " + std::to_string(n));
  (*step.mutable_state()->mutable_blobs())["state"] = H(200 + n).Binary();
  fixture.AnswerPlan(fixture.Next(), step, {H(200 + n)});
}

bool Names(const proto::Checkpoint& checkpoint, const Hash& hash) {
  return std::find(checkpoint.blobs().begin(), checkpoint.blobs().end(), hash.Binary()) !=
         checkpoint.blobs().end();
}

TEST(CoreSaving, ASubmittedJobIsSavedAtOnceWithItsInputs) {
  CoreFixture fixture;
  fixture.Submit();
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  const proto::Checkpoint checkpoint = fixture.All<Persist>()[0].checkpoint;
  EXPECT_EQ(checkpoint.number(), 1u);
  EXPECT_FALSE(checkpoint.has_step());
  EXPECT_TRUE(Names(checkpoint, H(1000)));
}

TEST(CoreSaving, SavesAtMostOnceInAnIntervalAndThenTheLatest) {
  CoreFixture fixture;
  Begin(fixture, 1);
  for (std::uint64_t n = 0; n < 5; ++n) {
    PlayRound(fixture, n);
    EXPECT_TRUE(fixture.All<Persist>().empty());
  }
  fixture.Advance(1.1);
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  const proto::Checkpoint checkpoint = fixture.All<Persist>()[0].checkpoint;
  EXPECT_EQ(checkpoint.number(), 2u);
  EXPECT_EQ(checkpoint.round(), 5u);
  EXPECT_EQ(checkpoint.step().note(), "round 4");
  EXPECT_TRUE(Names(checkpoint, H(204)));
  fixture.Advance(5);
  EXPECT_TRUE(fixture.All<Persist>().empty()) << "one at a time, and nothing new came";
}

TEST(CoreSaving, ManyPartialsAreSavedLessOftenThanFew) {
  CoreOptions options;
  options.checkpoint_interval_s = 0.001;
  CoreFixture fixture(options);
  Begin(fixture, 1001, 1000);
  fixture.Advance(1);
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  fixture.Do(PersistDone{"a", fixture.All<Persist>()[0].checkpoint.number()});
  for (std::uint64_t i = 0; i < 1000; ++i) fixture.AnswerRun(fixture.Next(), H(5000 + i));
  fixture.Advance(0.02);
  EXPECT_TRUE(fixture.All<Persist>().empty());
  fixture.Advance(0.02);
  EXPECT_EQ(fixture.All<Persist>().size(), 1u);
}

TEST(CoreSaving, SavesEverySoManyRoundsWhereThatIsAskedForHoweverLongTheyTake) {
  CoreOptions options;
  options.checkpoint_rounds = 3;
  CoreFixture fixture(options);
  Begin(fixture, 1);
  for (std::uint64_t n = 0; n < 9; ++n) {
    fixture.Advance(n % 2 == 0 ? 5 : 0.001);
    EXPECT_TRUE(fixture.All<Persist>().empty()) << n;
    PlayRound(fixture, n);
    const auto saved = fixture.All<Persist>();
    ASSERT_EQ(saved.size(), n % 3 == 1 ? 1U : 0U) << n;  // the round that Begin began is the first
    if (saved.empty()) continue;
    EXPECT_EQ(saved[0].checkpoint.round(), n + 1);
    fixture.Do(PersistDone{"a", saved[0].checkpoint.number()});
  }
}

TEST(CoreSaving, RoundsGoOnWhileACheckpointIsUnderWay) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Advance(1.1);
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  fixture.now_s += 2;
  PlayRound(fixture, 0);
  PlayRound(fixture, 1);
  EXPECT_TRUE(fixture.All<Persist>().empty());
  EXPECT_EQ(fixture.Info().round(), 2u);
  fixture.Do(PersistDone{"a", 2});
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  EXPECT_EQ(fixture.All<Persist>()[0].checkpoint.round(), 2u);
}

TEST(CoreSaving, KeepsTheBlobsOfTheLastTwoCheckpoints) {
  CoreFixture fixture;
  Begin(fixture, 1);
  std::uint64_t number = 1;
  const auto play_and_save = [&](std::uint64_t n) {
    PlayRound(fixture, n);
    fixture.Heartbeat("w");
    fixture.Advance(1.1);
    fixture.Do(PersistDone{"a", ++number});
  };
  play_and_save(0);
  play_and_save(1);
  EXPECT_TRUE(fixture.core.Holds(H(200)));
  play_and_save(2);
  EXPECT_FALSE(fixture.core.Holds(H(200)));
  EXPECT_TRUE(fixture.core.Holds(H(201)));
  EXPECT_TRUE(fixture.core.Holds(H(202)));
  EXPECT_FALSE(fixture.core.Holds(H(102))) << "partials go when they are reduced";
}

TEST(CoreSaving, AFullDiskPausesTheJobWithTheReasonAndResumeGoesOn) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Advance(1.1);
  fixture.Do(PersistFailed{"a", 2, "no space left on device"});
  EXPECT_EQ(fixture.Info().state(), "paused");
  EXPECT_EQ(fixture.Info().reason(), "cannot save: no space left on device");
  fixture.AnswerRun(fixture.Next(), H(100));
  EXPECT_EQ(fixture.Info().tasks_done(), 1u) << "what was under way still counts";
  EXPECT_TRUE(fixture.assigned.empty());
  fixture.Advance(5);
  EXPECT_TRUE(fixture.All<Persist>().empty());
  fixture.Do(ResumeJob{"a"});
  EXPECT_EQ(fixture.Info().state(), "running");
  EXPECT_EQ(fixture.All<Persist>().size(), 1u);
  EXPECT_EQ(fixture.All<Persist>()[0].checkpoint.number(), 3u);
  EXPECT_EQ(fixture.Next().assign.key().kind(), wire::TaskKey::ADVANCE);
}

TEST(CoreSaving, ACancelThatCouldNotBeSavedIsSavedLater) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Do(CancelJob{"a"});
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  const std::uint64_t number = fixture.All<Persist>()[0].checkpoint.number();
  fixture.Do(PersistFailed{"a", number, "no space left on device"});
  EXPECT_TRUE(fixture.All<Persist>().empty()) << "not at once: the disk is full";
  EXPECT_EQ(fixture.Info().state(), "cancelled");
  EXPECT_TRUE(fixture.core.HasUnsaved());
  fixture.Advance(4);
  EXPECT_TRUE(fixture.All<Persist>().empty());
  fixture.Advance(2);
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  EXPECT_EQ(fixture.All<Persist>()[0].checkpoint.state(), proto::JOB_CANCELLED);
  fixture.Do(PersistDone{"a", number + 1});
  EXPECT_FALSE(fixture.core.HasUnsaved());
}

TEST(CoreSaving, BlobsOfOlderCheckpointsOfAJobThatIsDoneAreDroppedAtRestore) {
  proto::Checkpoint done;
  done.set_job_id("a");
  done.set_number(9);
  *done.mutable_job() = TestJob();
  done.set_state(proto::JOB_DONE);
  done.set_stage(1);
  done.add_results(H(20).Binary());
  CoreFixture fixture;
  fixture.Do(RestoreJob{done, {H(5)}});
  ASSERT_EQ(fixture.All<DropBlobs>().size(), 1u);
  EXPECT_EQ(fixture.All<DropBlobs>()[0].hashes, std::vector{H(5)});
}

TEST(CoreSaving, AResultThatCouldNotBePublishedIsPublishedAfterResume) {
  CoreFixture fixture;
  fixture.Submit("a", TestJob(2));
  fixture.Do(PersistDone{"a", 1});
  fixture.Join("w");
  fixture.AnswerResult(fixture.Next(), H(20));
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  EXPECT_EQ(fixture.All<Persist>()[0].publish.size(), 1u);
  fixture.Do(PersistFailed{"a", 2, "full"});
  fixture.Do(ResumeJob{"a"});
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  ASSERT_EQ(fixture.All<Persist>()[0].publish.size(), 1u);
  EXPECT_EQ(fixture.All<Persist>()[0].publish[0].result, H(20));
  fixture.Do(PersistDone{"a", 3});
  fixture.AnswerResult(fixture.Next(), H(21));
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  ASSERT_EQ(fixture.All<Persist>()[0].publish.size(), 1u) << "each result once";
  EXPECT_EQ(fixture.All<Persist>()[0].publish[0].result, H(21));
}

TEST(CoreSaving, ARestoredJobGoesOnFromItsStepWithTheSameTasks) {
  CoreFixture before;
  Begin(before, 1);
  PlayRound(before, 0);
  before.Advance(1.1);
  ASSERT_EQ(before.All<Persist>().size(), 1u);
  const proto::Checkpoint checkpoint = before.All<Persist>()[0].checkpoint;

  CoreFixture after;
  after.Do(RestoreJob{checkpoint, {}});
  after.Join("w");
  const auto task = after.Next(), same = before.Next();
  EXPECT_EQ(task.assign.key().round(), 1u);
  EXPECT_EQ(task.assign.SerializeAsString(), same.assign.SerializeAsString());
  EXPECT_TRUE(after.core.Holds(H(200)));
  after.AnswerRun(task, H(101));
  ASSERT_EQ(after.All<Persist>().size(), 1u);
  after.Do(PersistDone{"a", after.All<Persist>()[0].checkpoint.number()});
  after.AnswerResult(after.Next(), H(20));
  ASSERT_EQ(after.All<Persist>().size(), 1u);
  EXPECT_GT(after.All<Persist>()[0].checkpoint.number(), checkpoint.number());
}

TEST(CoreSaving, ALongRoundIsSavedWithItsPartialsAndGoesOnFromThem) {
  CoreFixture before;
  Begin(before, 3);
  before.Advance(0.5);
  before.AnswerRun(before.Next(), H(100));
  before.Heartbeat("w");
  before.Advance(0.6);
  ASSERT_EQ(before.All<Persist>().size(), 1u);
  const proto::Checkpoint checkpoint = before.All<Persist>()[0].checkpoint;
  ASSERT_EQ(checkpoint.partials_size(), 3);
  EXPECT_EQ(checkpoint.partials(0), H(100).Binary());
  EXPECT_TRUE(checkpoint.partials(1).empty());
  EXPECT_TRUE(Names(checkpoint, H(100)));

  CoreFixture after;
  after.Do(RestoreJob{checkpoint, {}});
  EXPECT_EQ(after.Info().tasks_done(), 1u);
  after.Join("w");
  for (const std::uint32_t task : {1u, 2u}) {
    const auto next = after.Next();
    EXPECT_EQ(next.assign.key().task(), task);
    after.AnswerRun(next, H(100 + task));
  }
  const auto advance = after.Next();
  ASSERT_EQ(advance.assign.key().kind(), wire::TaskKey::ADVANCE);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(advance.assign.partials(i), H(100 + static_cast<std::uint64_t>(i)).Binary());
}

TEST(CoreSaving, AYoungRoundIsSavedWithoutPartials) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.now_s = 0.9;
  PlayRound(fixture, 0);
  fixture.AnswerRun(fixture.Next(), H(101));
  fixture.Advance(0.2);
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  EXPECT_EQ(fixture.All<Persist>()[0].checkpoint.round(), 1u);
  EXPECT_EQ(fixture.All<Persist>()[0].checkpoint.partials_size(), 0);
}

TEST(CoreSaving, TheFirstAnswerAfterARestartIsSavedAtOnceThenOnceInAnInterval) {
  CoreFixture before;
  Begin(before, 4);
  before.Advance(1.1);
  ASSERT_EQ(before.All<Persist>().size(), 1u);
  const proto::Checkpoint checkpoint = before.All<Persist>()[0].checkpoint;

  CoreFixture after;
  after.Do(RestoreJob{checkpoint, {}});
  after.Join("w");
  after.Advance(0.1);
  EXPECT_TRUE(after.All<Persist>().empty()) << "nothing new came";
  after.AnswerRun(after.Next(), H(100));
  ASSERT_EQ(after.All<Persist>().size(), 1u);
  EXPECT_EQ(after.All<Persist>()[0].checkpoint.partials(0), H(100).Binary());
  after.Do(PersistDone{"a", checkpoint.number() + 1});
  after.AnswerRun(after.Next(), H(101));
  EXPECT_TRUE(after.All<Persist>().empty());
  after.Heartbeat("w");
  after.Advance(1.1);
  EXPECT_EQ(after.All<Persist>().size(), 1u);
}

// A run that is stopped soon after it was started again must not lose what it began with.
TEST(CoreSaving, PartialsThatWereSavedStaySavedAfterARestart) {
  CoreFixture before;
  Begin(before, 3);
  before.AnswerRun(before.Next(), H(100));
  before.Advance(1.1);
  const proto::Checkpoint checkpoint = before.All<Persist>().at(0).checkpoint;
  ASSERT_EQ(checkpoint.partials(0), H(100).Binary());

  CoreFixture after;
  after.Do(RestoreJob{checkpoint, {}});
  after.Join("w");
  after.AnswerRun(after.Next(), H(101));
  ASSERT_EQ(after.All<Persist>().size(), 1u);
  EXPECT_EQ(after.All<Persist>()[0].checkpoint.partials(0), H(100).Binary());
  EXPECT_EQ(after.All<Persist>()[0].checkpoint.partials(1), H(101).Binary());
}

TEST(CoreSaving, ARestoredJobOfAnotherBuildIsPausedWithTheReason) {
  CoreFixture before;
  Begin(before, 1);
  before.Advance(1.1);
  CoreOptions newer;
  newer.build = TestBuild("2");
  CoreFixture after(newer);
  after.Do(RestoreJob{before.All<Persist>().at(0).checkpoint, {}});
  after.Join("x", 1, "2");
  EXPECT_EQ(after.core.fleet().size(), 1u);
  EXPECT_EQ(after.Info().state(), "paused");
  EXPECT_EQ(after.Info().reason(), "it was begun by another build: version is '1', the coordinator's is '2'");
  after.Do(ResumeJob{"a"});
  EXPECT_TRUE(after.assigned.empty());
}

TEST(CoreSaving, AnEndedJobIsRestoredAsItEnded) {
  CoreFixture before;
  Begin(before, 1);
  before.Fail(before.Next(), "no good", true);
  const proto::Checkpoint checkpoint = before.All<Persist>().at(0).checkpoint;
  CoreFixture after;
  after.Do(RestoreJob{checkpoint, {}});
  after.Join("w");
  EXPECT_EQ(after.Info().state(), "failed");
  EXPECT_TRUE(after.Info().input_error());
  EXPECT_TRUE(after.assigned.empty());
  after.Do(RetryJob{"a"});
  EXPECT_EQ(after.Next().assign.key().kind(), wire::TaskKey::RUN);
}

TEST(CoreSaving, ARestoredJobKeepsThePlaceOfItsSubmission) {
  CoreFixture fixture;
  proto::Checkpoint checkpoint;
  checkpoint.set_job_id("old");
  checkpoint.set_order(5);
  *checkpoint.mutable_job() = TestJob();
  fixture.Do(RestoreJob{checkpoint, {}});
  fixture.Submit("new");
  ASSERT_EQ(fixture.core.Jobs().size(), 2u);
  EXPECT_EQ(fixture.core.Jobs()[0].id(), "old");
}

TEST(CoreSaving, SaveNowDoesNotWaitForTheInterval) {
  CoreFixture fixture;
  Begin(fixture, 1);
  EXPECT_TRUE(fixture.core.HasUnsaved());
  fixture.Do(SaveNow{});
  EXPECT_EQ(fixture.All<Persist>().size(), 1u);
  fixture.Do(PersistDone{"a", 2});
  EXPECT_FALSE(fixture.core.HasUnsaved());
}

TEST(CoreSaving, BlobsThatCameWithARefusedJobAreDropped) {
  CoreFixture fixture;
  proto::Job job = TestJob();
  job.clear_stages();
  fixture.Do(SubmitJob{"a", job, {H(1000)}});
  ASSERT_EQ(fixture.All<DropBlobs>().size(), 1u);
}

TEST(CoreSaving, FactsCountHostsTasksAndRounds) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.now_s += 2;
  PlayRound(fixture, 0);
  const proto::StageFacts& facts = fixture.core.FindJob("a")->facts.at(0);
  ASSERT_EQ(facts.rounds_size(), 2);
  EXPECT_EQ(facts.rounds(0).note(), "start");
  EXPECT_EQ(facts.rounds(0).tasks(), 0u);
  EXPECT_EQ(facts.rounds(1).tasks(), 1u);
  EXPECT_DOUBLE_EQ(facts.rounds(1).seconds(), 2.0);
  ASSERT_EQ(facts.hosts_size(), 1);
  EXPECT_EQ(facts.hosts(0), "host-w");
}

}  // namespace
}  // namespace cairn::coordinator
