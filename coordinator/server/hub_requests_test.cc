// What clients ask of a service.
#include <gtest/gtest.h>

#include <fstream>

#include "coordinator/server/hub_bench.h"
#include "coordinator/server/rights.h"

namespace cairn::coordinator {
namespace {

wire::Message Query(const std::string& job, const std::string& action) {
  wire::Message message;
  message.envelope.mutable_query()->set_job(job);
  message.envelope.mutable_query()->set_action(action);
  return message;
}

TEST(HubRequests, HaveNamesWhatIsMissing) {
  HubBench bench;
  bench.Submit();
  wire::Message have;
  have.envelope.mutable_have()->add_hashes(TextBlob("the log").hash.Binary());
  have.envelope.mutable_have()->add_hashes(TextBlob("another").hash.Binary());
  const wire::Reply reply = bench.Ask(have);
  EXPECT_TRUE(reply.ok());
  ASSERT_EQ(reply.missing_size(), 1);
  EXPECT_EQ(reply.missing(0), TextBlob("another").hash.Binary());
}

TEST(HubRequests, ASubmittedJobIsDurableWhenItIsAnswered) {
  HubBench bench;
  const wire::Reply reply = bench.Ask(bench.Submission(bench.MakeJob(), true));
  ASSERT_TRUE(reply.ok()) << reply.message();
  EXPECT_EQ(reply.jobs(0).id(), "1-toy");
  EXPECT_EQ(reply.jobs(0).state(), "queued");
  EXPECT_EQ(bench.folder->CheckpointNumbers("1-toy").size(), 1u);
}

// A file where the job's folder is to be: nothing can be saved, as on a full disk.
TEST(HubRequests, AJobThatCannotBeSavedIsRefusedAndItsNumberGivenToNobodyElse) {
  HubBench bench;
  std::ofstream(bench.folder->Checkpoints() / "1-toy") << "in the way";
  const wire::Reply refused = bench.Ask(bench.Submission(bench.MakeJob()));
  EXPECT_FALSE(refused.ok());
  EXPECT_NE(refused.message().find("cannot save: "), std::string::npos) << refused.message();
  EXPECT_NE(refused.message().find(" store/checkpoints/1-toy"), std::string::npos) << refused.message();
  EXPECT_EQ(refused.message().find(bench.folder->dir().string()), std::string::npos)
      << "where the store lies is not a submitter's to know: " << refused.message();
  EXPECT_TRUE(refused.jobs().empty());
  EXPECT_TRUE(bench.hub->core().Jobs().empty());
  EXPECT_EQ(bench.hub->core().held_blobs(), 0u);
  EXPECT_EQ(bench.Ask(bench.Submission(bench.MakeJob())).jobs(0).id(), "2-toy");
  bench.Start();
  ASSERT_EQ(bench.hub->core().Jobs().size(), 1u);
  EXPECT_EQ(bench.hub->core().Jobs()[0].id(), "2-toy");
}

TEST(HubRequests, ACommandThatCannotBeSavedIsRefusedAndAfterARestartNothingOfItIsThere) {
  HubBench bench;
  EXPECT_EQ(bench.Ask(bench.Submission(bench.MakeJob(), true)).jobs(0).id(), "1-toy");
  const std::filesystem::path checkpoints = bench.folder->Checkpoints() / "1-toy",
                              away = bench.temp.path() / "away";
  const auto refused = [&](const std::string& action) {
    std::filesystem::rename(checkpoints, away);
    std::ofstream(checkpoints) << "in the way";
    const wire::Reply reply = bench.Ask(Query("1-toy", action));
    std::filesystem::remove(checkpoints);
    std::filesystem::rename(away, checkpoints);
    return reply;
  };
  for (const char* action : {"pause", "cancel"}) {
    const wire::Reply reply = refused(action);
    EXPECT_FALSE(reply.ok()) << action;
    EXPECT_NE(reply.message().find("1-toy is as it was before"), std::string::npos) << reply.message();
    ASSERT_EQ(reply.jobs_size(), 1);
    EXPECT_EQ(reply.jobs(0).state(), "paused");
  }
  bench.Start();
  EXPECT_EQ(bench.State("1-toy"), "queued");
  EXPECT_TRUE(bench.Ask(Query("1-toy", "cancel")).ok());
}

TEST(HubRequests, ADeletionThatFailsIsRefusedAndTheJobStays) {
  HubBench bench;
  EXPECT_EQ(bench.Ask(bench.Submission(bench.MakeJob(), true)).jobs(0).id(), "1-toy");
  EXPECT_TRUE(bench.Ask(Query("1-toy", "cancel")).ok());
  const std::filesystem::path gone = bench.folder->Checkpoints() / "1-toy.deleted";
  std::ofstream(gone) << "in the way";
  const wire::Reply refused = bench.Ask(Query("1-toy", "delete"));
  EXPECT_FALSE(refused.ok());
  EXPECT_NE(refused.message().find("cannot delete 1-toy: "), std::string::npos) << refused.message();
  EXPECT_EQ(bench.State("1-toy"), "cancelled");
  std::filesystem::remove(gone);
  EXPECT_EQ(bench.Ask(Query("1-toy", "delete")).jobs(0).state(), "deleted");
}

TEST(HubRequests, AStartThatWasCutOffBeforeAJobsFirstCheckpointSpeaksOfNoLostJob) {
  HubBench bench;
  bench.hub.reset();
  std::filesystem::create_directory(bench.folder->Checkpoints() / "1-toy");
  bench.Start();
  EXPECT_FALSE(bench.Logged("lost"));
  EXPECT_TRUE(std::filesystem::is_empty(bench.folder->Checkpoints()));
}

TEST(HubRequests, TheSameJobTwiceIsOneAndAnotherIsAnother) {
  HubBench bench;
  EXPECT_EQ(bench.Ask(bench.Submission(bench.MakeJob(), true)).jobs(0).id(), "1-toy");
  EXPECT_EQ(bench.Ask(bench.Submission(bench.MakeJob(), false)).jobs(0).id(), "1-toy");
  EXPECT_EQ(bench.Ask(bench.Submission(bench.MakeJob(2), false)).jobs(0).id(), "2-toy");
}

TEST(HubRequests, WhatIsDoneIsKnownWhenItIsSubmittedAgainAndWhatWasCancelledIsNot) {
  HubBench bench;
  bench.transport.ComeWorker("w");
  EXPECT_FALSE(bench.Ask(bench.Submission(bench.MakeJob(), true)).known());
  bench.Until([&] { return bench.State("1-toy") == "done"; });
  const wire::Reply again = bench.Ask(bench.Submission(bench.MakeJob(), false));
  EXPECT_TRUE(again.ok()) << "its inputs need not be sent: " << again.message();
  EXPECT_TRUE(again.known());
  EXPECT_EQ(again.jobs(0).id(), "1-toy");
  EXPECT_EQ(again.jobs(0).state(), "done");
  proto::Job other = bench.MakeJob();
  other.set_seed(8);
  EXPECT_EQ(bench.Ask(bench.Submission(other, true)).jobs(0).id(), "2-toy");
  bench.transport.swallow = [](const wire::Assign&) { return true; };
  other.set_seed(9);
  EXPECT_EQ(bench.Ask(bench.Submission(other, true)).jobs(0).id(), "3-toy");
  EXPECT_TRUE(bench.Ask(Query("3-toy", "cancel")).ok());
  const wire::Reply anew = bench.Ask(bench.Submission(other, true));
  EXPECT_EQ(anew.jobs(0).id(), "4-toy");
  EXPECT_FALSE(anew.known());
}

TEST(HubRequests, ASubmissionWithoutItsInputsOrWithABadChainIsRefused) {
  HubBench bench;
  const wire::Reply without = bench.Ask(bench.Submission(bench.MakeJob(), false));
  EXPECT_NE(without.message().find("'log' is missing"), std::string::npos);
  EXPECT_EQ(without.missing_size(), 1) << "by which a client knows that it may send it";
  proto::Job job = bench.MakeJob();
  job.mutable_stages(0)->set_name("../../etc");
  const wire::Reply reply = bench.Ask(bench.Submission(job, true));
  EXPECT_FALSE(reply.ok());
  EXPECT_TRUE(bench.hub->core().Jobs().empty());
}

TEST(HubRequests, ResultsComeWithTheirNamesAndProvenance) {
  HubBench bench;
  bench.transport.ComeWorker("w");
  bench.Submit("a", 2);
  bench.Until([&] { return bench.State() == "done"; });
  const wire::Reply reply = bench.Ask(Query("a", "results"));
  ASSERT_EQ(reply.names_size(), 2);
  EXPECT_EQ(reply.names(1), "stage1");
  ASSERT_EQ(bench.last_blobs.size(), 2u);
  EXPECT_EQ(bench.last_blobs[1].blob->Text("provenance/kind"), "result");
}

TEST(HubRequests, StatusListCancelAndResume) {
  HubBench bench;
  bench.Submit("a");
  bench.Submit("b", 2);
  EXPECT_EQ(bench.Ask(Query("", "")).jobs_size(), 2);
  EXPECT_EQ(bench.Ask(Query("b", "status")).jobs(0).stages(), 2u);
  EXPECT_EQ(bench.Ask(Query("a", "cancel")).jobs(0).state(), "cancelled");
  EXPECT_EQ(bench.Ask(Query("a", "resume")).message(), "cannot resume a: it was cancelled");
}

TEST(HubRequests, ACommandIsDurableWhenItIsAnswered) {
  HubBench bench;
  bench.Submit("a");
  bench.Submit("b", 2);
  EXPECT_EQ(bench.Ask(Query("a", "pause")).jobs(0).state(), "paused");
  EXPECT_EQ(bench.Ask(Query("b", "cancel")).jobs(0).state(), "cancelled");
  wire::Message priority = Query("a", "priority");
  priority.envelope.mutable_query()->set_priority(3);
  EXPECT_EQ(bench.Ask(priority).jobs(0).priority(), 3);
  const std::filesystem::path before = bench.temp.path() / "before";
  std::filesystem::copy(bench.folder->Checkpoints(), before, std::filesystem::copy_options::recursive);
  bench.hub.reset();
  std::filesystem::remove_all(bench.folder->Checkpoints());  // as if it had died right after its answers
  std::filesystem::copy(before, bench.folder->Checkpoints(), std::filesystem::copy_options::recursive);
  bench.Start();
  EXPECT_EQ(bench.State("a"), "paused");
  EXPECT_EQ(bench.hub->core().Find("a")->reason(), "paused by its owner");
  EXPECT_EQ(bench.hub->core().Find("a")->priority(), 3);
  EXPECT_EQ(bench.State("b"), "cancelled");
  EXPECT_EQ(bench.Ask(Query("a", "resume")).jobs(0).state(), "queued");
}

TEST(HubRequests, ACancelledJobLeavesItsRecordAloneAndADeletedOneNothing) {
  HubBench bench;
  bench.transport.swallow = [](const wire::Assign& assign) { return assign.key().stage() == 1; };
  bench.transport.ComeWorker("w");
  bench.Submit("a", 2);
  bench.Until([&] { return bench.hub->core().FindJob("a")->stage == 1 && !bench.hub->core().HasUnsaved(); });
  const std::filesystem::path results = bench.temp.path() / "results/a";
  ASSERT_TRUE(std::filesystem::exists(results / "stage0.h5"));
  EXPECT_EQ(bench.Ask(Query("a", "delete")).message(), "cannot delete a: it has not ended; cancel it first");
  EXPECT_TRUE(bench.Ask(Query("a", "cancel")).ok());
  EXPECT_EQ(bench.folder->CheckpointNumbers("a").size(), 1u);
  EXPECT_TRUE(std::filesystem::exists(results / "stage0.h5"));
  EXPECT_EQ(bench.Ask(Query("a", "delete")).jobs(0).state(), "deleted");
  EXPECT_TRUE(std::filesystem::is_empty(bench.folder->Checkpoints()));
  EXPECT_FALSE(std::filesystem::exists(results));
  EXPECT_TRUE(bench.Ask(Query("", "status")).jobs().empty());
  bench.hub.reset();
  EXPECT_TRUE(std::filesystem::is_empty(bench.folder->Blobs()));
  EXPECT_TRUE(JobTable::Open(bench.folder->JobTable()).value().Read().value().empty());
  bench.Start();
  EXPECT_TRUE(bench.hub->core().Jobs().empty());
}

TEST(HubRequests, ANumberIsNeverGivenToASecondJob) {
  HubBench bench;
  const auto submitted = [&bench] { return bench.Ask(bench.Submission(bench.MakeJob())).jobs(0).id(); };
  const auto forget = [&bench](const std::string& id) {
    EXPECT_TRUE(bench.Ask(Query(id, "cancel")).ok());
    EXPECT_EQ(bench.Ask(Query(id, "delete")).jobs(0).state(), "deleted");
  };
  EXPECT_EQ(submitted(), "1-toy");
  forget("1-toy");
  EXPECT_EQ(submitted(), "2-toy") << "in the same process";
  forget("2-toy");
  bench.Start();
  EXPECT_EQ(submitted(), "3-toy") << "after a restart too";
}

TEST(HubRequests, ADeletionThatWasCutOffIsFinishedByTheNextStart) {
  HubBench bench;
  bench.Submit("a");
  EXPECT_TRUE(bench.Ask(Query("a", "cancel")).ok());
  bench.hub.reset();
  std::filesystem::create_directories(bench.temp.path() / "results/a");
  std::filesystem::rename(bench.folder->Checkpoints() / "a", bench.folder->Checkpoints() / "a.deleted");
  bench.Start();
  EXPECT_TRUE(bench.hub->core().Jobs().empty());
  EXPECT_TRUE(std::filesystem::is_empty(bench.folder->Checkpoints()));
  EXPECT_FALSE(std::filesystem::exists(bench.temp.path() / "results/a"));
}

TEST(HubRequests, EveryRequestHasOneRightThatItNeeds) {
  const auto* body = wire::Envelope::descriptor()->FindOneofByName("body");
  std::set<std::string> without;
  for (int i = 0; i < body->field_count(); ++i) {
    wire::Envelope envelope;
    envelope.GetReflection()->MutableMessage(&envelope, body->field(i));
    if (!RightNeeded(envelope)) without.insert(body->field(i)->name());
  }
  EXPECT_EQ(without, (std::set<std::string>{"welcome", "refuse", "assign", "cancel", "blob", "missing",
                                            "stranger", "reply", "credit"}))
      << "what only a coordinator says";
  const auto right = [](const std::string& action) { return RightNeeded(Query("a", action).envelope); };
  EXPECT_EQ(right("status"), Right::kView);
  EXPECT_EQ(right("delete"), Right::kSubmit);
  EXPECT_EQ(right("explode"), std::nullopt);
}

TEST(HubRequests, WorkersSayWhatEachRunsAndForHowLong) {
  HubBench bench;
  bench.transport.swallow = [](const wire::Assign&) { return true; };
  bench.transport.ComeWorker("w", "", 12);
  bench.transport.ComeWorker("v", "", 13);
  bench.Submit();
  bench.Until([&] { return bench.transport.assigned == 1; });
  const auto ask = [&bench](std::uint64_t number, const std::string& action) {
    wire::Message message;
    message.envelope.mutable_workers()->set_worker(number);
    message.envelope.mutable_workers()->set_action(action);
    return bench.Ask(std::move(message));
  };
  const wire::Reply all = ask(0, "");
  ASSERT_EQ(all.fleet_size(), 2);
  EXPECT_EQ(all.fleet(0).number(), 1u);
  EXPECT_EQ(all.fleet(0).pid(), 12);
  EXPECT_EQ(all.fleet(0).state(), "busy");
  EXPECT_EQ(all.fleet(0).in_hand(), 1u);
  EXPECT_EQ(all.fleet(0).task(), "a: the start of stage 'stage0'");
  EXPECT_EQ(all.fleet(1).state(), "idle");
  EXPECT_EQ(all.fleet(1).task(), "");
  ASSERT_EQ(ask(2, "status").fleet_size(), 1);
  const wire::Reply drained = ask(1, "drain");
  ASSERT_EQ(drained.fleet_size(), 1);
  EXPECT_EQ(drained.fleet(0).state(), "draining");
  EXPECT_EQ(ask(0, "status").fleet(1).state(), "idle");
  EXPECT_EQ(ask(0, "drain").fleet(1).state(), "draining");
  EXPECT_EQ(ask(7, "status").message(), "there is no worker 7; cairn status lists them");
  EXPECT_NE(ask(0, "explode").message().find("'explode'"), std::string::npos);
}

TEST(HubRequests, WhatMakesNoSenseIsRefusedWithTheReason) {
  HubBench bench;
  EXPECT_NE(bench.Ask(Query("nobody", "status")).message().find("'nobody'"), std::string::npos);
  EXPECT_NE(bench.Ask(Query("", "cancel")).message().find("which job"), std::string::npos);
  EXPECT_NE(bench.Ask(Query("", "explode")).message().find("'explode'"), std::string::npos);
}

TEST(HubRequests, NumbersOfJobsAreNotUsedAgainAfterARestart) {
  HubBench bench;
  EXPECT_EQ(bench.Ask(bench.Submission(bench.MakeJob(), true)).jobs(0).id(), "1-toy");
  bench.Start();
  EXPECT_EQ(bench.Ask(bench.Submission(bench.MakeJob(2), true)).jobs(0).id(), "2-toy");
}

}  // namespace
}  // namespace cairn::coordinator
