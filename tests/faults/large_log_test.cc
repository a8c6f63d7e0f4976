// A log that goes over the wire in parts: whoever dies in the middle of them, the result has the same bits;
// it goes there once, and not at all where it is seen in a folder.
#include <gtest/gtest.h>

#include "pipelines/common/testing_room.h"
#include "pipelines/evidence_map/evidence_map.h"
#include "schema/wire/testing/relay.h"
#include "tests/faults/service_fixture.h"

namespace cairn::faults {
namespace {

// More than the log without its ranges and all that is said of it, and less than the log.
constexpr std::uint64_t kInTheMiddle = 2'000'000;

class LargeLog : public FaultsOnTcp {
 protected:
  void SetUp() override {
    FaultsOnTcp::SetUp();
    log_ = std::make_shared<const Blob>(Room{.scans = 3000, .beams = 180}.Log());
    work_ = {};
    work_.set_name("map");
    work_.set_seed(7);
    proto::Stage& stage = *work_.add_stages();
    stage.set_name("map");
    stage.set_pipeline("evidence_map");
    (*stage.mutable_inputs())["log"] = "log";
    want_ = RunInProcess(evidence_map::EvidenceMap({}, 7), {{"log", log_}})->ContentHash();
    relay_.emplace(port_);
  }
  Process& AddWorkerBehindRelay() {
    const std::string direct = std::exchange(endpoint_, relay_->endpoint());
    Process& worker = AddWorker();
    endpoint_ = direct;
    return worker;
  }
  // Until the worker has been sent some of the parts and not the others.
  void AwaitTheMiddle() {
    const wire::JobInfo info =
        Await([this](const wire::JobInfo& info) { return relay_->stalled && info.tasks() > 0; });
    EXPECT_EQ(info.round(), 0u);
    EXPECT_EQ(info.tasks_done(), 0u);
  }
  double LogsPassed() const {
    return static_cast<double>(relay_->passed) / static_cast<double>(log_->ByteCount());
  }
  fs::path FlatFile() const { return Store() / "blobs" / (log_->ContentHash().Hex() + ".flat"); }

  std::optional<wire::StallingRelay> relay_;
};

TEST_F(LargeLog, AWorkerThatIsKilledInTheMiddleOfFetchingPartsChangesNothing) {
  relay_->most = kInTheMiddle;
  Process& victim = AddWorkerBehindRelay();
  Submit();
  AwaitTheMiddle();
  victim.Kill();
  relay_->Break();
  AddWorker();
  ExpectTheSameBits();
}

TEST_F(LargeLog, ACoordinatorThatIsKilledWhilePartsAreFetchedGoesOnWithTheSameWorker) {
  relay_->most = kInTheMiddle;
  AddWorkerBehindRelay();
  Submit();
  AwaitTheMiddle();
  coordinator_->Kill();
  StartCoordinator();
  relay_->Break();
  ExpectTheSameBits();
}

TEST_F(LargeLog, GoesToAWorkerOnceThoughTwoRoundsReadIt) {
  AddWorkerBehindRelay();
  Submit();
  ExpectTheSameBits();
  EXPECT_GT(LogsPassed(), 0.9);
  EXPECT_LT(LogsPassed(), 1.2);
}

TEST_F(LargeLog, DoesNotGoToAWorkerThatSeesItInAFolder) {
  worker_more_.insert(worker_more_.end(), {"--shared-path", (Store() / "blobs").string()});
  AddWorkerBehindRelay();
  Submit();
  ExpectTheSameBits();
  EXPECT_LT(LogsPassed(), 0.1);
}

TEST_F(LargeLog, WhatIsDamagedInTheFolderComesOverTheWire) {
  Submit();
  const fs::path copies = folder_.path() / "copies", copy = copies / FlatFile().filename();
  fs::create_directory(copies);
  fs::copy_file(FlatFile(), copy);
  std::fstream(copy, std::ios::in | std::ios::out | std::ios::binary).seekp(1'000'000).put(77);
  worker_more_.insert(worker_more_.end(), {"--shared-path", copies.string()});
  AddWorkerBehindRelay();
  ExpectTheSameBits();
  EXPECT_GT(LogsPassed(), 0.9);
  EXPECT_NE(LogText("worker.log").find(copy.string()), std::string::npos);
}

}  // namespace
}  // namespace cairn::faults
