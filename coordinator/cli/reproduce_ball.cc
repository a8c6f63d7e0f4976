#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

#include "coordinator/cli/console.h"
#include "coordinator/cli/failure.h"
#include "coordinator/cli/programs.h"
#include "coordinator/cli/reproduce.h"
#include "coordinator/cli/scalar.h"
#include "coordinator/cli/stop_signal.h"
#include "datasets/reproduce/ball_figures.h"
#include "datasets/simulate_corridor.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string out = "reproduce-ball";
  std::uint64_t seed = 101;
  int seeds = 3;
  int steps = 500;
  int workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  bool force = false;
  bool json = false;
};

// One simulated set: its job, and what it found. A failure is told by `run`.
struct Outcome {
  coordinator::EmbeddedResult run;
  std::optional<datasets::BallScores> scores;
};

// Sets and seeds are jobs of their own, as many side by side as there are workers: a training's rounds follow
// one another, and one corridor's have nothing to wait for in another's.
class Study {
 public:
  Study(const Options& options, const Invocation& call)
      : options_(options), console_(call), stop_(StopOnSignals()) {
    for (int k = 0; k < options.seeds; ++k) {
      for (const std::string& set : datasets::CorridorSets())
        items_.push_back({set, options.seed + static_cast<std::uint64_t>(k)});
    }
    outcomes_.resize(items_.size());
  }

  // False once one failed; what, is in outcomes().
  void Run() {
    const std::size_t side_by_side = std::min(items_.size(), static_cast<std::size_t>(options_.workers));
    workers_each_ = options_.workers / static_cast<int>(side_by_side);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < side_by_side; ++t) threads.emplace_back([this] { Work(); });
    for (std::thread& thread : threads) thread.join();
    console_.Clear();
    if (failure_) std::rethrow_exception(failure_);
  }

  const std::vector<Outcome>& outcomes() const { return outcomes_; }

 private:
  struct Item {
    std::string set;
    std::uint64_t seed;
  };

  void Work() {
    while (!stop_ && !failed_) {
      const std::size_t next = next_++;
      if (next >= items_.size()) return;
      try {
        outcomes_[next] = RunItem(items_[next]);
        if (!outcomes_[next].scores) failed_ = true;
      } catch (...) {
        const std::lock_guard lock(mutex_);
        failure_ = std::current_exception();
        failed_ = true;
      }
    }
  }

  Outcome RunItem(const Item& item) {
    const datasets::BallJob ball =
        datasets::MakeBallJob(item.set, item.seed, datasets::DefaultBallRecipe(options_.steps));
    coordinator::EmbeddedOptions embedded;
    embedded.dir = (fs::path(options_.out) / "results" / ball.name).string();
    embedded.workers = workers_each_;
    embedded.worker_program = WorkerProgram();
    embedded.force = options_.force;
    embedded.log = [this](coordinator::Severity severity, const std::string& line) {
      const std::lock_guard lock(mutex_);
      console_.Log(severity, line);
    };
    const std::map<std::string, BlobPtr> inputs = {
        {"samples", std::make_shared<const Blob>(ball.samples.Without("truth/"))},
        {"training", std::make_shared<const Blob>(ball.training)}};
    Outcome outcome;
    outcome.run = coordinator::RunEmbedded(
        embedded, ball.job, inputs,
        [this](const coordinator::EmbeddedProgress& progress) {
          const std::lock_guard lock(mutex_);
          console_.Progress(progress.info);
        },
        stop_);
    if (!IsDone(outcome.run)) return outcome;
    WriteInputs(ball);
    outcome.scores = ScoreBallJob(ball, ReadResults(outcome.run));
    return outcome;
  }

  // Beside the results, so that each can be made again by hand.
  void WriteInputs(const datasets::BallJob& ball) const {
    const fs::path folder = fs::path(options_.out) / "inputs";
    fs::create_directories(folder);
    Check(WriteBlobFile((folder / (ball.name + ".h5")).string(), "samples", ball.samples));
    Check(WriteBlobFile((folder / (ball.name + "_training.h5")).string(), "samples", ball.training));
  }

  const Options& options_;
  Console console_;
  const std::atomic<bool>& stop_;
  std::vector<Item> items_;
  std::vector<Outcome> outcomes_;  // of each item
  int workers_each_ = 1;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;  // of the console and the failure
  std::exception_ptr failure_;
};

int Ball(const Options& options, const Invocation& call) {
  Study study(options, call);
  study.Run();
  std::vector<datasets::BallScores> scores;
  for (const Outcome& outcome : study.outcomes()) {
    if (!outcome.scores) continue;
    scores.push_back(*outcome.scores);
  }
  for (const Outcome& outcome : study.outcomes()) {
    if (!outcome.scores && (!outcome.run.reason.empty() || StopOnSignals()))
      return ExplainUndone(outcome.run);
  }
  PublishPage(options.out, "Bayesian landmark learning for mobile robot localization",
              "The tables and figures of Thrun (Machine Learning 33, 1998) from simulated corridors: seeds " +
                  std::to_string(options.seed) + " to " +
                  std::to_string(options.seed + static_cast<std::uint64_t>(options.seeds) - 1) +
                  ", each another corridor; trained on three runs, tested on the fourth. Intervals are 95% "
                  "over seeds.",
              datasets::BallFigures(scores), options.json);
  return kExitDone;
}

}  // namespace

void AddReproduceBall(CLI::App& reproduce, Invocation& call) {
  CLI::App* ball = nullptr;
  const auto options = AddCommand<Options>(
      reproduce, call, "ball", "Table 3 and figures 3 to 8 on learned landmarks, from simulated corridors",
      "cairn reproduce ball --seeds 5 --out ball", Ball, &ball);
  ball->add_option("--out", options->out,
                   "Folder of page, pictures, samples (inputs/) and results (results/)")
      ->capture_default_str();
  ball->add_option("--seed", options->seed, "The first corridor's")->check(CheckSeed)->capture_default_str();
  ball->add_option("--seeds", options->seeds, "Corridors, over which intervals are taken")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  ball->add_option("--steps", options->steps, "Gradient steps of each training")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  ball->add_option("--workers", options->workers, "Worker processes (as many as there are cores)")
      ->check(CLI::Range(1, 1024));
  ball->add_flag("--force", options->force, "Forget what an earlier run left in the folder");
  ball->add_flag("--json", options->json, "Pictures, claims, tables and measured figures as JSON");
}

}  // namespace cairn::cli
