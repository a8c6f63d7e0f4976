// What clients ask of a service: long, for they ask much of one fixture.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "coordinator/server/rights.h"
#include "coordinator/server/testing/hub_fixture.h"
#include "coordinator/store/store_id.h"
#include "schema/store/blob_file.h"

namespace cairn::coordinator {
namespace {

wire::Message Query(const std::string& job, const std::string& action) {
  wire::Message message;
  message.envelope.mutable_query()->set_job(job);
  message.envelope.mutable_query()->set_action(action);
  return message;
}

// A new store, and one that was made of a backup, gives a number that another job had.
TEST(ServerRequests, AJobIsToldFromAnotherWithItsIdByItsMark) {
  const auto mark_of = [](const std::string& store, std::uint64_t seed) {
    ServerFixture fixture;
    EXPECT_TRUE(WriteStoreId(fixture.temp.path() / "store" / "id", {store, "", false}).ok());
    fixture.Start();
    proto::Job job = fixture.MakeJob();
    job.set_seed(seed);
    EXPECT_TRUE(fixture.Ask(fixture.Submission(job)).ok());
    wire::Message query;
    query.envelope.mutable_query()->set_action("status");
    const wire::Reply list = fixture.Ask(query);
    EXPECT_EQ(list.jobs_size(), 1);
    query.envelope.mutable_query()->set_job(list.jobs(0).id());
    query.envelope.mutable_query()->set_action("logs");
    EXPECT_EQ(fixture.Ask(query).jobs(0).mark(), list.jobs(0).mark());
    return list.jobs(0).mark();
  };
  const std::string one(32, '1'), other(32, '2');
  EXPECT_EQ(mark_of(one, 1), mark_of(one, 1));
  EXPECT_NE(mark_of(one, 1), mark_of(one, 2)) << "another was submitted";
  EXPECT_NE(mark_of(one, 1), mark_of(other, 1)) << "of another time, by other workers";
}

TEST(ServerRequests, HaveNamesWhatIsMissing) {
  ServerFixture fixture;
  fixture.Submit();
  wire::Message have;
  have.envelope.mutable_have()->add_hashes(TextBlob("the log").hash.Binary());
  have.envelope.mutable_have()->add_hashes(TextBlob("another").hash.Binary());
  const wire::Reply reply = fixture.Ask(have);
  EXPECT_TRUE(reply.ok());
  ASSERT_EQ(reply.missing_size(), 1);
  EXPECT_EQ(reply.missing(0), TextBlob("another").hash.Binary());
}

TEST(ServerRequests, HaveOfWhatIsNoHashOrOfTooManyIsRefusedAndNotRepeated) {
  ServerFixture fixture;
  wire::Message empty, many;
  empty.envelope.mutable_have()->add_hashes("");
  for (int i = 0; i <= wire::JobLimits().hashes; ++i)
    many.envelope.mutable_have()->add_hashes(TextBlob("another").hash.Binary());
  for (const wire::Message& have : {empty, many}) {
    const wire::Reply reply = fixture.Ask(have);
    EXPECT_FALSE(reply.ok());
    EXPECT_EQ(reply.missing_size(), 0);
  }
}

TEST(ServerRequests, ASubmittedJobIsDurableWhenItIsAnswered) {
  ServerFixture fixture;
  const wire::Reply reply = fixture.Ask(fixture.Submission(fixture.MakeJob(), true));
  ASSERT_TRUE(reply.ok()) << reply.message();
  EXPECT_EQ(reply.jobs(0).id(), "1-toy");
  EXPECT_EQ(reply.jobs(0).state(), "queued");
  EXPECT_EQ(fixture.folder->CheckpointNumbers("1-toy").size(), 1u);
}

// A file where the job's folder is to be: nothing can be saved, as on a full disk.
TEST(ServerRequests, AJobThatCannotBeSavedIsRefusedAndItsNumberGivenToNobodyElse) {
  ServerFixture fixture;
  std::ofstream(fixture.folder->Checkpoints() / "1-toy") << "in the way";
  const wire::Reply refused = fixture.Ask(fixture.Submission(fixture.MakeJob()));
  EXPECT_FALSE(refused.ok());
  EXPECT_NE(refused.message().find("cannot save: "), std::string::npos) << refused.message();
  EXPECT_NE(refused.message().find(" store/checkpoints/1-toy"), std::string::npos) << refused.message();
  EXPECT_EQ(refused.message().find(fixture.folder->dir().string()), std::string::npos)
      << "where the store lies is not a submitter's to know: " << refused.message();
  EXPECT_TRUE(refused.unable()) << "what was asked was right";
  EXPECT_TRUE(refused.jobs().empty());
  EXPECT_TRUE(fixture.server->core().Jobs().empty());
  EXPECT_EQ(fixture.server->core().held_blobs(), 0u);
  EXPECT_EQ(fixture.Ask(fixture.Submission(fixture.MakeJob())).jobs(0).id(), "2-toy");
  fixture.Start();
  ASSERT_EQ(fixture.server->core().Jobs().size(), 1u);
  EXPECT_EQ(fixture.server->core().Jobs()[0].id(), "2-toy");
}

// Each takes far more memory than what is sent, and time whenever jobs are compared.
TEST(ServerRequests, AJobOfVeryManyOptionsIsRefused) {
  ServerFixture fixture;
  proto::Job job = fixture.MakeJob();
  for (int i = 0; i <= wire::JobLimits().values; ++i)
    (*job.mutable_stages(0)->mutable_options())["o" + std::to_string(i)].set_i(i);
  const wire::Reply refused = fixture.Ask(fixture.Submission(job));
  EXPECT_FALSE(refused.ok());
  EXPECT_NE(refused.message().find("more than 4096 inputs and options"), std::string::npos)
      << refused.message();
}

// A store that is called what users are told instead: the message was searched for ever.
TEST(ServerRequests, AStoreOfARelativeNameIsNamedToUsersAsAnyOther) {
  ServerFixture fixture;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(fixture.temp.path());
  for (const char* name : {"store", "re"}) {
    fixture.store_dir = name;
    fixture.Start();
    std::ofstream(fixture.folder->Checkpoints() / "1-toy") << "in the way";
    const wire::Reply refused = fixture.Ask(fixture.Submission(fixture.MakeJob()));
    EXPECT_FALSE(refused.ok());
    EXPECT_NE(refused.message().find("store/checkpoints/1-toy"), std::string::npos) << refused.message();
  }
  std::filesystem::current_path(before);
}

TEST(ServerRequests, ACommandThatCannotBeSavedIsRefusedAndAfterARestartNothingOfItIsThere) {
  ServerFixture fixture;
  EXPECT_EQ(fixture.Ask(fixture.Submission(fixture.MakeJob(), true)).jobs(0).id(), "1-toy");
  const std::filesystem::path checkpoints = fixture.folder->Checkpoints() / "1-toy",
                              away = fixture.temp.path() / "away";
  const auto refused = [&](const std::string& action) {
    std::filesystem::rename(checkpoints, away);
    std::ofstream(checkpoints) << "in the way";
    const wire::Reply reply = fixture.Ask(Query("1-toy", action));
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
  fixture.Start();
  EXPECT_EQ(fixture.State("1-toy"), "queued");
  EXPECT_TRUE(fixture.Ask(Query("1-toy", "cancel")).ok());
}

// It is handed out as the last round left it, over a restart too, until there is a result in its place.
TEST(ServerRequests, WhatThereIsToSeeOfAJobThatRunsIsHandedOut) {
  ServerFixture fixture;
  EXPECT_EQ(fixture.Ask(fixture.Submission(fixture.MakeJob(), true)).jobs(0).id(), "1-toy");
  EXPECT_TRUE(fixture.Ask(Query("1-toy", "so_far")).names().empty()) << "nothing was planned yet";
  fixture.transport.swallow = [](const wire::Assign& assign) {
    return assign.key().round() == 1 && assign.key().kind() == wire::TaskKey::RUN;
  };
  fixture.transport.ComeWorker("w");
  fixture.Until([&] { return fixture.server->core().Find("1-toy")->round() == 1; });
  const auto expect_map = [&] {
    const wire::Reply reply = fixture.Ask(Query("1-toy", "so_far"));
    ASSERT_EQ(reply.names_size(), 1);
    EXPECT_EQ(reply.names(0), "stage0");
    ASSERT_EQ(fixture.last_blobs.size(), 1u);
    EXPECT_EQ(fixture.last_blobs[0].blob->Text("text"), "a map of round 0");
    EXPECT_EQ(reply.jobs(0).so_far(), fixture.last_blobs[0].hash.Binary());
    EXPECT_EQ(reply.jobs(0).hash(), HashOfJob(fixture.MakeJob()).Binary());
  };
  expect_map();
  EXPECT_TRUE(fixture.Ask(Query("1-toy", "pause")).ok());
  fixture.Start();
  expect_map();
  fixture.transport.swallow = [](const wire::Assign&) { return false; };
  fixture.transport.ComeWorker("w");
  EXPECT_TRUE(fixture.Ask(Query("1-toy", "resume")).ok());
  fixture.Until([&] { return fixture.State("1-toy") == "done"; });
  const wire::Reply over = fixture.Ask(Query("1-toy", "so_far"));
  EXPECT_TRUE(over.names().empty());
  EXPECT_TRUE(over.jobs(0).so_far().empty());
}

TEST(ServerRequests, AJobsInputsAreHandedOutUntilItIsDone) {
  ServerFixture fixture;
  EXPECT_EQ(fixture.Ask(fixture.Submission(fixture.MakeJob(), true)).jobs(0).id(), "1-toy");
  const wire::Reply reply = fixture.Ask(Query("1-toy", "inputs"));
  ASSERT_EQ(reply.names_size(), 1);
  EXPECT_EQ(reply.names(0), "log");
  EXPECT_EQ(fixture.last_blobs.at(0).blob->Text("text"), "the log");
  fixture.transport.ComeWorker("w");
  fixture.Until([&] { return fixture.State("1-toy") == "done"; });
  EXPECT_TRUE(fixture.Ask(Query("1-toy", "inputs")).names().empty());
}

TEST(ServerRequests, ADeletionThatFailsIsRefusedAndTheJobStays) {
  ServerFixture fixture;
  EXPECT_EQ(fixture.Ask(fixture.Submission(fixture.MakeJob(), true)).jobs(0).id(), "1-toy");
  EXPECT_TRUE(fixture.Ask(Query("1-toy", "cancel")).ok());
  const std::filesystem::path gone = fixture.folder->Checkpoints() / "1-toy.deleted";
  std::ofstream(gone) << "in the way";
  const wire::Reply refused = fixture.Ask(Query("1-toy", "delete"));
  EXPECT_FALSE(refused.ok());
  EXPECT_NE(refused.message().find("cannot delete 1-toy: "), std::string::npos) << refused.message();
  EXPECT_EQ(fixture.State("1-toy"), "cancelled");
  std::filesystem::remove(gone);
  EXPECT_EQ(fixture.Ask(Query("1-toy", "delete")).jobs(0).state(), "deleted");
}

TEST(ServerRequests, AStartThatWasCutOffBeforeAJobsFirstCheckpointSpeaksOfNoLostJob) {
  ServerFixture fixture;
  fixture.server.reset();
  std::filesystem::create_directory(fixture.folder->Checkpoints() / "1-toy");
  fixture.Start();
  EXPECT_FALSE(fixture.Logged("lost"));
  EXPECT_TRUE(std::filesystem::is_empty(fixture.folder->Checkpoints()));
}

TEST(ServerRequests, TheSameJobTwiceIsOneAndAnotherIsAnother) {
  ServerFixture fixture;
  EXPECT_EQ(fixture.Ask(fixture.Submission(fixture.MakeJob(), true)).jobs(0).id(), "1-toy");
  EXPECT_EQ(fixture.Ask(fixture.Submission(fixture.MakeJob(), false)).jobs(0).id(), "1-toy");
  EXPECT_EQ(fixture.Ask(fixture.Submission(fixture.MakeJob(2), false)).jobs(0).id(), "2-toy");
}

TEST(ServerRequests, WhatIsDoneIsKnownWhenItIsSubmittedAgainAndWhatWasCancelledIsNot) {
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  EXPECT_FALSE(fixture.Ask(fixture.Submission(fixture.MakeJob(), true)).known());
  fixture.Until([&] { return fixture.State("1-toy") == "done"; });
  const wire::Reply again = fixture.Ask(fixture.Submission(fixture.MakeJob(), false));
  EXPECT_TRUE(again.ok()) << "its inputs need not be sent: " << again.message();
  EXPECT_TRUE(again.known());
  EXPECT_EQ(again.jobs(0).id(), "1-toy");
  EXPECT_EQ(again.jobs(0).state(), "done");
  proto::Job other = fixture.MakeJob();
  other.set_seed(8);
  EXPECT_EQ(fixture.Ask(fixture.Submission(other, true)).jobs(0).id(), "2-toy");
  fixture.transport.swallow = [](const wire::Assign&) { return true; };
  other.set_seed(9);
  EXPECT_EQ(fixture.Ask(fixture.Submission(other, true)).jobs(0).id(), "3-toy");
  EXPECT_TRUE(fixture.Ask(Query("3-toy", "cancel")).ok());
  const wire::Reply anew = fixture.Ask(fixture.Submission(other, true));
  EXPECT_EQ(anew.jobs(0).id(), "4-toy");
  EXPECT_FALSE(anew.known());
}

TEST(ServerRequests, ASubmissionWithoutItsInputsOrWithABadChainIsRefused) {
  ServerFixture fixture;
  const wire::Reply without = fixture.Ask(fixture.Submission(fixture.MakeJob(), false));
  EXPECT_NE(without.message().find("'log' is missing"), std::string::npos);
  EXPECT_EQ(without.missing_size(), 1) << "by which a client knows that it may send it";
  proto::Job job = fixture.MakeJob();
  job.mutable_stages(0)->set_name("../../etc");
  const wire::Reply reply = fixture.Ask(fixture.Submission(job, true));
  EXPECT_FALSE(reply.ok());
  EXPECT_FALSE(reply.unable());
  EXPECT_TRUE(fixture.server->core().Jobs().empty());
}

TEST(ServerRequests, ResultsComeWithTheirNamesAndProvenance) {
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  fixture.Submit("a", 2);
  fixture.Until([&] { return fixture.State() == "done"; });
  const wire::Reply reply = fixture.Ask(Query("a", "results"));
  ASSERT_EQ(reply.names_size(), 2);
  EXPECT_EQ(reply.names(1), "stage1");
  ASSERT_EQ(fixture.last_blobs.size(), 2u);
  EXPECT_EQ(fixture.last_blobs[1].blob->Text("provenance/kind"), "result");
}

TEST(ServerRequests, AResultThatIsGoneOrAnotherJobsIsNamedAndNotHandedOut) {
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  fixture.Submit("a", 2);
  fixture.Until([&] { return fixture.State() == "done"; });
  const std::filesystem::path results = fixture.temp.path() / "results/a";
  std::filesystem::remove(results / "stage1.h5");
  const wire::Reply gone = fixture.Ask(Query("a", "results"));
  EXPECT_EQ(gone.names_size(), 1);
  EXPECT_NE(gone.message().find("the stage 'stage1': "), std::string::npos) << gone.message();
  EXPECT_NE(gone.message().find("is not there any more"), std::string::npos) << gone.message();

  const BlobFile first = ReadStoredFile(results / "stage0.h5").value();
  Blob other = first.blob;
  other.Put("text", Array::Text("another"));
  ASSERT_TRUE(WriteBlobFile((results / "stage1.h5").string(), first.kind, other).ok());
  const wire::Reply swapped = fixture.Ask(Query("a", "results"));
  EXPECT_EQ(swapped.names_size(), 1);
  EXPECT_NE(swapped.message().find("is another result than this job made"), std::string::npos)
      << swapped.message();
}

TEST(ServerRequests, StatusListCancelAndResume) {
  ServerFixture fixture;
  fixture.Submit("a");
  fixture.Submit("b", 2);
  EXPECT_EQ(fixture.Ask(Query("", "")).jobs_size(), 2);
  EXPECT_EQ(fixture.Ask(Query("b", "status")).jobs(0).stages(), 2u);
  EXPECT_EQ(fixture.Ask(Query("a", "cancel")).jobs(0).state(), "cancelled");
  EXPECT_EQ(fixture.Ask(Query("a", "resume")).message(), "cannot resume a: it was cancelled");
  EXPECT_EQ(fixture.Ask(Query("a", "priority")).message(),
            "cannot change the priority of a: it was cancelled");
}

TEST(ServerRequests, ACommandIsDurableWhenItIsAnswered) {
  ServerFixture fixture;
  fixture.Submit("a");
  fixture.Submit("b", 2);
  EXPECT_EQ(fixture.Ask(Query("a", "pause")).jobs(0).state(), "paused");
  EXPECT_EQ(fixture.Ask(Query("b", "cancel")).jobs(0).state(), "cancelled");
  wire::Message priority = Query("a", "priority");
  priority.envelope.mutable_query()->set_priority(3);
  EXPECT_EQ(fixture.Ask(priority).jobs(0).priority(), 3);
  const std::filesystem::path before = fixture.temp.path() / "before";
  std::filesystem::copy(fixture.folder->Checkpoints(), before, std::filesystem::copy_options::recursive);
  fixture.server.reset();
  std::filesystem::remove_all(fixture.folder->Checkpoints());  // as if it had died right after its answers
  std::filesystem::copy(before, fixture.folder->Checkpoints(), std::filesystem::copy_options::recursive);
  fixture.Start();
  EXPECT_EQ(fixture.State("a"), "paused");
  EXPECT_EQ(fixture.server->core().Find("a")->reason(), "paused by its owner");
  EXPECT_EQ(fixture.server->core().Find("a")->priority(), 3);
  EXPECT_EQ(fixture.State("b"), "cancelled");
  EXPECT_EQ(fixture.Ask(Query("a", "resume")).jobs(0).state(), "queued");
}

TEST(ServerRequests, ACancelledJobLeavesItsRecordAloneAndADeletedOneNothing) {
  ServerFixture fixture;
  fixture.transport.swallow = [](const wire::Assign& assign) { return assign.key().stage() == 1; };
  fixture.transport.ComeWorker("w");
  fixture.Submit("a", 2);
  fixture.Until([&] {
    return fixture.server->core().FindJob("a")->stage == 1 && !fixture.server->core().HasUnsaved();
  });
  const std::filesystem::path results = fixture.temp.path() / "results/a";
  ASSERT_TRUE(std::filesystem::exists(results / "stage0.h5"));
  EXPECT_EQ(fixture.Ask(Query("a", "delete")).message(),
            "cannot delete a: it has not ended; cancel it first");
  EXPECT_TRUE(fixture.Ask(Query("a", "cancel")).ok());
  EXPECT_EQ(fixture.folder->CheckpointNumbers("a").size(), 1u);
  EXPECT_TRUE(std::filesystem::exists(results / "stage0.h5"));
  EXPECT_EQ(fixture.Ask(Query("a", "delete")).jobs(0).state(), "deleted");
  EXPECT_TRUE(std::filesystem::is_empty(fixture.folder->Checkpoints()));
  EXPECT_FALSE(std::filesystem::exists(results));
  EXPECT_TRUE(fixture.Ask(Query("", "status")).jobs().empty());
  fixture.server.reset();
  EXPECT_TRUE(std::filesystem::is_empty(fixture.folder->Blobs()));
  EXPECT_TRUE(JobTable::Open(fixture.folder->JobTable()).value().ReadLog("a", 0).value().empty());
  fixture.Start();
  EXPECT_TRUE(fixture.server->core().Jobs().empty());
}

TEST(ServerRequests, ANumberIsNeverGivenToASecondJob) {
  ServerFixture fixture;
  const auto submitted = [&fixture] {
    return fixture.Ask(fixture.Submission(fixture.MakeJob())).jobs(0).id();
  };
  const auto forget = [&fixture](const std::string& id) {
    EXPECT_TRUE(fixture.Ask(Query(id, "cancel")).ok());
    EXPECT_EQ(fixture.Ask(Query(id, "delete")).jobs(0).state(), "deleted");
  };
  EXPECT_EQ(submitted(), "1-toy");
  forget("1-toy");
  EXPECT_EQ(submitted(), "2-toy") << "in the same process";
  forget("2-toy");
  fixture.Start();
  EXPECT_EQ(submitted(), "3-toy") << "after a restart too";
}

TEST(ServerRequests, ADeletionThatWasCutOffIsFinishedByTheNextStart) {
  ServerFixture fixture;
  fixture.Submit("a");
  EXPECT_TRUE(fixture.Ask(Query("a", "cancel")).ok());
  fixture.server.reset();
  std::filesystem::create_directories(fixture.temp.path() / "results/a");
  std::filesystem::rename(fixture.folder->Checkpoints() / "a", fixture.folder->Checkpoints() / "a.deleted");
  fixture.Start();
  EXPECT_TRUE(fixture.server->core().Jobs().empty());
  EXPECT_TRUE(std::filesystem::is_empty(fixture.folder->Checkpoints()));
  EXPECT_FALSE(std::filesystem::exists(fixture.temp.path() / "results/a"));
}

// A service's results may lie on another disk; whoever hands on a store may say that they lie anywhere.
TEST(ServerRequests, BehindALinkADeletionRemovesWhatTheJobPublishedAndNothingElse) {
  namespace fs = std::filesystem;
  ServerFixture fixture;
  const fs::path results = fixture.temp.path() / "results", home = fixture.temp.path() / "home";
  fs::create_directories(home / "thesis");
  fs::create_directory_symlink(home, results);
  std::ofstream(home / "thesis" / "text.txt") << "mine";
  fixture.transport.ComeWorker("w");
  fixture.Submit("a");
  fixture.Submit("b");
  fixture.Until([&] { return fixture.State("a") == "done" && fixture.State("b") == "done"; });
  ASSERT_TRUE(fs::exists(home / "a" / "stage0.h5"));
  proto::Job other = fixture.MakeJob();
  other.set_seed(7);
  fixture.server->Submit("c", other, {TextBlob("the log")});
  fixture.Until([&] { return fixture.State("c") == "done"; });
  fs::copy_file(home / "c" / "stage0.h5", home / "thesis" / "stage0.h5");
  std::ofstream(home / "b" / "notes.txt") << "mine";
  for (const char* job : {"a", "b"}) EXPECT_EQ(fixture.Ask(Query(job, "delete")).jobs(0).state(), "deleted");
  EXPECT_FALSE(fs::exists(home / "a"));
  EXPECT_FALSE(fs::exists(home / "b" / "stage0.h5"));
  EXPECT_TRUE(fs::exists(home / "b" / "notes.txt"));
  fixture.server.reset();
  fs::create_directory(fixture.folder->Checkpoints() / "thesis.deleted");
  fs::copy(fixture.folder->Checkpoints() / "c", fixture.folder->Checkpoints() / "thesis.deleted");
  fixture.Start();
  EXPECT_TRUE(fs::exists(home / "thesis" / "text.txt"));
  EXPECT_TRUE(fs::exists(home / "thesis" / "stage0.h5")) << "of the job c";
  EXPECT_FALSE(fs::exists(fixture.folder->Checkpoints() / "thesis.deleted"));
}

TEST(ServerRequests, EveryRequestHasOneRightThatItNeeds) {
  const auto* body = wire::Envelope::descriptor()->FindOneofByName("body");
  std::set<std::string> without;
  for (int i = 0; i < body->field_count(); ++i) {
    wire::Envelope envelope;
    envelope.GetReflection()->MutableMessage(&envelope, body->field(i));
    if (!RightNeeded(envelope)) without.insert(body->field(i)->name());
  }
  EXPECT_EQ(without, (std::set<std::string>{"welcome", "refuse", "assign", "cancel", "blob", "missing",
                                            "unknown_worker", "reply", "credit"}))
      << "what only a coordinator says";
  const auto right = [](const std::string& action) { return RightNeeded(Query("a", action).envelope); };
  EXPECT_EQ(right("status"), Right::kView);
  EXPECT_EQ(right("delete"), Right::kSubmit);
  EXPECT_EQ(right("explode"), std::nullopt);
}

TEST(ServerRequests, WorkersSayWhatEachRunsAndForHowLong) {
  ServerFixture fixture;
  fixture.transport.swallow = [](const wire::Assign&) { return true; };
  fixture.transport.ComeWorker("w", "", 12);
  fixture.transport.ComeWorker("v", "", 13);
  fixture.Submit();
  fixture.Until([&] { return fixture.transport.assigned == 1; });
  const auto ask = [&fixture](std::uint64_t number, const std::string& action) {
    wire::Message message;
    message.envelope.mutable_workers()->set_worker(number);
    message.envelope.mutable_workers()->set_action(action);
    return fixture.Ask(std::move(message));
  };
  const wire::Reply all = ask(0, "");
  ASSERT_EQ(all.fleet_size(), 2);
  EXPECT_EQ(all.fleet(0).number(), 1u);
  EXPECT_EQ(all.fleet(0).pid(), 12);
  EXPECT_EQ(all.fleet(0).state(), "busy");
  EXPECT_EQ(all.fleet(0).assigned(), 1u);
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

TEST(ServerRequests, WhatMakesNoSenseIsRefusedWithTheReason) {
  ServerFixture fixture;
  EXPECT_NE(fixture.Ask(Query("nobody", "status")).message().find("'nobody'"), std::string::npos);
  EXPECT_NE(fixture.Ask(Query("", "cancel")).message().find("which job"), std::string::npos);
  EXPECT_NE(fixture.Ask(Query("", "explode")).message().find("'explode'"), std::string::npos);
}

TEST(ServerRequests, NumbersOfJobsAreNotUsedAgainAfterARestart) {
  ServerFixture fixture;
  EXPECT_EQ(fixture.Ask(fixture.Submission(fixture.MakeJob(), true)).jobs(0).id(), "1-toy");
  fixture.Start();
  EXPECT_EQ(fixture.Ask(fixture.Submission(fixture.MakeJob(2), true)).jobs(0).id(), "2-toy");
}

std::size_t AnswersTo(const ServerFixture& fixture, const std::string& peer) {
  return static_cast<std::size_t>(
      std::ranges::count(fixture.transport.sent, peer, &std::pair<std::string, wire::Message>::first));
}

// What waits for the writer is kept in memory, and what has to be written waits behind it.
TEST(ServerRequests, OneQuestionOfAPeerIsWithTheWriterAtATime) {
  ServerFixture fixture;
  fixture.Submit();
  for (int i = 0; i < 100; ++i) fixture.transport.Come("viewer", Query("a", "logs"));
  for (int i = 0; i < 100; ++i) fixture.transport.Come("v" + std::to_string(i), Query("a", "logs"));
  fixture.server->Step(0);
  std::size_t busy = 0;
  for (const auto& [peer, message] : fixture.transport.sent)
    busy += message.envelope.reply().message() == "the service is busy with what others ask; ask again";
  EXPECT_EQ(busy, 100U + 1 - 64);
  fixture.Until([&] { return AnswersTo(fixture, "viewer") == 1; });
  fixture.Until([&] { return AnswersTo(fixture, "v0") == 1; });
  fixture.transport.Come("viewer", Query("a", "logs"));
  fixture.Until([&] { return AnswersTo(fixture, "viewer") == 2; });
}

TEST(ServerRequests, ResultsAreNotReadForWhoHasNotReadTheOnesBefore) {
  ServerFixture fixture;
  fixture.transport.ComeWorker("w");
  fixture.Submit();
  fixture.Until([&] { return fixture.State() == "done"; });
  fixture.transport.unsent["viewer"] = 1;
  fixture.transport.Come("viewer", Query("a", "results"));
  fixture.server->Step(0);
  EXPECT_EQ(AnswersTo(fixture, "viewer"), 0U);
  fixture.transport.unsent.clear();
  fixture.transport.Come("viewer", Query("a", "results"));
  fixture.Until([&] { return AnswersTo(fixture, "viewer") == 1; });
  EXPECT_EQ(fixture.transport.sent.back().second.blobs.size(), 1U);
}

TEST(ServerRequests, LongNamesAreNotRepeatedWhole) {
  ServerFixture fixture;
  for (const wire::Message& query :
       {Query(std::string(1 << 20, 'x'), "logs"), Query("a", std::string(1 << 20, 'x'))})
    EXPECT_LT(fixture.Ask(query).message().size(), 1000U);
}

}  // namespace
}  // namespace cairn::coordinator
