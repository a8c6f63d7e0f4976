// A fixture for tests that hurt real processes: a coordinator, workers, one job of the toy pipeline, and the
// bits that it must end with.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/client.h"
#include "coordinator/store/checkpoint_file.h"
#include "pipelines/testing/in_process.h"
#include "schema/wire/keys.h"
#include "schema/wire/testing/private_folder.h"
#include "schema/wire/testing/raw_peer.h"
#include "tests/faults/process.h"
#include "worker/testing/toy_pipeline.h"

namespace cairn::faults {

namespace fs = std::filesystem;

inline constexpr int kRounds = 12, kSlices = 12;
inline constexpr const char* kTaskMs = "25";  // about 4 s of work

inline proto::Job ToyJob() {
  proto::Job job;
  job.set_name("toy");
  job.set_seed(7);
  proto::Stage& stage = *job.add_stages();
  stage.set_name("toy");
  stage.set_pipeline("toy");
  (*stage.mutable_inputs())["log"] = "log";
  (*stage.mutable_options())["rounds"].set_i(kRounds);
  (*stage.mutable_options())["slices"].set_i(kSlices);
  return job;
}

class Faults : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("CAIRN_TASK_MS", kTaskMs, 1);
    log_ = std::make_shared<const Blob>(testing::ToyLog(200).Without("truth/"));
    want_ = RunInProcess(*testing::MakeToy(ToyJob().stages(0), 7), {{"log", log_}})->ContentHash();
    StartCoordinator();
  }
  void TearDown() override {
    if (!HasFailure()) return;
    for (const char* file : {"coordinator.log", "worker.log"})
      std::cerr << file << ":\n" << std::ifstream(folder_.path() / file).rdbuf();
  }
  fs::path Store() const { return folder_.path() / "store"; }
  void StartCoordinator() {
    std::vector<std::string> words = {CAIRN_PROGRAM,           "coordinator", "--store",
                                      Store().string(),        "--listen",    endpoint_,
                                      "--checkpoint-interval", "0.2"};
    words.insert(words.end(), coordinator_more_.begin(), coordinator_more_.end());
    coordinator_.emplace(words, folder_.path() / "coordinator.log");
  }
  Process& AddWorker(const char* program = CAIRN_FAULTS_WORKER) {
    std::vector<std::string> words = {program, "--connect", endpoint_};
    words.insert(words.end(), worker_more_.begin(), worker_more_.end());
    return workers_.emplace_back(words, folder_.path() / "worker.log");
  }
  void Submit() {
    client_.emplace(
        coordinator::Client::Connect({.endpoint = endpoint_, .security = security_, .timeout_s = 30})
            .value());
    const auto submitted = client_->Submit(work_, {{"log", log_}});
    ASSERT_TRUE(submitted.ok()) << submitted.status().message();
    job_ = submitted.value().id();
  }
  // How the job stands once `reached`, which must come within ten minutes.
  wire::JobInfo Await(const std::function<bool(const wire::JobInfo&)>& reached) {
    wire::JobInfo last;
    for (int i = 0; i < 60000; ++i) {
      const auto info = client_->Info(job_);
      if (info.ok() && reached(last = info.value())) return last;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "the job stands at " << last.ShortDebugString();
    return last;
  }
  wire::JobInfo AwaitRound(std::uint64_t round) {
    return Await(
        [round](const wire::JobInfo& info) { return info.round() >= round && info.tasks_done() > 0; });
  }
  void ExpectTheSameBits() {
    const wire::JobInfo end = Await(
        [](const wire::JobInfo& info) { return info.state() != "running" && info.state() != "queued"; });
    ASSERT_EQ(end.state(), "done") << end.reason();
    const auto results = client_->Results(job_);
    ASSERT_TRUE(results.ok()) << results.status().message();
    EXPECT_EQ(results.value().at(work_.name())->Without("provenance/").ContentHash(), want_);
  }
  std::string LogText(const char* file) const {
    std::ifstream in(folder_.path() / file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  // The newest checkpoint of the job.
  fs::path NewestCheckpoint() const {
    std::uint64_t newest = 0;
    const fs::path checkpoints = Store() / "checkpoints" / job_;
    for (const fs::directory_entry& entry : fs::directory_iterator(checkpoints))
      if (entry.path().extension() == ".h5")
        newest = std::max<std::uint64_t>(newest, std::stoull(entry.path().stem()));
    return checkpoints / (std::to_string(newest) + ".h5");
  }
  // Waits until the store holds one of this round or of a later one; returns of which.
  std::uint64_t AwaitCheckpoint(std::uint64_t round) {
    std::uint64_t held = 0;
    Await([&](const wire::JobInfo&) {
      if (!fs::exists(Store() / "checkpoints" / job_)) return false;
      const auto checkpoint = coordinator::ReadCheckpoint(NewestCheckpoint());
      if (checkpoint.ok()) held = checkpoint.value().round();
      return held >= round;
    });
    return held;
  }
  unsigned Connected() { return client_->List().value().workers; }

  wire::PrivateFolder folder_;
  std::string endpoint_ = folder_.Ipc("hub");
  std::optional<wire::ClientSecurity> security_;
  std::vector<std::string> coordinator_more_, worker_more_;  // arguments
  proto::Job work_ = ToyJob();                               // of one stage, of the same name
  BlobPtr log_;
  Hash want_;
  std::optional<Process> coordinator_;
  std::list<Process> workers_;
  std::optional<coordinator::Client> client_;
  std::string job_;
};

// On TCP, where everybody has a key.
class FaultsOnTcp : public Faults {
 protected:
  void SetUp() override {
    endpoint_ = wire::FreeTcpEndpoint();
    port_ = wire::PortOf(endpoint_);
    std::ofstream list(folder_.path() / "allowed");
    for (const auto& [name, role] : roles_) {
      keys_[name] = wire::GenerateKeyPair();
      list << keys_[name].public_key << " " << role << " " << name << "\n";
      ASSERT_TRUE(wire::WriteKeyPair(folder_.path() / name, keys_[name]).ok());
    }
    list << "end\n";
    list.close();
    ASSERT_TRUE(wire::WriteKeyPair(folder_.path() / "coordinator", server_).ok());
    const std::string keys = folder_.path().string();
    coordinator_more_.insert(coordinator_more_.end(), {"--keys", keys});
    worker_more_ = {"--key", keys + "/worker.key", "--server-key", keys + "/coordinator.pub"};
    security_ = wire::ClientSecurity{keys_["client"], server_.public_key};
    Faults::SetUp();
  }

  int port_ = 0;
  std::map<std::string, std::string> roles_ = {{"worker", "worker"}, {"client", "submitter"}};
  std::map<std::string, wire::KeyPair> keys_;
  const wire::KeyPair server_ = wire::GenerateKeyPair();
};

}  // namespace cairn::faults
