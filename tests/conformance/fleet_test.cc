// In-process equals real workers under a real coordinator, bit for bit, whatever is killed on the way.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <functional>

#include "coordinator/local/embedded.h"
#include "pipelines/testing/in_process.h"
#include "schema/numerics.h"
#include "schema/rng.h"
#include "schema/store/blob_file.h"
#include "schema/wire/testing/private_folder.h"
#include "tests/conformance/cases.h"

namespace cairn::conformance {
namespace {

using coordinator::EmbeddedEnd;
using coordinator::EmbeddedProgress;
using coordinator::EmbeddedResult;

Hash InProcess(const Case& c) {
  FixNumericsOfProcess();
  FixNumericsOfThread();
  return RunInProcess(*Make(c.stage, c.seed), c.inputs)->ContentHash();
}

// One run into a folder; a stopped or killed one is gone on with by the next call.
class Fleet {
 public:
  Fleet(Case c, int workers) : case_(std::move(c)) {
    options_.dir = (folder_.path() / "out").string();
    options_.workers = workers;
    options_.worker_program = CAIRN_CONFORMANCE_WORKER;
    options_.checkpoint_interval_s = 0;
    options_.log = [this](coordinator::Severity, const std::string& line) { log_ += line + "\n"; };
  }
  EmbeddedResult Run(const std::function<void(const EmbeddedProgress&)>& on_progress = {}) {
    return coordinator::RunEmbedded(options_, JobOf(case_), case_.inputs, on_progress, stop);
  }
  Hash Stored() const {
    const Result<BlobFile> file = ReadBlobFile(options_.dir + "/stage.h5");
    CAIRN_DEMAND(file.ok(), file.status().message());
    return file.value().blob.Without("provenance/").ContentHash();
  }
  const std::string& log() const { return log_; }
  std::atomic<bool> stop{false};

 private:
  const Case case_;
  const wire::PrivateFolder folder_;
  coordinator::EmbeddedOptions options_;
  std::string log_;
};

class FleetConformance : public ::testing::TestWithParam<Case> {};

TEST_P(FleetConformance, AnyNumberOfWorkersEqualsInProcess) {
  const Hash expected = InProcess(GetParam());
  for (const int workers : {1, 3}) {
    Fleet fleet(GetParam(), workers);
    const EmbeddedResult result = fleet.Run();
    ASSERT_EQ(result.end, EmbeddedEnd::kDone) << result.reason << "\n" << fleet.log();
    EXPECT_EQ(fleet.Stored(), expected) << workers << " workers";
  }
}

INSTANTIATE_TEST_SUITE_P(AllPipelines, FleetConformance, ::testing::ValuesIn(AllCases()),
                         [](const auto& instance) { return instance.param.name; });

// A toy that takes long enough to be disturbed.
Case LongToy() {
  for (Case& c : AllCases()) {
    if (c.name != "toy") continue;
    (*c.stage.mutable_options())["rounds"].set_i(800);
    (*c.stage.mutable_options())["padding"].set_i(2000);
    return c;
  }
  CAIRN_DEMAND(false, "there is no toy");
}

std::vector<pid_t> Children() {
  std::ifstream file("/proc/self/task/" + std::to_string(::getpid()) + "/children");
  std::vector<pid_t> pids;
  for (pid_t pid = 0; file >> pid;) pids.push_back(pid);
  return pids;
}

TEST(FleetFaults, KilledWorkersChangeNothing) {
  Fleet fleet(LongToy(), 3);
  Rng rng(5);
  int kills = 0;
  const EmbeddedResult result = fleet.Run([&](const EmbeddedProgress&) {
    const std::vector<pid_t> workers = Children();
    if (kills == 5 || workers.empty()) return;
    ::kill(workers[rng.Below(workers.size())], SIGKILL);
    ++kills;
  });
  ASSERT_EQ(result.end, EmbeddedEnd::kDone) << result.reason << "\n" << fleet.log();
  EXPECT_GE(kills, 2);
  EXPECT_EQ(fleet.Stored(), InProcess(LongToy()));
}

TEST(FleetFaults, StoppedAndResumedEqualsUndisturbed) {
  Fleet fleet(LongToy(), 2);
  unsigned stops = 0;
  EmbeddedResult result;
  do {
    fleet.stop = false;
    result = fleet.Run([&](const EmbeddedProgress& progress) {
      if (stops < 3 && progress.info.round() > 100u * (stops + 1u)) fleet.stop = true;
    });
    if (result.end == EmbeddedEnd::kStopped) ++stops;
  } while (result.end == EmbeddedEnd::kStopped);
  ASSERT_EQ(result.end, EmbeddedEnd::kDone) << result.reason << "\n" << fleet.log();
  EXPECT_TRUE(result.resumed);
  EXPECT_GE(stops, 1u);
  EXPECT_EQ(fleet.Stored(), InProcess(LongToy()));
}

TEST(FleetFaults, KilledWholeAndResumedEqualsUndisturbed) {
  Fleet fleet(LongToy(), 2);
  int kills = 0;
  for (std::uint64_t round : {0u, 100u, 250u, 500u}) {
    constexpr int kEnded = 0, kRefused = 1;
    int status = 0;
    do {  // again where a worker that the one before had forked, and that is not yet itself, still holds its
          // lock
      const pid_t child = ::fork();
      if (child == 0) {
        const EmbeddedResult result = fleet.Run([round](const EmbeddedProgress& progress) {
          if (progress.info.round() >= round) ::raise(SIGKILL);
        });
        ::_exit(result.reason.find("in use by another") == std::string::npos ? kEnded : kRefused);
      }
      ASSERT_EQ(::waitpid(child, &status, 0), child);
    } while (WIFEXITED(status) && WEXITSTATUS(status) == kRefused);
    kills += WIFSIGNALED(status) ? 1 : 0;
  }
  const EmbeddedResult result = fleet.Run();
  ASSERT_TRUE(result.end == EmbeddedEnd::kDone || result.end == EmbeddedEnd::kAlreadyDone)
      << result.reason << "\n"
      << fleet.log();
  EXPECT_GE(kills, 2);
  EXPECT_EQ(fleet.Stored(), InProcess(LongToy()));
}

}  // namespace
}  // namespace cairn::conformance
