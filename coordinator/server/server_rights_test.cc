// Who may say what to a service that has keys, and what comes of it where he may not.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "coordinator/server/testing/rights_fixture.h"
#include "schema/wire/keys.h"

namespace cairn::coordinator {
namespace {

using wire::RefusalKind;

class Rights : public RightsFixture {};

// Every kind of message, so that a new one is refused to all until the table knows it.
TEST_F(Rights, TheTableCoversEveryKindOfMessage) {
  int known = 0;
  const google::protobuf::Descriptor* type = wire::Envelope::descriptor();
  for (int i = 0; i < type->field_count(); ++i) {
    wire::Envelope envelope;
    envelope.GetReflection()->MutableMessage(&envelope, type->field(i));
    const std::string name = type->field(i)->name();
    for (const char* ours :
         {"welcome", "refuse", "assign", "cancel", "blob", "missing", "unknown_worker", "reply", "credit"})
      if (name == ours) {
        EXPECT_FALSE(RightNeeded(envelope)) << name;
      }
    if (RightNeeded(envelope)) ++known;
  }
  EXPECT_GE(known, 11);
  EXPECT_EQ(RightNeeded(Query("status").envelope), Right::kView);
  EXPECT_EQ(RightNeeded(Query("results").envelope), Right::kView);
  EXPECT_EQ(RightNeeded(Query("so_far").envelope), Right::kView);
  EXPECT_EQ(RightNeeded(Query("inputs").envelope), Right::kSubmit);
  for (const char* changes : {"cancel", "resume"})
    EXPECT_EQ(RightNeeded(Query(changes).envelope), Right::kSubmit) << changes;
}

TEST_F(Rights, EachRoleMayDoItsOwnAndNothingElse) {
  fixture_.Submit();
  wire::Message have, done, fetch;
  have.envelope.mutable_have();
  done.envelope.mutable_done();
  fetch.envelope.mutable_fetch()->set_hash(TextBlob("the log").hash.Binary());
  for (const std::string& user : {submitter_, viewer_}) {
    for (const wire::Message& work : {done, fetch}) ExpectRefused(user, work, RefusalKind::kRight);
    EXPECT_TRUE(Ask(user, Query("status")).reply().ok());
  }
  for (const std::string& user : {worker_, viewer_}) {
    for (const wire::Message& change : {have, Submission(), Query("cancel"), Query("resume")})
      ExpectRefused(user, change, RefusalKind::kRight);
  }
  ExpectRefused(worker_, Query("status"), RefusalKind::kRight);
  EXPECT_EQ(fixture_.State(), "queued");
  Allow(submitter_ + " admin\n");
  EXPECT_EQ(Ask(submitter_, Query("cancel")).reply().jobs(0).state(), "cancelled");
}

TEST_F(Rights, ARevokedWorkerLosesItsTasksAtOnceAndItsNextMessageIsRefused) {
  fixture_.transport.swallow = [](const wire::Assign&) { return true; };
  Join("w", worker_, 1);
  fixture_.Submit();
  fixture_.Until([&] { return fixture_.transport.assigned > 0; });
  Allow(other_ + " worker\n");
  fixture_.Until([&] { return !Connected("w"); });
  EXPECT_EQ(Count(RefusalKind::kRevoked), 1u);
  fixture_.transport.swallow = [](const wire::Assign&) { return false; };
  wire::Message heartbeat;
  heartbeat.envelope.mutable_heartbeat();
  fixture_.transport.Come("w", heartbeat, worker_);
  fixture_.Until([&] { return Count(RefusalKind::kRevoked) == 2; });
  EXPECT_TRUE(fixture_.transport.dropped.contains("w"));
  EXPECT_TRUE(fixture_.server->core().Find("a")->reason().empty()) << "nobody is blamed";
  Join("v", other_, 2);
  fixture_.Until([&] { return fixture_.State() == "done"; });
}

// The very message that comes next, with no tick and no pause in between.
TEST_F(Rights, AClientsNextMessageAfterItsKeyIsRevokedIsRefused) {
  fixture_.Submit();
  ASSERT_TRUE(Ask(submitter_, Query("status")).reply().ok());
  Allow(viewer_ + " viewer\n");
  ExpectRefused(submitter_, Query("cancel"), RefusalKind::kRevoked);
  EXPECT_EQ(fixture_.State(), "queued");
  // A role that is taken away counts as soon.
  Allow(submitter_ + " viewer\n");
  ExpectRefused(submitter_, Query("cancel"), RefusalKind::kRight);
  EXPECT_TRUE(Ask(submitter_, Query("status")).reply().ok());
}

TEST_F(Rights, AListThatCouldNeverBeReadLetsNobodyIn) {
  Allow("rubbish\n");
  fixture_.Start();
  ExpectRefused(submitter_, Query("status", ""), RefusalKind::kRevoked);
}

// A typo, an editor or a copy over it must not end a fleet.
TEST_F(Rights, WhileTheListCannotBeReadNobodyLosesAnythingAndTheStatusSaysSo) {
  fixture_.transport.swallow = [](const wire::Assign&) { return true; };
  Join("w", worker_, 1);
  fixture_.Submit();
  fixture_.Until([&] { return fixture_.transport.assigned > 0; });
  const std::filesystem::path list = fixture_.temp.path() / "allowed";
  std::ofstream(list, std::ios::trunc).close();  // as a copy begins
  const wire::Reply reply = Ask(viewer_, Query("status", "")).reply();
  EXPECT_NE(reply.warning().find("the last good one holds"), std::string::npos) << reply.warning();
  EXPECT_TRUE(fixture_.Logged("the last good one holds"));
  EXPECT_TRUE(Connected("w"));
  EXPECT_EQ(Count(RefusalKind::kRevoked), 0u);
  std::ofstream(list, std::ios::trunc) << viewer_ << " viewer\n" << other_ << " wor";  // half of it
  Ask(viewer_, Query("status", ""));
  EXPECT_TRUE(Connected("w"));
  std::ofstream(list, std::ios::trunc) << viewer_ << " viewer\nend\n";  // all of it
  EXPECT_EQ(Ask(viewer_, Query("status", "")).reply().warning(), "");
  EXPECT_FALSE(Connected("w"));
  EXPECT_EQ(Count(RefusalKind::kRevoked), 1u);
}

TEST_F(Rights, AnotherKeyMayNotUseAWorkersConnectionOrClaimToBeIt) {
  fixture_.transport.swallow = [](const wire::Assign&) { return true; };
  Join("w", worker_, 1);
  fixture_.Submit();
  fixture_.Until([&] { return fixture_.transport.assigned > 0; });
  wire::Message done;
  done.envelope.mutable_done();
  fixture_.transport.Come("w", done, other_);
  fixture_.Until([&] { return Count(RefusalKind::kIdentity) == 1; });
  Join("x", other_, 1);  // the same process
  fixture_.Until([&] { return Count(RefusalKind::kIdentity) == 2; });
  EXPECT_FALSE(Connected("x"));
  EXPECT_TRUE(Connected("w"));
  Join("x", other_, 2);
  fixture_.Until([&] { return Connected("x"); });
}

TEST_F(Rights, ABlobThatIsNotOfItsTasksIsNotServed) {
  fixture_.transport.swallow = [](const wire::Assign&) { return true; };
  Join("w", worker_, 1);
  fixture_.Submit();
  fixture_.Until([&] { return fixture_.transport.assigned > 0; });
  Join("x", other_, 2);
  wire::Message fetch;
  fetch.envelope.mutable_fetch()->set_hash(TextBlob("the log").hash.Binary());
  const auto answered = [&](const std::string& peer) {
    return std::any_of(fixture_.transport.sent.begin(), fixture_.transport.sent.end(), [&](const auto& s) {
      return s.first == peer && (s.second.envelope.has_blob() || s.second.envelope.has_missing());
    });
  };
  fixture_.transport.Come("x", fetch, other_);
  fixture_.Until([&] { return answered("x"); });
  EXPECT_TRUE(fixture_.transport.sent.back().second.envelope.has_missing());
  EXPECT_EQ(Count(RefusalKind::kTask), 1u);
  wire::Message part = fetch;  // nor is a part of it
  part.envelope.mutable_fetch()->mutable_part()->set_but("none");
  fixture_.transport.sent.clear();
  fixture_.transport.Come("x", part, other_);
  fixture_.Until([&] { return answered("x"); });
  EXPECT_TRUE(fixture_.transport.sent.back().second.envelope.has_missing());
  EXPECT_EQ(Count(RefusalKind::kTask), 2u);
  fixture_.transport.Come("w", fetch, worker_);
  fixture_.Until([&] { return answered("w"); });
  EXPECT_TRUE(fixture_.transport.sent.back().second.envelope.has_blob());
  EXPECT_EQ(Count(RefusalKind::kTask), 2u);
}

TEST_F(Rights, AnAnswerToAnothersTaskWritesNothing) {
  std::optional<wire::TaskKey> key;
  fixture_.transport.swallow = [&](const wire::Assign& assign) {
    key = assign.key();
    return true;
  };
  Join("w", worker_, 1);
  fixture_.Submit();
  fixture_.Until([&] { return key.has_value(); });
  Join("x", other_, 2);
  fixture_.Until([&] { return Connected("x"); });
  wire::Message done;
  *done.envelope.mutable_done()->mutable_key() = *key;
  done.blobs = {TextBlob("a lie")};
  done.envelope.mutable_done()->mutable_step()->set_result(done.blobs[0].hash.Binary());
  fixture_.transport.Come("x", done, other_);
  fixture_.Until([&] { return Count(RefusalKind::kTask) == 1; });
  EXPECT_FALSE(fixture_.server->core().Holds(done.blobs[0].hash));
  EXPECT_EQ(fixture_.State(), "queued");
}

TEST_F(Rights, ASubmissionThatIsTooLargeOrOfAnotherProtocolIsRefused) {
  const auto refused = [this](const std::function<void(wire::Message&)>& change, RefusalKind kind) {
    wire::Message message = Submission();
    change(message);
    const std::uint64_t before = Count(kind);
    const wire::Envelope answer = Ask(submitter_, message);
    EXPECT_FALSE(answer.reply().ok()) << answer.ShortDebugString();
    EXPECT_FALSE(answer.reply().message().empty());
    EXPECT_EQ(Count(kind), before + 1) << answer.reply().message();
  };
  const auto job = [](wire::Message& m) { return m.envelope.mutable_submit()->mutable_job(); };
  refused([](wire::Message& m) { m.envelope.mutable_submit()->set_protocol(1); }, RefusalKind::kVersion);
  refused([&](wire::Message& m) { job(m)->set_name(std::string(5000, 'x')); }, RefusalKind::kJob);
  refused([&](wire::Message& m) { job(m)->set_name("\x1b[2J"); }, RefusalKind::kJob);
  for (const char* hostile : {"a\nb", "\x1b[2J", "\u009b2J", "a\u202eb", "a\u2028b"}) {
    refused([&](wire::Message& m) { job(m)->set_name(hostile); }, RefusalKind::kJob);
    refused([&](wire::Message& m) { (*job(m)->mutable_stages(0)->mutable_inputs())[hostile] = "log"; },
            RefusalKind::kJob);
  }
  refused([&](wire::Message& m) { (*job(m)->mutable_inputs())["log"] = std::string(2 << 20, 'x'); },
          RefusalKind::kJob);
  refused(
      [&](wire::Message& m) {
        for (int i = 0; i < 200; ++i) *job(m)->add_stages() = job(m)->stages(0);
      },
      RefusalKind::kJob);
  refused([&](wire::Message& m) { job(m)->clear_stages(); }, RefusalKind::kJob);
  for (const char* path : {"..", "../../etc/passwd", "/etc/passwd", "a/b", ".hidden", "", "report.html",
                           "job.yaml", "map.png", "picture.png", "grid.h5"})
    refused([&](wire::Message& m) { job(m)->mutable_stages(0)->set_name(path); }, RefusalKind::kJob);
  refused([&](wire::Message& m) { (*job(m)->mutable_input_blobs())["log"] = "short"; }, RefusalKind::kJob);
  EXPECT_TRUE(fixture_.server->core().Jobs().empty());
  Bring();
  EXPECT_TRUE(Ask(submitter_, Submission()).reply().ok());
}

// A job's name may be anything printable; the file names that come of it stay in the store.
TEST_F(Rights, AJobsNameDoesNotLeadOutOfTheStore) {
  Bring();
  wire::Message message = Submission();
  message.envelope.mutable_submit()->mutable_job()->set_name("../../../tmp/x");
  const wire::Envelope answer = Ask(submitter_, message);
  ASSERT_TRUE(answer.reply().ok()) << answer.reply().message();
  EXPECT_EQ(answer.reply().jobs(0).id().find_first_of("/."), std::string::npos)
      << answer.reply().jobs(0).id();
}

TEST_F(Rights, AnUnknownKindOfMessageIsToldTheVersionAndThenDropped) {
  fixture_.transport.ComeDamaged("future", Code::kVersion);
  fixture_.Until([&] { return !fixture_.transport.sent.empty(); });
  EXPECT_NE(fixture_.transport.sent.back().second.envelope.refuse().reason().find("protocol"),
            std::string::npos);
  EXPECT_FALSE(fixture_.transport.dropped.contains("future"));
  fixture_.transport.ComeDamaged("future", Code::kVersion);
  fixture_.Until([&] { return fixture_.transport.dropped.contains("future"); });
  EXPECT_EQ(Count(RefusalKind::kVersion), 2u);
}

TEST_F(Rights, RefusalsAreCountedByKindAndShownToAViewer) {
  fixture_.transport.door = {{RefusalKind::kKey, "key abc", 7}};
  fixture_.transport.ComeDamaged("x", Code::kRefused);
  ExpectRefused(viewer_, Query("cancel"), RefusalKind::kRight);
  const wire::Reply reply = Ask(viewer_, Query("status", "")).reply();
  EXPECT_EQ(reply.refused().at("key"), 7u);
  EXPECT_EQ(reply.refused().at("oversized"), 1u);
  EXPECT_EQ(reply.refused().at("right"), 1u);
}

TEST(RefusalLog, AFloodIsCountedButNotLoggedLineByLine) {
  std::vector<std::string> lines;
  Refusals refusals([&](Severity, const std::string& line) { lines.push_back(line); });
  for (int i = 0; i < 1000; ++i) refusals.Add({RefusalKind::kKey, "from \x1b[31mx\n"}, 100 + i * 0.001);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].find_first_of("\x1b\n"), std::string::npos);
  refusals.Add({RefusalKind::kKey, "again"}, 200);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_NE(lines[1].find("999 more"), std::string::npos) << lines[1];
  EXPECT_EQ(refusals.count(RefusalKind::kKey), 1001u);
}

TEST(RefusalLog, AWorkersWordsCannotGarbleTheLog) {
  ServerFixture fixture;
  wire::Message hello;
  hello.envelope.mutable_hello()->set_protocol(3);
  hello.envelope.mutable_hello()->set_slots(4'000'000'000u);
  hello.envelope.mutable_hello()->set_host("x\n12:00 error: all is lost\x1b[2J" + std::string(100'000, 'y'));
  fixture.transport.Come("w", hello);
  fixture.Until([&] { return fixture.server->core().fleet().size() == 1; });
  const wire::Hello& kept = fixture.server->core().fleet().workers().begin()->second.hello;
  EXPECT_EQ(kept.host().find_first_of("\n\x1b"), std::string::npos);
  EXPECT_LT(kept.host().size(), 5000u);
  EXPECT_EQ(kept.slots(), 1000u);
  for (const std::string& line : fixture.log) EXPECT_EQ(line.find_first_of("\n\x1b"), std::string::npos);
}

TEST_F(Rights, AWorkerIsCalledAsItsKeyIs) {
  Allow(worker_ + " worker desk\n");
  wire::Message hello;
  hello.envelope.mutable_hello()->set_protocol(3);
  hello.envelope.mutable_hello()->set_slots(2);
  hello.envelope.mutable_hello()->set_name("another's");
  fixture_.transport.Come("w", std::move(hello), worker_);
  fixture_.Until([&] { return Connected("w"); });
  EXPECT_EQ(fixture_.server->core().Workers().at(0).name(), "desk");
}

// Of each change who asked for it, where a job's owner looks; of a job that is gone, in the service's log.
TEST_F(Rights, WhoAskedForAChangeIsInTheLog) {
  Allow(submitter_ + " admin desk\n" + viewer_ + " admin\n");
  fixture_.Submit();
  EXPECT_TRUE(Ask(submitter_, Query("pause")).reply().ok());
  EXPECT_TRUE(Ask(viewer_, Query("cancel")).reply().ok());
  EXPECT_FALSE(Ask(submitter_, Query("resume")).reply().ok());
  const std::string desk = "desk (" + wire::ShortKey(submitter_) + ")", other = wire::ShortKey(viewer_);
  const wire::Envelope answer = Ask(submitter_, Query("logs"));
  std::vector<std::string> lines;
  for (const wire::LogLine& line : answer.reply().log()) lines.push_back(line.text());
  EXPECT_EQ(std::ranges::count(lines, "paused by " + desk), 1);
  EXPECT_EQ(std::ranges::count(lines, "cancelled by " + other), 1);
  EXPECT_EQ(std::ranges::count(lines, "resumed by " + desk), 0) << "that was refused";
  EXPECT_TRUE(Ask(submitter_, Query("delete")).reply().ok());
  EXPECT_EQ(std::ranges::count(fixture_.log, "a: deleted by " + desk), 1);
  wire::Message drain, clean;
  drain.envelope.mutable_workers()->set_action("drain");
  clean.envelope.mutable_clean();
  Ask(submitter_, drain);
  Ask(viewer_, clean);
  EXPECT_EQ(std::ranges::count(fixture_.log, desk + " has all workers drained"), 1);
  EXPECT_EQ(std::ranges::count(fixture_.log, other + " has the store cleaned"), 1);
}

}  // namespace
}  // namespace cairn::coordinator
