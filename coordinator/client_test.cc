#include "coordinator/client.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <thread>

#include "coordinator/fake_service_testing.h"
#include "schema/flat_blob_testing.h"
#include "schema/wire/testing/private_folder.h"

namespace cairn::coordinator {
namespace {

BlobPtr Number(double value) {
  Blob blob;
  blob.PutScalar("v", value);
  return std::make_shared<const Blob>(std::move(blob));
}

class ClientTest : public ::testing::Test {
 protected:
  Client Connect(double timeout_s = 30) {
    return Client::Connect({.endpoint = folder_.Ipc("s"), .security = {}, .timeout_s = timeout_s}).value();
  }
  wire::PrivateFolder folder_;
};

// What a service does with uploads: gives `window` bytes of credit at a time, as the bytes come.
struct Uploaded {
  std::uint64_t window = 1 << 20;
  std::string hash, bytes = {};
  std::uint64_t expected = 0, given = 0;
  std::optional<wire::Message> Answer(const wire::Envelope& envelope) {
    if (envelope.has_offer()) {
      hash = envelope.offer().hash();
      expected = envelope.offer().bytes();
      bytes.clear();
      given = 0;
    } else {
      EXPECT_EQ(envelope.piece().hash(), hash);
      EXPECT_EQ(envelope.piece().at(), bytes.size());
      bytes += envelope.piece().data();
      EXPECT_LE(bytes.size(), given) << "it sends more than it may";
      if (bytes.size() == expected) return Ok();
      if (bytes.size() < given) return std::nullopt;
    }
    wire::Message credit;
    credit.envelope.mutable_credit()->set_hash(hash);
    credit.envelope.mutable_credit()->set_bytes(window);
    given += window;
    return credit;
  }
};

wire::Message Lacks(const std::string& hash) {
  wire::Message reply = Ok();
  reply.envelope.mutable_reply()->set_ok(false);
  reply.envelope.mutable_reply()->add_missing(hash);
  return reply;
}

BlobPtr Numbers(std::size_t count) {
  Blob blob;
  blob.PutVector("a/values", std::vector<double>(count, 0.25));
  blob.PutVector("none", std::vector<double>());
  blob.PutVector("z/values", std::vector<double>(count, 4));
  return std::make_shared<const Blob>(std::move(blob));
}

TEST_F(ClientTest, SubmitUploadsOnlyWhatTheServiceLacks) {
  Uploaded uploaded;
  int asked = 0;
  proto::Job sent;
  const std::string lacking = Number(2)->ContentHash().Binary();
  FakeService service(folder_.Ipc("s"), [&](const wire::Message& question) -> std::optional<wire::Message> {
    if (!question.envelope.has_submit()) return uploaded.Answer(question.envelope);
    EXPECT_EQ(question.envelope.submit().protocol(), wire::kProtocol);
    sent = question.envelope.submit().job();
    if (asked++ == 0) return Lacks(lacking);
    wire::Message reply = Ok();
    reply.envelope.mutable_reply()->add_jobs()->set_id("museum-1");
    return reply;
  });
  proto::Job job;
  job.set_name("museum");
  Client client = Connect();
  const Result<wire::JobInfo> info =
      client.Submit(job, {{"log", Number(1)}, {"map", Number(2)}, {"old", Number(1)}});
  ASSERT_TRUE(info.ok()) << info.status().message();
  EXPECT_EQ(info.value().id(), "museum-1");
  EXPECT_EQ(sent.name(), "museum");
  EXPECT_EQ(sent.input_blobs_size(), 3);
  EXPECT_EQ(sent.input_blobs().at("map"), lacking);
  EXPECT_TRUE(uploaded.bytes == flat_testing::Flat(*Number(2)));
}

TEST_F(ClientTest, AnUploadGoesInPiecesAndNoFasterThanItsCredit) {
  for (const std::uint64_t window : {1'000'000, 8 << 20, 12'345}) {
    Uploaded uploaded{window, {}};
    int asked = 0;
    const BlobPtr log = Numbers(window < 100'000 ? 20'000 : 1'000'000);
    FakeService service(folder_.Ipc("s"), [&](const wire::Message& question) -> std::optional<wire::Message> {
      if (!question.envelope.has_submit()) {
        EXPECT_LE(question.envelope.piece().data().size(), 1u << 20);
        return uploaded.Answer(question.envelope);
      }
      if (asked++ == 0) return Lacks(log->ContentHash().Binary());
      wire::Message reply = Ok();
      reply.envelope.mutable_reply()->add_jobs()->set_id("museum-1");
      return reply;
    });
    const auto info = Connect().Submit(proto::Job(), {{"log", log}});
    EXPECT_TRUE(info.ok()) << info.status().message();
    EXPECT_TRUE(uploaded.bytes == flat_testing::Flat(*log)) << window;
  }
}

// A service that is started again in the middle, or gives an upload up, has all of it in the end.
TEST_F(ClientTest, AnUploadThatIsCutOffBeginsAgain) {
  Uploaded uploaded;
  const BlobPtr log = Numbers(500'000);
  int asked = 0, pieces = 0;
  bool given_up = false;
  const auto answer = [&](const wire::Message& question) -> std::optional<wire::Message> {
    if (question.envelope.has_submit()) {
      if (asked++ < 2) return Lacks(log->ContentHash().Binary());
      wire::Message reply = Ok();
      reply.envelope.mutable_reply()->add_jobs()->set_id("museum-1");
      return reply;
    }
    given_up &= !question.envelope.has_offer();
    if (question.envelope.has_piece() && ++pieces == 3) {
      given_up = true;
      return Lacks(log->ContentHash().Binary());
    }
    if (given_up) return std::nullopt;  // what was on its way
    return uploaded.Answer(question.envelope);
  };
  FakeService service(folder_.Ipc("s"), answer);
  const auto info = Connect().Submit(proto::Job(), {{"log", log}});
  EXPECT_TRUE(info.ok()) << info.status().message();
  EXPECT_EQ(asked, 3);
  EXPECT_TRUE(uploaded.bytes == flat_testing::Flat(*log));
}

// Where nothing is missing a second try would only be taken for the same job told twice.
TEST_F(ClientTest, ARefusedSubmissionIsNotRepeated) {
  int asked = 0;
  FakeService service(folder_.Ipc("s"), [&asked](const wire::Message&) {
    wire::Message reply = Ok();
    reply.envelope.mutable_reply()->set_ok(asked++ > 0);
    reply.envelope.mutable_reply()->set_message("cannot save: no space left");
    reply.envelope.mutable_reply()->add_jobs()->set_id("1-museum");
    return reply;
  });
  const Status refused = Connect().Submit(proto::Job(), {{"log", Number(1)}}).status();
  EXPECT_EQ(refused.code(), Code::kRefused);
  EXPECT_EQ(refused.message(), "cannot save: no space left");
  EXPECT_EQ(asked, 1);
}

// So nothing that polls ends for it, `cairn watch` or an upload of many inputs.
TEST_F(ClientTest, AServiceThatIsAskedTooOftenIsAskedAgain) {
  int asked = 0;
  Uploaded uploaded;
  const std::string lacking = Number(1)->ContentHash().Binary();
  FakeService service(folder_.Ipc("s"), [&](const wire::Message& question) -> std::optional<wire::Message> {
    if (question.envelope.has_piece()) return uploaded.Answer(question.envelope);
    if (++asked % 3 != 0) {
      wire::Message often = Ok();
      often.envelope.mutable_reply()->set_ok(false);
      often.envelope.mutable_reply()->set_unable(true);
      often.envelope.mutable_reply()->set_again_s(0.01);
      return often;
    }
    if (question.envelope.has_offer()) return uploaded.Answer(question.envelope);
    if (question.envelope.has_submit() && uploaded.bytes.empty()) return Lacks(lacking);
    wire::Message reply = Ok();
    reply.envelope.mutable_reply()->add_jobs()->set_id("1-museum");
    return reply;
  });
  Client client = Connect();
  EXPECT_TRUE(client.Info("1-museum").ok());
  EXPECT_EQ(asked, 3);
  EXPECT_TRUE(client.Submit(proto::Job(), {{"log", Number(1)}}).ok());
  EXPECT_EQ(asked, 12);
}

TEST_F(ClientTest, AServiceThatSaysToAskAgainInHoursIsNotWaitedFor) {
  FakeService service(folder_.Ipc("s"), [](const wire::Message&) {
    wire::Message often = Ok();
    often.envelope.mutable_reply()->set_ok(false);
    often.envelope.mutable_reply()->set_unable(true);
    often.envelope.mutable_reply()->set_again_s(1e12);
    return often;
  });
  EXPECT_EQ(Connect().Info("1-museum").status().code(), Code::kNoSpace);
}

// By which a command knows with which code it ends.
TEST_F(ClientTest, AServiceThatCannotNowIsToldFromOneThatWillNot) {
  std::atomic<bool> unable = false;
  FakeService service(folder_.Ipc("s"), [&](const wire::Message&) {
    wire::Message reply = Ok();
    reply.envelope.mutable_reply()->set_ok(false);
    reply.envelope.mutable_reply()->set_unable(unable);
    reply.envelope.mutable_reply()->set_message("why not");
    return reply;
  });
  Client client = Connect();
  EXPECT_EQ(client.Submit(proto::Job(), {{"log", Number(1)}}).status().code(), Code::kRefused);
  unable = true;
  EXPECT_EQ(client.Submit(proto::Job(), {{"log", Number(1)}}).status().code(), Code::kNoSpace);
  EXPECT_EQ(client.Command("j", "cancel").status().code(), Code::kNoSpace);
}

TEST_F(ClientTest, AServiceThatKeepsNoInputIsGivenUp) {
  int asked = 0;
  Uploaded uploaded;
  FakeService service(folder_.Ipc("s"), [&](const wire::Message& question) -> std::optional<wire::Message> {
    if (!question.envelope.has_submit()) return uploaded.Answer(question.envelope);
    ++asked;
    return Lacks(Number(1)->ContentHash().Binary());
  });
  EXPECT_EQ(Connect().Submit(proto::Job(), {{"log", Number(1)}}).status().code(), Code::kRefused);
  EXPECT_EQ(asked, 3);
}

TEST_F(ClientTest, AnUploadThatIsRefusedOrNeverAnsweredEndsTheSubmission) {
  bool silent = false;
  FakeService service(folder_.Ipc("s"), [&](const wire::Message& question) -> std::optional<wire::Message> {
    if (question.envelope.has_submit()) return Lacks(Number(1)->ContentHash().Binary());
    if (silent) return std::nullopt;
    wire::Message reply = Ok();
    reply.envelope.mutable_reply()->set_ok(false);
    reply.envelope.mutable_reply()->set_message("no space left");
    return reply;
  });
  const Status refused = Connect().Submit(proto::Job(), {{"log", Number(1)}}).status();
  EXPECT_EQ(refused.code(), Code::kRefused);
  EXPECT_EQ(refused.message(), "no space left");
  silent = true;
  EXPECT_EQ(Connect(0.2).Submit(proto::Job(), {{"log", Number(1)}}).status().code(), Code::kIo);
}

TEST_F(ClientTest, QueriesCarryTheirActionAndResultsTheirNames) {
  std::vector<std::string> actions;
  FakeService service(folder_.Ipc("s"), [&](const wire::Message& question) {
    actions.push_back(question.envelope.query().action() + " " + question.envelope.query().job());
    wire::Message reply = Ok();
    reply.envelope.mutable_reply()->add_jobs()->set_id("j");
    reply.envelope.mutable_reply()->set_workers(3);
    if (question.envelope.query().action() == "results") {
      reply.blobs = {wire::NameBlob(Number(1)), wire::NameBlob(Number(2))};
      reply.envelope.mutable_reply()->add_names("landmarks");
      reply.envelope.mutable_reply()->add_names("grid");
    }
    return reply;
  });
  Client client = Connect();
  EXPECT_EQ(client.List().value().workers, 3u);
  EXPECT_EQ(client.Info("j").value().id(), "j");
  EXPECT_TRUE(client.Command("j", "cancel").ok());
  EXPECT_TRUE(client.Command("j", "resume").ok());
  const auto results = client.Results("j");
  ASSERT_TRUE(results.ok());
  EXPECT_EQ(results.value().at("grid")->Scalar<double>("v"), 2);
  EXPECT_EQ(actions, (std::vector<std::string>{"status ", "status j", "cancel j", "resume j", "status j",
                                               "results j"}));
}

TEST_F(ClientTest, ARefusalCarriesTheReasonAndAnUnknownJobIsNotFound) {
  FakeService service(folder_.Ipc("s"), [](const wire::Message& question) {
    wire::Message reply = Ok();
    if (question.envelope.query().action() == "resume") {
      reply.envelope.mutable_reply()->set_ok(false);
      reply.envelope.mutable_reply()->set_message("it is done");
    }
    return reply;
  });
  Client client = Connect();
  EXPECT_EQ(client.Info("nothing").status().code(), Code::kNotFound);
  const Status refused = client.Command("j", "resume").status();
  EXPECT_EQ(refused.code(), Code::kRefused);
  EXPECT_EQ(refused.message(), "it is done");
  EXPECT_EQ(client.Command("", "cancel").status().code(), Code::kNotFound)
      << "an empty name would mean all jobs";
}

TEST_F(ClientTest, ASilentServiceAndNoServiceAreToldApart) {
  Client client = Connect(0.05);
  const Status nobody = client.List().status();
  EXPECT_EQ(nobody.code(), Code::kIo);
  EXPECT_NE(nobody.message().find("no service listens"), std::string::npos) << nobody.message();
  int asked = 0;
  FakeService service(folder_.Ipc("s"), [&asked](const wire::Message&) {
    return asked++ == 0 ? std::optional(Ok()) : std::nullopt;
  });
  Client patient = Connect(3);
  ASSERT_TRUE(patient.List().ok());
  const Status silent = patient.List().status();
  EXPECT_EQ(silent.code(), Code::kIo);
  EXPECT_NE(silent.message().find("does not answer"), std::string::npos) << silent.message();
}

// A line of its own in a list would be read as another job.
TEST_F(ClientTest, AJobWhoseNameHasLinesIsNoAnswer) {
  FakeService service(folder_.Ipc("s"), [](const wire::Message&) {
    wire::Message reply = Ok();
    reply.envelope.mutable_reply()->add_jobs()->set_id("1-j");
    reply.envelope.mutable_reply()->mutable_jobs(0)->set_name("j\n2-k  k  done");
    return reply;
  });
  EXPECT_EQ(Connect().List().status().code(), Code::kCorrupt);
}

TEST_F(ClientTest, AnAnswerThatIsNoReplyIsAnotherVersion) {
  FakeService service(folder_.Ipc("s"), [](const wire::Message&) {
    wire::Message odd;
    odd.envelope.mutable_welcome();
    return odd;
  });
  EXPECT_EQ(Connect().List().status().code(), Code::kVersion);
}

TEST_F(ClientTest, AResultThatTheServiceCannotReadIsNotLeftOutInSilence) {
  FakeService service(folder_.Ipc("s"), [](const wire::Message&) {
    wire::Message reply = Ok();
    reply.envelope.mutable_reply()->add_jobs()->set_id("j");
    reply.envelope.mutable_reply()->set_message("landmarks.h5: wrong checksum");
    return reply;
  });
  const Status status = Connect().Results("j").status();
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_EQ(status.message(), "landmarks.h5: wrong checksum");
}

TEST_F(ClientTest, WhoAsksForTheFactsGetsTheResultsThatCanBeRead) {
  FakeService service(folder_.Ipc("s"), [](const wire::Message&) {
    wire::Message reply = Ok();
    reply.envelope.mutable_reply()->add_jobs()->set_id("j");
    reply.envelope.mutable_reply()->mutable_jobs(0)->set_state("cancelled");
    reply.envelope.mutable_reply()->set_message("the stage 'landmarks': wrong checksum");
    reply.blobs = {wire::NameBlob(Number(2))};
    reply.envelope.mutable_reply()->add_names("grid");
    return reply;
  });
  ResultsFacts facts;
  const auto results = Connect().Results("j", &facts);
  ASSERT_TRUE(results.ok()) << results.status().message();
  EXPECT_EQ(results.value().at("grid")->Scalar<double>("v"), 2);
  EXPECT_EQ(facts.damaged, "the stage 'landmarks': wrong checksum");
  EXPECT_EQ(facts.job.state(), "cancelled");
}

// As it is for a client that was stopped for so long that its connection is gone.
TEST_F(ClientTest, ResultsAreAskedForAgainWhereTheConnectionIsLost) {
  std::atomic<int> lost = 2;
  FakeService service(folder_.Ipc("s"), [&](const wire::Message& question) {
    if (question.envelope.query().action() == "results" && lost-- > 0) return FakeService::Dropped();
    wire::Message reply = Ok();
    reply.envelope.mutable_reply()->add_jobs()->set_id("j");
    reply.blobs = {wire::NameBlob(Number(2))};
    reply.envelope.mutable_reply()->add_names("grid");
    return reply;
  });
  const auto results = Connect().Results("j");
  ASSERT_TRUE(results.ok()) << results.status().message();
  EXPECT_EQ(results.value().at("grid")->Scalar<double>("v"), 2);
}

TEST_F(ClientTest, ACommandIsNotSaidTwiceWhereTheConnectionIsLost) {
  std::atomic<int> told = 0;
  FakeService service(folder_.Ipc("s"), [&](const wire::Message&) {
    ++told;
    return FakeService::Dropped();
  });
  const Status lost = Connect().Command("j", "cancel").status();
  EXPECT_EQ(lost.code(), Code::kIo);
  EXPECT_NE(lost.message().find("went away before it answered"), std::string::npos) << lost.message();
  EXPECT_EQ(told, 1);
}

TEST_F(ClientTest, ResultsWithoutAllTheirNamesAreCorrupt) {
  FakeService service(folder_.Ipc("s"), [](const wire::Message&) {
    wire::Message reply = Ok();
    reply.envelope.mutable_reply()->add_jobs()->set_id("j");
    reply.blobs = {wire::NameBlob(Number(1))};
    return reply;
  });
  EXPECT_EQ(Connect().Results("j").status().code(), Code::kCorrupt);
}

// Much may be on its way; a service that says nothing at all is waited for as in any other question.
TEST_F(ClientTest, ResultsOfAServiceThatStandsStillAreNotWaitedForLong) {
  int asked = 0;
  FakeService service(folder_.Ipc("s"), [&](const wire::Message& question) -> std::optional<wire::Message> {
    ++asked;
    EXPECT_EQ(question.envelope.query().action(), "status");
    return std::nullopt;
  });
  EXPECT_EQ(Connect(0.2).Results("j").status().code(), Code::kIo);
  EXPECT_EQ(asked, 1);
}

// A result becomes a file of its name.
TEST_F(ClientTest, AResultsNameDoesNotLeadOutOfItsFolder) {
  for (const char* name : {"../grid", "/etc/grid", "..", "", "a/b"}) {
    FakeService service(folder_.Ipc("s"), [&](const wire::Message&) {
      wire::Message reply = Ok();
      reply.envelope.mutable_reply()->add_jobs()->set_id("j");
      reply.envelope.mutable_reply()->add_names(name);
      reply.blobs = {wire::NameBlob(Number(1))};
      return reply;
    });
    EXPECT_EQ(Connect().Results("j").status().code(), Code::kCorrupt) << name;
  }
}

TEST_F(ClientTest, AJobsIdDoesNotLeadOutOfTheFolderOfResults) {
  for (const char* id : {"../../../home", "/etc/grid", "..", ".ssh", "", "a/b", "\x1b[2J"}) {
    FakeService service(folder_.Ipc("s"), [&](const wire::Message&) {
      wire::Message reply = Ok();
      reply.envelope.mutable_reply()->add_jobs()->set_id(id);
      return reply;
    });
    EXPECT_EQ(Connect().List().status().code(), Code::kCorrupt) << id;
  }
}

}  // namespace
}  // namespace cairn::coordinator
