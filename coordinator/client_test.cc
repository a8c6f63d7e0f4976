#include "coordinator/client.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <thread>

#include "schema/wire/poller.h"
#include "schema/wire/testing.h"

namespace cairn::coordinator {
namespace {

// A service whose answers the test gives.
class FakeService {
 public:
  using Answer = std::function<std::optional<wire::Message>(const wire::Message&)>;
  FakeService(const std::string& endpoint, Answer answer)
      : socket_(wire::RouterSocket::Bind(context_, endpoint).value()),
        thread_([this, answer] { Serve(answer); }) {}
  ~FakeService() {
    stop_ = true;
    wakeup_.Signal();
    thread_.join();
  }

 private:
  void Serve(const Answer& answer) {
    wire::Poller poller;
    poller.Add(socket_);
    poller.Add(wakeup_);
    while (!stop_) {
      poller.Wait(std::chrono::seconds(10));
      while (const std::optional<wire::Received> received = socket_.TryReceive()) {
        if (const std::optional<wire::Message> reply = answer(received->message)) {
          EXPECT_TRUE(socket_.Send(received->peer, *reply).ok());
        }
      }
    }
  }
  wire::Context context_;
  wire::Wakeup wakeup_;
  wire::RouterSocket socket_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

wire::Message Ok() {
  wire::Message message;
  message.envelope.mutable_reply()->set_ok(true);
  return message;
}

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

TEST_F(ClientTest, SubmitUploadsOnlyWhatTheServiceLacks) {
  wire::Message submitted;
  const std::string lacking = Number(2)->ContentHash().Binary();
  FakeService service(folder_.Ipc("s"), [&](const wire::Message& question) {
    wire::Message reply = Ok();
    if (question.blobs.empty()) {
      reply.envelope.mutable_reply()->set_ok(false);
      reply.envelope.mutable_reply()->add_missing(lacking);
    } else {
      submitted = question;
      reply.envelope.mutable_reply()->add_jobs()->set_id("museum-1");
    }
    return reply;
  });
  proto::Job job;
  job.set_name("museum");
  Client client = Connect();
  const Result<wire::JobInfo> info =
      client.Submit(job, {{"log", Number(1)}, {"map", Number(2)}, {"old", Number(1)}});
  ASSERT_TRUE(info.ok()) << info.status().message();
  EXPECT_EQ(info.value().id(), "museum-1");
  const proto::Job& sent = submitted.envelope.submit().job();
  EXPECT_EQ(sent.name(), "museum");
  EXPECT_EQ(sent.input_blobs_size(), 3);
  EXPECT_EQ(sent.input_blobs().at("map"), lacking);
  ASSERT_EQ(submitted.blobs.size(), 1u);
  EXPECT_EQ(submitted.blobs[0].blob->Scalar<double>("v"), 2);
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

TEST_F(ClientTest, AServiceThatKeepsNoInputIsGivenUp) {
  int asked = 0;
  FakeService service(folder_.Ipc("s"), [&asked](const wire::Message&) {
    ++asked;
    wire::Message reply = Ok();
    reply.envelope.mutable_reply()->set_ok(false);
    reply.envelope.mutable_reply()->add_missing(Number(1)->ContentHash().Binary());
    return reply;
  });
  EXPECT_EQ(Connect().Submit(proto::Job(), {{"log", Number(1)}}).status().code(), Code::kRefused);
  EXPECT_EQ(asked, 3);
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
  EXPECT_EQ(actions, (std::vector<std::string>{"status ", "status j", "cancel j", "resume j", "results j"}));
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
    reply.envelope.mutable_reply()->set_message("landmarks.h5: wrong checksum");
    return reply;
  });
  const Status status = Connect().Results("j").status();
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_EQ(status.message(), "landmarks.h5: wrong checksum");
}

TEST_F(ClientTest, ResultsWithoutAllTheirNamesAreCorrupt) {
  FakeService service(folder_.Ipc("s"), [](const wire::Message&) {
    wire::Message reply = Ok();
    reply.blobs = {wire::NameBlob(Number(1))};
    return reply;
  });
  EXPECT_EQ(Connect().Results("j").status().code(), Code::kCorrupt);
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

}  // namespace
}  // namespace cairn::coordinator
