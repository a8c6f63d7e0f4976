#include "tests/faults/chaos.h"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>
#include <vector>

#include "coordinator/client.h"
#include "datasets/inspect/diff.h"
#include "pipelines/testing/in_process.h"
#include "schema/numerics.h"
#include "schema/rng.h"
#include "tests/conformance/cases.h"
#include "tests/faults/process.h"

namespace cairn::faults {
namespace {

constexpr double kPatience_s = 180;  // without a job that ends: something is lost

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct JobUnderWay {
  const conformance::Case* c = nullptr;
  std::string id;
  BlobPtr want;
  double since_s = 0;
};

class Chaos {
 public:
  Chaos(const ChaosOptions& options, std::filesystem::path folder)
      : options_(options),
        folder_(std::move(folder)),
        endpoint_("ipc://" + (folder_ / "hub").string()),
        rng_(options.seed),
        cases_(conformance::AllCases()),
        client_(
            coordinator::Client::Connect({.endpoint = endpoint_, .security = {}, .timeout_s = 5}).value()) {}

  ChaosReport Run() {
    FixNumericsOfProcess();
    FixNumericsOfThread();
    StartCoordinator();
    for (int i = 0; i < options_.workers; ++i) workers_.push_back(StartWorker());
    const double end_s = Now() + options_.seconds;
    double next_fault_s = Now() + options_.every_s;
    progress_s_ = Now();
    while (report_.problem.empty() && (Now() < end_s || !under_way_.empty())) {
      const bool on = Now() < end_s;
      while (on && static_cast<int>(under_way_.size()) < options_.jobs && report_.problem.empty()) Submit();
      if (on && Now() >= next_fault_s) {
        Hurt();
        next_fault_s = Now() + options_.every_s * rng_.Uniform(0.5, 1.5);
      }
      if (!on) LetGoOn();
      Look();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return report_;
  }

 private:
  void StartCoordinator() {
    coordinator_.emplace(
        std::vector<std::string>{CAIRN_PROGRAM, "coordinator", "--store", (folder_ / "store").string(),
                                 "--listen", endpoint_, "--checkpoint-interval", "0.2"},
        folder_ / "coordinator.log");
  }
  Process StartWorker() {
    return Process({CAIRN_FAULTS_WORKER, "--connect", endpoint_}, folder_ / "worker.log");
  }

  void Submit() {
    const conformance::Case& c = cases_[next_case_ % cases_.size()];
    proto::Job job = conformance::JobOf(c);
    job.set_seed(next_case_);  // each job is another
    const auto info = client_.Submit(job, c.inputs);
    if (!info.ok() && info.status().code() == Code::kIo) {
      ++report_.submitted_again;
      return Hasten("nobody takes a job");
    }
    if (!info.ok()) return Fail("a job was refused: " + info.status().message());
    const std::uint64_t seed = next_case_++;
    under_way_.push_back(
        {&c, info.value().id(), RunInProcess(*conformance::Make(c.stage, seed), c.inputs), Now()});
  }

  void Look() {
    NoteMemory();
    for (auto it = under_way_.begin(); it != under_way_.end();) {
      const auto info = client_.Info(it->id);
      if (!info.ok() && info.status().code() != Code::kIo)
        return Fail("job " + it->id + " is lost: " + info.status().message());
      if (!info.ok()) return Hasten("nobody answers");
      const std::string& state = info.value().state();
      if (state == "running" || state == "queued") {
        ++it;
        continue;
      }
      if (state != "done") return Fail("job " + it->id + " is " + state + ": " + info.value().reason());
      const auto results = client_.Results(it->id);
      if (!results.ok() && results.status().code() == Code::kIo) return Hasten("nobody gives a result");
      if (!results.ok()) return Fail("job " + it->id + ": " + results.status().message());
      Compare(*it, *results.value().at("stage"));
      it = under_way_.erase(it);
    }
    if (!under_way_.empty()) Hasten("no job ends");
  }

  // As `cairn diff` compares.
  void Compare(const JobUnderWay& job, const Blob& result) {
    for (const datasets::ArrayDifference& difference :
         datasets::DiffBlobs(job.want->Without("provenance/"), result.Without("provenance/")))
      Fail("job " + job.id + " (" + job.c->name + "): " + difference.name + ": " + difference.what);
    ++report_.done[job.c->name];
    report_.longest_job_s = std::max(report_.longest_job_s, Now() - job.since_s);
    progress_s_ = Now();
  }

  void Hurt() {
    LetGoOn();
    const std::size_t victim = rng_.Below(workers_.size());
    switch (rng_.Below(8)) {
      case 0:
        ++report_.faults["coordinator killed"];
        coordinator_->Kill();
        return StartCoordinator();
      case 1:
        ++report_.faults["coordinator ended and started"];
        coordinator_->Signal(SIGTERM);
        if (const int code = coordinator_->Wait(); code != 0)
          Fail("a coordinator that was told to end gave " + std::to_string(code));
        return StartCoordinator();
      case 2:
        ++report_.faults["all killed"];
        coordinator_->Kill();
        for (Process& worker : workers_) worker = StartWorker();
        return StartCoordinator();
      case 3:
        ++report_.faults["worker stopped for a while"];
        workers_[victim].Signal(SIGSTOP);
        stopped_ = victim;
        return;
      default:
        ++report_.faults["worker killed"];
        workers_[victim] = StartWorker();
    }
  }
  // What was stopped goes on, with answers that may be late.
  void LetGoOn() {
    if (stopped_) workers_[*stopped_].Signal(SIGCONT);
    stopped_.reset();
  }

  void NoteMemory() {
    std::ifstream status("/proc/" + std::to_string(coordinator_->pid()) + "/status");
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("VmHWM:"))
        report_.coordinator_most_kb = std::max(report_.coordinator_most_kb, std::atol(line.c_str() + 6));
  }

  void Hasten(const std::string& what) {
    if (Now() - progress_s_ > kPatience_s) Fail(what + " for " + std::to_string(kPatience_s) + " s");
  }
  void Fail(const std::string& problem) {
    if (report_.problem.empty()) report_.problem = problem;
  }

  const ChaosOptions options_;
  const std::filesystem::path folder_;
  const std::string endpoint_;
  Rng rng_;
  const std::vector<conformance::Case> cases_;
  coordinator::Client client_;
  std::optional<Process> coordinator_;
  std::vector<Process> workers_;
  std::optional<std::size_t> stopped_;
  std::vector<JobUnderWay> under_way_;
  std::uint64_t next_case_ = 0;
  double progress_s_ = 0;  // when a job last ended
  ChaosReport report_;
};

}  // namespace

ChaosReport RunChaos(const ChaosOptions& options, const std::string& folder) {
  return Chaos(options, folder).Run();
}

}  // namespace cairn::faults
