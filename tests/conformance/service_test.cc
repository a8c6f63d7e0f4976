// The service for many machines over TCP with keys: real workers, real clients, and peers that mean harm.
#include "coordinator/server/service.h"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <mutex>
#include <thread>
#include <zmq.hpp>

#include "coordinator/client.h"
#include "pipelines/testing/in_process.h"
#include "schema/numerics.h"
#include "schema/service_manager_testing.h"
#include "schema/wire/testing/private_folder.h"
#include "schema/wire/testing/raw_peer.h"
#include "tests/conformance/cases.h"
#include "tests/conformance/process.h"

namespace cairn::conformance {
namespace {

using coordinator::Client;

class TcpService : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"coordinator", "worker", "client", "stranger"}) {
      keys_[name] = wire::GenerateKeyPair();
      ASSERT_TRUE(wire::WriteKeyPair(folder_.path() / name, keys_[name]).ok());
    }
    std::ofstream(folder_.path() / "allowed") << keys_["worker"].public_key << " worker w\n"
                                              << keys_["client"].public_key << " submitter c\nend\n";
    coordinator::ServiceOptions options;
    options.store_dir = (folder_.path() / "store").string();
    options.listen = endpoint_;
    options.keys_dir = folder_.path().string();
    service_ = std::thread([this, options] {
      status_ = coordinator::Serve(
          options, [this](coordinator::Severity, const std::string& line) { Log(line); }, stop_);
    });
  }
  void TearDown() override {
    stop_ = true;
    service_.join();
    EXPECT_TRUE(status_.ok()) << status_.message();
  }
  Client ConnectAs(const std::string& name) {
    const wire::ClientSecurity security{keys_.at(name), keys_.at("coordinator").public_key};
    return Client::Connect({.endpoint = endpoint_, .security = security, .timeout_s = 30}).value();
  }
  std::unique_ptr<Process> StartWorker(const std::string& name) {
    const std::string stem = folder_.path().string() + "/";
    return std::make_unique<Process>(
        std::vector<std::string>{"--connect", endpoint_, "--key", stem + name + ".key", "--server-key",
                                 stem + "coordinator.pub"},
        folder_.path() / (name + ".log"));
  }
  void Log(const std::string& line) {
    const std::lock_guard lock(mutex_);
    log_ += line + "\n";
  }
  std::string log() {
    const std::lock_guard lock(mutex_);
    return log_;
  }

  const wire::PrivateFolder folder_;
  const std::string endpoint_ = wire::FreeTcpEndpoint();
  std::map<std::string, wire::KeyPair> keys_;
  std::atomic<bool> stop_{false};
  Status status_;
  std::thread service_;
  std::mutex mutex_;
  std::string log_;
};

TEST(Service, TellsItsServiceManagerThatItIsReadyThatItLivesAndThatItEnds) {
  const wire::PrivateFolder folder;
  FakeServiceManager manager;
  ::setenv("WATCHDOG_USEC", "30000", 1);
  coordinator::ServiceOptions options;
  options.store_dir = (folder.path() / "store").string();
  options.listen = folder.Ipc("s");
  std::atomic<bool> stop{false}, listening{false};
  std::string early = "nothing was listened to";
  std::thread service([&] {
    const auto log = [&](coordinator::Severity, const std::string& line) {
      if (!line.starts_with("listening on")) return;
      early = manager.Hear();
      listening = true;
    };
    EXPECT_TRUE(coordinator::Serve(options, log, stop).ok());
  });
  while (!listening) ::usleep(1000);
  EXPECT_EQ(early, "") << "the store was not read yet";
  std::vector<std::string> heard;
  while (heard.size() < 3)
    if (const std::string what = manager.Hear(); !what.empty()) heard.push_back(what);
  stop = true;
  service.join();
  for (std::string what; !(what = manager.Hear()).empty();) heard.push_back(what);
  EXPECT_EQ(heard[0], "READY=1");
  EXPECT_EQ(heard[1], "WATCHDOG=1");
  EXPECT_EQ(heard.back(), "STOPPING=1");
}

// Waits for the end of a job by asking.
wire::JobInfo Await(Client& client, const std::string& id) {
  while (true) {
    const Result<wire::JobInfo> info = client.Info(id);
    CAIRN_DEMAND(info.ok(), info.status().message());
    if (info.value().state() != "queued" && info.value().state() != "running") return info.value();
    std::this_thread::yield();
  }
}

// Speaks CURVE with a known key, but no Cairn.
void SendGarbage(const std::string& endpoint, const wire::KeyPair& keys, const std::string& server_key) {
  zmq::context_t context;
  zmq::socket_t socket(context, zmq::socket_type::dealer);
  socket.set(zmq::sockopt::curve_serverkey, server_key);
  socket.set(zmq::sockopt::curve_publickey, keys.public_key);
  socket.set(zmq::sockopt::curve_secretkey, keys.secret_key);
  socket.set(zmq::sockopt::linger, 5000);
  socket.connect(endpoint);
  socket.send(zmq::str_buffer("\xff\xff garbage"), zmq::send_flags::none);
}

TEST_F(TcpService, EveryPipelineGivesTheBitsOfTheInProcessRunner) {
  const auto first = StartWorker("worker");
  const auto second = StartWorker("worker");
  Client client = ConnectAs("client");
  FixNumericsOfProcess();
  FixNumericsOfThread();
  for (const Case& c : AllCases()) {
    const Result<wire::JobInfo> job = client.Submit(JobOf(c), c.inputs);
    ASSERT_TRUE(job.ok()) << job.status().message();
    SendGarbage(endpoint_, keys_["client"], keys_["coordinator"].public_key);
    const wire::JobInfo end = Await(client, job.value().id());
    ASSERT_EQ(end.state(), "done") << end.reason() << log();
    const auto results = client.Results(job.value().id());
    ASSERT_TRUE(results.ok()) << results.status().message();
    EXPECT_EQ(results.value().at("stage")->Without("provenance/").ContentHash(),
              RunInProcess(*Make(c.stage, c.seed), c.inputs)->ContentHash());
  }
  EXPECT_NE(log().find("refused (malformed)"), std::string::npos) << log();
}

TEST_F(TcpService, AWorkerThatComesLateTakesOverFromOneThatLeaves) {
  auto first = StartWorker("worker");
  Client client = ConnectAs("client");
  Case c = AllCases().back();
  ASSERT_EQ(c.name, "toy");
  (*c.stage.mutable_options())["rounds"].set_i(400);
  const Result<wire::JobInfo> job = client.Submit(JobOf(c), c.inputs);
  ASSERT_TRUE(job.ok()) << job.status().message();
  const auto early = [&] {
    const wire::JobInfo info = client.Info(job.value().id()).value();
    return info.state() != "done" && info.round() < 20;
  };
  while (early()) std::this_thread::yield();
  const auto second = StartWorker("worker");
  while (client.List().value().workers < 2) std::this_thread::yield();
  ASSERT_EQ(::kill(first->pid(), SIGTERM), 0);
  EXPECT_EQ(first->Wait(), 0);
  const wire::JobInfo end = Await(client, job.value().id());
  ASSERT_EQ(end.state(), "done") << end.reason();
  FixNumericsOfProcess();
  FixNumericsOfThread();
  EXPECT_EQ(client.Results(job.value().id()).value().at("stage")->Without("provenance/").ContentHash(),
            RunInProcess(*Make(c.stage, c.seed), c.inputs)->ContentHash());
}

TEST_F(TcpService, AStrangerGetsNothing) {
  EXPECT_EQ(ConnectAs("stranger").List().status().code(), Code::kRefused);
  EXPECT_EQ(StartWorker("stranger")->Wait(), 2);
  std::ifstream file(folder_.path() / "stranger.log");
  const std::string said{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(said.find("key"), std::string::npos) << said;
  const Result<coordinator::JobList> list = ConnectAs("client").List();
  ASSERT_TRUE(list.ok()) << list.status().message();
  EXPECT_EQ(list.value().workers, 0u);
}

TEST_F(TcpService, ABadJobIsRefusedAndABadInputFailsTheJobWithItsReason) {
  const auto worker = StartWorker("worker");
  Client client = ConnectAs("client");
  Case c = AllCases().back();
  c.stage.set_pipeline("toy");
  Blob empty = *c.inputs.at("log");
  empty.PutVector<double>("robot/0/odometry/forward_m", {});
  c.inputs["log"] = std::make_shared<const Blob>(std::move(empty));
  const Result<wire::JobInfo> job = client.Submit(JobOf(c), c.inputs);
  ASSERT_TRUE(job.ok()) << job.status().message();
  const wire::JobInfo end = Await(client, job.value().id());
  EXPECT_EQ(end.state(), "failed");
  EXPECT_TRUE(end.input_error());
  EXPECT_NE(end.reason().find("'robot/0/odometry/forward_m' has the shape [0]"), std::string::npos)
      << end.reason();
  EXPECT_EQ(client.Submit(proto::Job(), std::map<std::string, BlobPtr>{}).status().code(), Code::kRefused)
      << "a job without stages";
  EXPECT_FALSE(client.Info("nobody").ok());
}

}  // namespace
}  // namespace cairn::conformance
