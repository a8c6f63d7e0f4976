// Real processes that are killed, stopped, added late or find damaged files: the result has the same bits
// each time.
#include <gtest/gtest.h>
#include <sys/mount.h>

#include "tests/faults/service_fixture.h"

namespace cairn::faults {
namespace {

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

TEST_F(Faults, ACoordinatorThatIsKilledAndStartedAgainGoesOnFromItsCheckpoint) {
  coordinator_more_ = {"--checkpoint-rounds", "1"};
  coordinator_->Kill();
  StartCoordinator();
  AddWorker();
  AddWorker();
  Submit();
  for (const std::uint64_t round : {2, 4, 6}) {
    const std::uint64_t held = AwaitCheckpoint(round);
    coordinator_->Kill();
    StartCoordinator();
    const wire::JobInfo back = Await([](const wire::JobInfo& info) { return !info.id().empty(); });
    EXPECT_GE(back.round(), held);
  }
  ExpectTheSameBits();
}

TEST_F(Faults, ADamagedCheckpointIsQuarantinedAndTheOneBeforeIsUsed) {
  AddWorker();
  AddWorker();
  Submit();
  AwaitRound(4);
  coordinator_->Kill();
  const fs::path damaged = NewestCheckpoint();
  fs::resize_file(damaged, fs::file_size(damaged) / 2);
  StartCoordinator();
  ExpectTheSameBits();
  EXPECT_TRUE(fs::exists(damaged.string() + ".damaged"));
  EXPECT_NE(LogText("coordinator.log").find(damaged.string()), std::string::npos);
}

TEST_F(Faults, AnEndedServiceSendsLeaveAndItsJobsGoOnWithTheNext) {
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
  ASSERT_TRUE(client_->Command(job_, "resume").ok());
  ExpectTheSameBits();
  coordinator_->Kill();  // before its disk goes
}

TEST_F(Faults, AnInputThatDoesNotFitOnTheDiskIsRefusedWithTheReasonAndLeavesNothing) {
  coordinator_->Kill();
  fs::remove_all(Store());
  const SmallDisk disk(Store());
  if (!disk.mounted()) GTEST_SKIP() << "may not mount a small disk here";
  StartCoordinator();
  Blob large;
  large.PutVector("values", std::vector<double>(1'000'000, 1));
  auto client =
      coordinator::Client::Connect({.endpoint = endpoint_, .security = {}, .timeout_s = 30}).value();
  const Status refused =
      client.Submit(ToyJob(), {{"log", std::make_shared<const Blob>(std::move(large))}}).status();
  EXPECT_EQ(refused.code(), Code::kNoSpace);
  EXPECT_NE(refused.message().find("no space left"), std::string::npos) << refused.message();
  EXPECT_TRUE(fs::is_empty(Store() / "uploads"));
  EXPECT_TRUE(fs::is_empty(Store() / "blobs"));
  EXPECT_TRUE(client.List().value().jobs.empty());
  coordinator_->Kill();  // before its disk goes
}

}  // namespace
}  // namespace cairn::faults
