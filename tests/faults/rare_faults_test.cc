// What seldom happens to real processes: a task that hangs, a flipped byte, a lost table, a second
// coordinator, a worker of another version, an end in the middle.
#include <gtest/gtest.h>

#include "tests/faults/service_fixture.h"

namespace cairn::faults {
namespace {

TEST_F(Faults, AWorkerWhoseTaskHangsWhileItsHeartbeatsGoOnChangesNothing) {
  const fs::path hang = folder_.path() / "hang";
  ::setenv("CAIRN_HANG_FILE", hang.c_str(), 1);
  AddWorker();
  AddWorker();
  ::unsetenv("CAIRN_HANG_FILE");
  Submit();
  AwaitRound(kRounds - 3);
  std::ofstream(hang) << "x";
  ExpectTheSameBits();
  EXPECT_FALSE(fs::exists(hang)) << "no worker has hung";
  EXPECT_EQ(Connected(), 2u) << "its heartbeats go on";
}

TEST_F(Faults, ACheckpointWithFlippedBytesIsQuarantinedAndTheOneBeforeIsUsed) {
  AddWorker();
  Submit();
  AwaitRound(4);
  coordinator_->Kill();
  const fs::path damaged = NewestCheckpoint();
  {
    std::fstream file(damaged, std::ios::in | std::ios::out | std::ios::binary);
    const auto middle = static_cast<std::streamoff>(fs::file_size(damaged) / 2);
    file.seekg(middle);
    const int byte = file.get();
    file.seekp(middle);
    file.put(static_cast<char>(byte ^ 0x20));
  }
  StartCoordinator();
  ExpectTheSameBits();
  EXPECT_TRUE(fs::exists(damaged.string() + ".damaged"));
  EXPECT_NE(LogText("coordinator.log").find("its bytes are not those that were written"), std::string::npos);
}

TEST_F(Faults, ATruncatedJobTableIsMadeAnewFromTheCheckpoints) {
  AddWorker();
  Submit();
  AwaitRound(2);
  coordinator_->Signal(SIGTERM);  // so that SQLite folds its journal into the table
  ASSERT_EQ(coordinator_->Wait(), 0);
  const fs::path table = Store() / "jobs.sqlite";
  ASSERT_GT(fs::file_size(table), 5000u);
  fs::resize_file(table, 5000);
  StartCoordinator();
  ExpectTheSameBits();
  EXPECT_NE(LogText("coordinator.log").find("made the job table anew"), std::string::npos);
}

TEST_F(Faults, ASecondCoordinatorOnOneStoreRefuses) {
  AddWorker();
  Submit();
  AwaitRound(1);
  Process second(
      {CAIRN_PROGRAM, "coordinator", "--store", Store().string(), "--listen", folder_.Ipc("other")},
      folder_.path() / "second.log");
  EXPECT_EQ(second.Wait(), 2);
  EXPECT_NE(LogText("second.log").find("is in use by another cairn process"), std::string::npos)
      << LogText("second.log");
  ExpectTheSameBits();
}

TEST_F(Faults, AWorkerOfAnotherVersionIsToldSoAndLeavesThoughItCameFirst) {
  Process& old = AddWorker(CAIRN_FAULTS_WORKER_OLD);
  EXPECT_EQ(old.Wait(), 2);
  const std::string log = LogText("worker.log");
  EXPECT_NE(log.find("refused: "), std::string::npos) << log;
  EXPECT_NE(log.find("0.0.1"), std::string::npos) << log;
  AddWorker();
  Submit();
  const coordinator::JobList list = client_->List().value();
  EXPECT_EQ(list.refused.contains("build") ? list.refused.at("build") : 0, 1u);
  AwaitRound(1);
  EXPECT_EQ(AddWorker(CAIRN_FAULTS_WORKER_OLD).Wait(), 2);
  ExpectTheSameBits();
}

// The time that it takes is printed, not asserted: cairn promises two seconds on a machine that is not
// overloaded.
TEST_F(Faults, SignalsEndAWorkerAndACoordinatorCleanlyAndTheNextGoOn) {
  for (const int number : {SIGINT, SIGTERM}) {
    Process& worker = AddWorker();
    if (number == SIGINT) Submit();
    AwaitRound(number == SIGINT ? 1 : 4);
    const auto begin = std::chrono::steady_clock::now();
    coordinator_->Signal(number);
    EXPECT_EQ(coordinator_->Wait(), 0);
    worker.Signal(number);
    EXPECT_EQ(worker.Wait(), 0);
    std::cout << "both ended in "
              << std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() << " s\n";
    StartCoordinator();
  }
  AddWorker();
  ExpectTheSameBits();
}

TEST_F(Faults, AWorkerThatDrainsFinishesWhatItRunsAndLeavesAndNothingChanges) {
  Process& drained = AddWorker();
  Submit();
  AwaitRound(1);
  const auto told = client_->Drain(0);
  ASSERT_TRUE(told.ok()) << told.status().message();
  ASSERT_EQ(told.value().size(), 1u);
  EXPECT_EQ(told.value()[0].state(), "draining");
  EXPECT_EQ(drained.Wait(), 0);
  Process& terminated = workers_.emplace_back(
      std::vector<std::string>{CAIRN_FAULTS_WORKER, "--connect", endpoint_, "--drain-s", "60"},
      folder_.path() / "worker.log");
  AwaitRound(4);
  terminated.Signal(SIGTERM);
  EXPECT_EQ(terminated.Wait(), 0);
  EXPECT_NE(LogText("worker.log").find("leaves: finishes what it runs"), std::string::npos);
  AddWorker();
  ExpectTheSameBits();
  EXPECT_EQ(client_->Info(job_).value().retries(), 0u) << "nobody is to blame";
}

}  // namespace
}  // namespace cairn::faults
