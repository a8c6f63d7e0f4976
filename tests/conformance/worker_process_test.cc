// The worker as a process of its own over real ipc, with the test as its coordinator.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "schema/blob_part.h"
#include "schema/numerics.h"
#include "schema/service_manager_testing.h"
#include "schema/wire/poller.h"
#include "schema/wire/socket.h"
#include "schema/wire/testing/private_folder.h"
#include "tests/conformance/cases.h"
#include "tests/conformance/process.h"

namespace cairn::conformance {
namespace {

constexpr std::chrono::seconds kPatience{300};

class WorkerProcess : public ::testing::Test {
 protected:
  void SetUp() override { Bind(); }
  void Bind() {
    router_.reset();
    Result<wire::RouterSocket> bound = wire::RouterSocket::Bind(context_, folder_.Ipc("s"));
    ASSERT_TRUE(bound.ok()) << bound.status().message();
    router_.emplace(std::move(bound).value());
  }
  std::vector<std::string> Arguments() const { return {"--connect", folder_.Ipc("s"), "--slots", "3"}; }
  std::filesystem::path Output() const { return folder_.path() / "output"; }
  std::string OutputText() const {
    std::ifstream file(Output());
    return {std::istreambuf_iterator<char>(file), {}};
  }
  // The next message but heartbeats; a failure after kPatience.
  wire::Received Receive() {
    wire::Poller poller;
    poller.Add(*router_);
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < end) {
      while (std::optional<wire::Received> received = router_->TryReceive()) {
        if (!received->message.envelope.has_heartbeat()) return std::move(*received);
      }
      poller.Wait(std::chrono::milliseconds(100));
    }
    ADD_FAILURE() << "the worker says nothing: " << OutputText();
    return {};
  }
  void Welcome(const std::string& peer) {
    wire::Message welcome;
    welcome.envelope.mutable_welcome()->set_heartbeat_s(0.1);
    EXPECT_TRUE(router_->Send(peer, welcome).ok());
  }

  wire::PrivateFolder folder_;
  wire::Context context_;
  std::optional<wire::RouterSocket> router_;
};

TEST_F(WorkerProcess, SaysWhatItIs) {
  Process worker(Arguments(), Output());
  const wire::Received hello = Receive();
  ASSERT_TRUE(hello.message.envelope.has_hello());
  const wire::Hello& said = hello.message.envelope.hello();
  EXPECT_EQ(said.protocol(), wire::kProtocol);
  EXPECT_EQ(said.pid(), worker.pid());
  EXPECT_EQ(said.slots(), 3u);
  EXPECT_FALSE(said.build().version().empty());
  EXPECT_FALSE(said.build().compiler().empty());
  EXPECT_NE(said.build().flags().find("-ffp-contract=off"), std::string::npos) << said.build().flags();
  EXPECT_FALSE(said.build().libc().empty());
  FixNumericsOfProcess();
  FixNumericsOfThread();
  EXPECT_EQ(said.build().numeric_self_test(), NumericSelfTest().Binary());
}

TEST_F(WorkerProcess, FetchesComputesAndAnswers) {
  Process worker(Arguments(), Output());
  const std::string peer = Receive().peer;
  Welcome(peer);
  int fetches = 0;
  for (const Case& c : AllCases()) {
    wire::Message assign;
    wire::Assign& task = *assign.envelope.mutable_assign();
    task.mutable_key()->set_kind(wire::TaskKey::START);
    *task.mutable_stage() = c.stage;
    task.set_seed(c.seed);
    std::map<std::string, wire::NamedBlob> blobs;  // by hash
    for (const auto& [name, blob] : c.inputs) {
      const wire::NamedBlob named = wire::NameBlob(blob);
      (*task.mutable_inputs())[name] = named.hash.Binary();
      blobs.emplace(named.hash.Binary(), named);
    }
    ASSERT_TRUE(router_->Send(peer, assign).ok());
    wire::Received done = Receive();
    while (done.message.envelope.has_fetch()) {  // what it does not have yet
      const wire::Fetch& fetch = done.message.envelope.fetch();
      const wire::NamedBlob& whole = blobs.at(fetch.hash());
      wire::Message data;
      data.blobs = {whole};
      wire::BlobData& is = *data.envelope.mutable_blob();
      if (fetch.has_part()) {
        const Result<BlobPtr> part = CutPart(*whole.blob, fetch.part());
        ASSERT_TRUE(part.ok()) << part.status().message();
        is.set_of(fetch.hash());
        *is.mutable_part() = fetch.part();
        data.blobs = {wire::NameBlob(part.value())};
      }
      ASSERT_TRUE(router_->Send(peer, data).ok());
      done = Receive();
      ++fetches;
    }
    ASSERT_TRUE(done.message.envelope.has_done()) << done.message.envelope.DebugString();
    EXPECT_GT(done.message.envelope.done().step().tasks_size(), 0);
  }
  EXPECT_GT(fetches, 1);
}

TEST_F(WorkerProcess, ComesBackToARestartedCoordinator) {
  Process worker(Arguments(), Output());
  const wire::Received first = Receive();
  Welcome(first.peer);
  Bind();
  const wire::Received second = Receive();
  ASSERT_TRUE(second.message.envelope.has_hello());
  EXPECT_EQ(second.message.envelope.hello().pid(), worker.pid());
}

TEST_F(WorkerProcess, ARefusedOnePrintsTheReasonAndExitsWithTwo) {
  Process worker(Arguments(), Output());
  wire::Message refuse;
  refuse.envelope.mutable_refuse()->set_reason("its compiler is another");
  ASSERT_TRUE(router_->Send(Receive().peer, refuse).ok());
  EXPECT_EQ(worker.Wait(), 2);
  EXPECT_NE(OutputText().find("refused: its compiler is another"), std::string::npos) << OutputText();
}

TEST_F(WorkerProcess, SendsLeaveWhenItIsToldToEnd) {
  Process worker(Arguments(), Output());
  Welcome(Receive().peer);
  ASSERT_EQ(::kill(worker.pid(), SIGTERM), 0);
  EXPECT_TRUE(Receive().message.envelope.has_leave());
  EXPECT_EQ(worker.Wait(), 0);
}

TEST_F(WorkerProcess, DiesWithItsParentWhereAskedTo) {
  ASSERT_EQ(::prctl(PR_SET_CHILD_SUBREAPER, 1), 0);  // the orphan's end is ours to see
  std::vector<std::string> arguments = Arguments();
  arguments.push_back("--die-with-parent");
  const pid_t parent = ::fork();
  if (parent == 0) {
    const Process worker(arguments, Output());
    ::pause();
    ::_exit(0);
  }
  const wire::Received hello = Receive();
  ASSERT_EQ(::kill(parent, SIGKILL), 0);
  ASSERT_EQ(::waitpid(parent, nullptr, 0), parent);
  const auto orphan = static_cast<pid_t>(hello.message.envelope.hello().pid());
  int status = 0;
  EXPECT_EQ(::waitpid(orphan, &status, 0), orphan);
  EXPECT_TRUE(WIFSIGNALED(status));
  ::prctl(PR_SET_CHILD_SUBREAPER, 0);
}

TEST_F(WorkerProcess, DescribesItsPipelinesAsJson) {
  EXPECT_EQ(Process({"--describe"}, Output()).Wait(), 0);
  const nlohmann::json json = nlohmann::json::parse(OutputText());
  EXPECT_EQ(json["pipelines"].size(), ListAll().size());
}

TEST_F(WorkerProcess, BadUsageExitsWithTwoAndAReason) {
  const std::map<std::string, std::vector<std::string>> cases = {
      {"--connect", {}},
      {"TCP needs keys", {"--connect", "tcp://127.0.0.1:1"}},
      {"0700", {"--connect", "ipc:///tmp/somewhere"}},
      {"--slots", {"--connect", "x", "--slots", "0"}},
      {"--nonsense", {"--nonsense"}},
  };
  for (const auto& [expected, arguments] : cases) {
    EXPECT_EQ(Process(arguments, Output()).Wait(), 2) << expected;
    EXPECT_NE(OutputText().find(expected), std::string::npos) << OutputText();
  }
}

TEST_F(WorkerProcess, TellsItsServiceManagerThatItIsReadyThatItLivesAndThatItEnds) {
  FakeServiceManager manager;
  ::setenv("WATCHDOG_USEC", "30000", 1);
  Process process(Arguments(), Output());
  const wire::Received hello = Receive();
  EXPECT_EQ(manager.Hear(), "READY=1") << "before it says Hello: whoever waits need not wait for that";
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (manager.Hear() != "WATCHDOG=1" && std::chrono::steady_clock::now() < end) ::usleep(1000);
  ::kill(process.pid(), SIGTERM);
  EXPECT_EQ(process.Wait(), 0);
  std::string last;
  for (std::string heard; !(heard = manager.Hear()).empty();) last = heard;
  EXPECT_EQ(last, "STOPPING=1");
}

TEST_F(WorkerProcess, KnowsItsOptionsByTheNamesThatTheyHad) {
  EXPECT_EQ(Process({"--connect", "nowhere", "--log-json"}, Output()).Wait(), 2);
  EXPECT_NE(OutputText().find("warning: '--log-json' is called '--log-format=json' now"), std::string::npos)
      << OutputText();
  EXPECT_NE(OutputText().find("\"program\":\"cairn-worker\""), std::string::npos) << OutputText();
}

TEST_F(WorkerProcess, LogsAreJsonLinesWhereAskedFor) {
  EXPECT_EQ(Process({"--connect", "nowhere", "--log-format", "json"}, Output()).Wait(), 2);
  const nlohmann::json line = nlohmann::json::parse(OutputText());
  EXPECT_EQ(line["time"].get<std::string>().substr(0, 2), "20");
  EXPECT_EQ(line["level"], "error");
  EXPECT_EQ(line["program"], "cairn-worker");
  EXPECT_NE(line["message"].get<std::string>().find("nowhere"), std::string::npos) << line;
}

}  // namespace
}  // namespace cairn::conformance
