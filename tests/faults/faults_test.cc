// Real processes that are killed, stopped, added late or find damaged files: the result has the same bits
// each time.
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <list>
#include <optional>
#include <thread>

#include "coordinator/client.h"
#include "pipelines/in_process.h"
#include "schema/wire/testing.h"
#include "tests/faults/process.h"
#include "worker/testing/toy_pipeline.h"

namespace cairn::faults {
namespace {

namespace fs = std::filesystem;

constexpr int kRounds = 12, kSlices = 12;
constexpr const char* kTaskMs = "25";  // about 4 s of work

proto::Job ToyJob() {
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
    coordinator_.emplace(std::vector<std::string>{CAIRN_PROGRAM, "coordinator", "--store", Store().string(),
                                                  "--listen", endpoint_, "--checkpoint-interval", "0.2"},
                         folder_.path() / "coordinator.log");
  }
  Process& AddWorker() {
    return workers_.emplace_back(std::vector<std::string>{CAIRN_FAULTS_WORKER, "--connect", endpoint_},
                                 folder_.path() / "worker.log");
  }
  void Submit() {
    client_.emplace(
        coordinator::Client::Connect({.endpoint = endpoint_, .security = {}, .timeout_s = 30}).value());
    const auto submitted = client_->Submit(ToyJob(), {{"log", log_}});
    ASSERT_TRUE(submitted.ok()) << submitted.status().message();
    job_ = submitted.value().id();
  }
  // How the job stands once `reached`, which must come within two minutes.
  wire::JobInfo Await(const std::function<bool(const wire::JobInfo&)>& reached) {
    wire::JobInfo last;
    for (int i = 0; i < 12000; ++i) {
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
    EXPECT_EQ(results.value().at("toy")->Without("provenance/").ContentHash(), want_);
  }
  std::string LogText(const char* file) const {
    std::ifstream in(folder_.path() / file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  unsigned Connected() { return client_->List().value().workers; }

  wire::PrivateFolder folder_;
  const std::string endpoint_ = folder_.Ipc("hub");
  BlobPtr log_;
  Hash want_;
  std::optional<Process> coordinator_;
  std::list<Process> workers_;
  std::optional<coordinator::Client> client_;
  std::string job_;
};

TEST_F(Faults, AWorkerThatIsKilledChangesNothing) {
  Process& victim = AddWorker();
  AddWorker();
  Submit();
  AwaitRound(1);
  victim.Kill();
  ASSERT_NE(Await([](const auto&) { return true; }).state(), "done") << "it was killed too late to matter";
  ExpectTheSameBits();
}

TEST_F(Faults, EveryWorkerKilledAndReplacedChangesNothing) {
  AddWorker();
  AddWorker();
  Submit();
  AwaitRound(2);
  workers_.clear();
  AddWorker();
  ExpectTheSameBits();
}

TEST_F(Faults, AWorkerThatIsAddedLateTakesPartAndChangesNothing) {
  AddWorker();
  Submit();
  AwaitRound(1);
  AddWorker();
  Await([this](const auto&) { return Connected() == 2; });
  ExpectTheSameBits();
  EXPECT_EQ(client_->Results(job_).value().at("toy")->Scalar<std::int64_t>("provenance/workers"), 2);
}

TEST_F(Faults, AWorkerThatIsStoppedLosesItsTasksAndComesBack) {
  Process& victim = AddWorker();
  AddWorker();
  Submit();
  AwaitRound(1);
  victim.Signal(SIGSTOP);
  ExpectTheSameBits();
  victim.Signal(SIGCONT);
  Await([this](const auto&) { return Connected() == 2; });
}

TEST_F(Faults, ACoordinatorThatIsKilledAndStartedAgainGoesOn) {
  AddWorker();
  AddWorker();
  Submit();
  for (const std::uint64_t round : {2, 4, 6}) {
    AwaitRound(round);
    coordinator_->Kill();
    StartCoordinator();
    const wire::JobInfo back = Await([](const wire::JobInfo& info) { return !info.id().empty(); });
    EXPECT_GE(back.round() + 2, round) << "no more than about a second's work is done again";
  }
  ExpectTheSameBits();
}

TEST_F(Faults, ADamagedCheckpointIsSetAsideAndTheOneBeforeIsUsed) {
  AddWorker();
  AddWorker();
  Submit();
  AwaitRound(4);
  coordinator_->Kill();
  std::uint64_t newest = 0;
  const fs::path checkpoints = Store() / "checkpoints" / job_;
  for (const fs::directory_entry& entry : fs::directory_iterator(checkpoints))
    if (entry.path().extension() == ".h5")
      newest = std::max<std::uint64_t>(newest, std::stoull(entry.path().stem()));
  const fs::path damaged = checkpoints / (std::to_string(newest) + ".h5");
  fs::resize_file(damaged, fs::file_size(damaged) / 2);
  StartCoordinator();
  ExpectTheSameBits();
  EXPECT_TRUE(fs::exists(damaged.string() + ".damaged"));
  EXPECT_NE(LogText("coordinator.log").find(damaged.string()), std::string::npos);
}

TEST_F(Faults, AnEndedServiceSaysByeAndItsJobsGoOnWithTheNext) {
  AddWorker();
  Submit();
  AwaitRound(3);
  coordinator_->Signal(SIGTERM);
  EXPECT_EQ(coordinator_->Wait(), 0);
  StartCoordinator();
  EXPECT_GE(Await([](const wire::JobInfo& info) { return !info.id().empty(); }).round(), 3u);
  ExpectTheSameBits();
  EXPECT_NE(LogText("worker.log").find("the coordinator has ended"), std::string::npos);
}

// Undone with the object.
class SmallDisk {
 public:
  explicit SmallDisk(const fs::path& path) : path_(path) {
    fs::create_directories(path);
    mounted_ = ::mount("tmpfs", path.c_str(), "tmpfs", 0, "size=2m") == 0;
  }
  ~SmallDisk() {
    if (mounted_) ::umount2(path_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return mounted_; }
  void Fill() const {
    std::ofstream filler(path_ / "filler", std::ios::binary);
    const std::string page(4096, 'x');
    while (filler.write(page.data(), static_cast<std::streamsize>(page.size())).flush()) {
    }
  }
  void Free() const { fs::remove(path_ / "filler"); }

 private:
  const fs::path path_;
  bool mounted_ = false;
};

TEST_F(Faults, AFullDiskPausesTheJobAndResumeGoesOn) {
  coordinator_->Kill();
  fs::remove_all(Store());
  const SmallDisk disk(Store());
  if (!disk.mounted()) GTEST_SKIP() << "may not mount a small disk here";
  StartCoordinator();
  AddWorker();
  Submit();
  AwaitRound(1);
  disk.Fill();
  const wire::JobInfo paused = Await([](const wire::JobInfo& info) { return info.state() == "paused"; });
  EXPECT_NE(paused.reason().find("no space left"), std::string::npos) << paused.reason();
  disk.Free();
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(Store()))
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
  ASSERT_TRUE(client_->Resume(job_).ok());
  ExpectTheSameBits();
  coordinator_->Kill();  // before its disk goes
}

}  // namespace
}  // namespace cairn::faults
