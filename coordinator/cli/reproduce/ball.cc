#include <algorithm>
#include <atomic>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/programs.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/common/stop_signal.h"
#include "coordinator/cli/output/console.h"
#include "coordinator/cli/output/pages.h"
#include "coordinator/cli/reproduce/reproduce.h"
#include "datasets/reproduce/ball/active.h"
#include "datasets/reproduce/ball/adapt.h"
#include "datasets/reproduce/ball/figures.h"
#include "datasets/reproduce/ball/variants.h"
#include "datasets/simulate/corridor/corridor.h"
#include "schema/kinds/kind.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct ReproduceBallArguments {
  std::string out = "reproduce-ball";
  std::string study = "paper";
  std::uint64_t seed = 101;
  int seeds = 3;
  int steps = 500;
  int workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  bool force = false;
  bool json = false;
};

using BallResults = std::map<std::string, Blob>;

// A study's jobs: how number k is made, and what becomes of its results. All run on several threads at once.
struct Study {
  std::size_t jobs = 0;
  std::function<datasets::BallJob(std::size_t k)> make;
  // A second job, of the first's results; may be empty.
  std::function<datasets::BallJob(const datasets::BallJob& first, const BallResults&)> then;
  std::function<void(std::size_t k, const datasets::BallJob&, const BallResults&)> score;
};

// Jobs run side by side, as many as there are workers: a training's rounds follow one another, and one
// corridor's have nothing to wait for in another's.
class StudyRun {
 public:
  StudyRun(const ReproduceBallArguments& options, const Invocation& call, const Study& study)
      : options_(options), study_(study), console_(call), stop_(StopOnSignals()) {}

  // What the first job that is not done says of it; nothing where all are done and scored.
  std::optional<coordinator::EmbeddedResult> Run() {
    const std::size_t side_by_side = std::min(study_.jobs, static_cast<std::size_t>(options_.workers));
    workers_each_ = options_.workers / static_cast<int>(side_by_side);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < side_by_side; ++t) threads.emplace_back([this] { Work(); });
    for (std::thread& thread : threads) thread.join();
    console_.Clear();
    if (failure_) std::rethrow_exception(failure_);
    if (stop_ && !undone_) undone_.emplace().end = coordinator::EmbeddedEnd::kStopped;
    return undone_;
  }

 private:
  void Work() {
    while (!stop_ && !failed_) {
      const std::size_t next = next_++;
      if (next >= study_.jobs) return;
      try {
        RunJob(next);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        failure_ = std::current_exception();
        failed_ = true;
      }
    }
  }

  void RunJob(std::size_t k) {
    const datasets::BallJob ball = study_.make(k);
    std::optional<BallResults> results = ResultsOf(ball);
    if (results && study_.then) {
      const std::optional<BallResults> more = ResultsOf(study_.then(ball, *results));
      if (!more) return;
      results->insert(more->begin(), more->end());
    }
    if (results) study_.score(k, ball, *results);
  }

  // None where the job is not done: undone_ then says why.
  std::optional<BallResults> ResultsOf(const datasets::BallJob& ball) {
    coordinator::EmbeddedOptions embedded;
    embedded.dir = (fs::path(options_.out) / "results" / ball.name).string();
    embedded.workers = workers_each_;
    embedded.worker_program = WorkerProgram();
    embedded.force = options_.force;
    embedded.log = [this](coordinator::Severity severity, const std::string& line) {
      const std::lock_guard lock(mutex_);
      console_.Log(severity, line);
    };
    std::map<std::string, BlobPtr> inputs;
    for (const auto& [name, path] : ball.job.inputs())
      inputs[name] = std::make_shared<const Blob>(ball.inputs.at(name).Without("truth/"));
    const coordinator::EmbeddedResult run = coordinator::RunEmbedded(
        embedded, ball.job, inputs,
        [this](const coordinator::EmbeddedProgress& progress) {
          const std::lock_guard lock(mutex_);
          console_.Progress(progress.info);
        },
        stop_);
    if (IsDone(run)) {
      WriteInputs(ball);
      return ReadResults(run);
    }
    const std::lock_guard lock(mutex_);
    failed_ = true;
    if (!undone_) undone_ = run;
    return std::nullopt;
  }

  // Beside the results, so that each can be made again by hand.
  void WriteInputs(const datasets::BallJob& ball) const {
    const fs::path folder = fs::path(options_.out) / "inputs";
    fs::create_directories(folder);
    for (const auto& [name, blob] : ball.inputs) {
      const std::string file = ball.name + "_" + name + ".h5";
      Check(WriteBlobFile((folder / file).string(), KindOf(blob), blob));
    }
  }

  const ReproduceBallArguments& options_;
  const Study& study_;
  Console console_;
  const std::atomic<bool>& stop_;
  int workers_each_ = 1;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;  // of all below, and of the console
  std::optional<coordinator::EmbeddedResult> undone_;
  std::exception_ptr failure_;
};

// Number k of the jobs for each set of each seed.
struct SetAndSeed {
  SetAndSeed(const ReproduceBallArguments& options, std::size_t k)
      : set(datasets::CorridorSets()[k % 3]), seed(options.seed + k / 3) {}
  std::string set;
  std::uint64_t seed;
};

// Runs a study, then makes and shows its figures of the scores.
template <class Scores, class Make, class Score, class Figures>
int RunStudy(
    const ReproduceBallArguments& options, const Invocation& call, std::size_t jobs, const Make& make,
    const Score& score, const Figures& figures,
    const std::function<datasets::BallJob(const datasets::BallJob&, const BallResults&)>& then = {}) {
  std::vector<Scores> scores(jobs);
  Study study{jobs, make, then,
              [&](std::size_t k, const datasets::BallJob& ball, const BallResults& results) {
                scores[k] = score(ball, results);
              }};
  if (const auto undone = StudyRun(options, call, study).Run()) return ExplainUndone(*undone);
  const std::uint64_t last = options.seed + static_cast<std::uint64_t>(options.seeds) - 1;
  PublishPage(options.out, "Bayesian landmark learning for mobile robot localization",
              "From simulated corridors, after Thrun (Machine Learning 33, 1998): seeds " +
                  std::to_string(options.seed) + " to " + std::to_string(last) +
                  ", each another corridor; trained on three runs, tested on the fourth. Intervals are 95% "
                  "over seeds.",
              figures(scores), options.json);
  return kExitDone;
}

int Paper(const ReproduceBallArguments& options, const Invocation& call) {
  return RunStudy<datasets::BallScores>(
      options, call, 3 * static_cast<std::size_t>(options.seeds),
      [&](std::size_t k) {
        const SetAndSeed at(options, k);
        return datasets::MakeBallJob(at.set, at.seed, datasets::PaperBallRecipe(options.steps));
      },
      datasets::ScoreBallJob, datasets::BallFigures);
}

int Variants(const ReproduceBallArguments& options, const Invocation& call) {
  const bool sensors = options.study == "sensors";
  const auto variants = sensors ? datasets::SensorVariants() : datasets::TrainingVariants(options.steps);
  const datasets::PaperFigure figure{
      .file = {},
      .title = sensors ? "Section 7: sensor selection, n = 4, +-2 m"
                       : "Section 5.1.4: ways to train, hidden units and layers, n = 4, +-2 m",
      .claim = sensors
                   ? "The Bayesian localisation error of different sensors says which work best."
                   : "The unmodified algorithm gave statistically indistinguishable results; so did other "
                     "network structures, as long as there were at least four hidden units.",
      .measured =
          "four networks each, trained and tested at +-2 m; 'less': than the first row in the same corridor.",
      .png = {}};
  return RunStudy<datasets::VariantScores>(
      options, call, 3 * static_cast<std::size_t>(options.seeds),
      [&](std::size_t k) {
        const SetAndSeed at(options, k);
        return datasets::MakeVariantJob(options.study, at.set, at.seed,
                                        datasets::DefaultBallRecipe(options.steps), variants);
      },
      [&](const datasets::BallJob& ball, const BallResults& results) {
        return ScoreVariantJob(ball, variants, results);
      },
      [&](const std::vector<datasets::VariantScores>& scores) {
        return std::vector{VariantFigure(figure, variants, scores, !sensors)};
      });
}

int Active(const ReproduceBallArguments& options, const Invocation& call) {
  return RunStudy<datasets::ActiveScores>(
      options, call, static_cast<std::size_t>(options.seeds),
      [&](std::size_t k) {
        return datasets::MakeActiveJob(options.seed + k, datasets::DefaultBallRecipe(options.steps));
      },
      datasets::ScoreActiveJob, datasets::ActiveFigures);
}

int Adapt(const ReproduceBallArguments& options, const Invocation& call) {
  const datasets::BallRecipe recipe = datasets::DefaultBallRecipe(options.steps);
  return RunStudy<datasets::AdaptScores>(
      options, call, static_cast<std::size_t>(options.seeds),
      [&](std::size_t k) { return datasets::MakeAdaptJob(options.seed + k, recipe); },
      datasets::ScoreAdaptJob, datasets::AdaptFigures,
      [&](const datasets::BallJob& first, const BallResults& results) {
        return ContinueAdaptJob(first, recipe, results);
      });
}

int Ball(const ReproduceBallArguments& options, const Invocation& call) {
  TakeStudyFolder(options.out, options.force);
  if (options.study == "paper") return Paper(options, call);
  if (options.study == "adapt") return Adapt(options, call);
  return options.study == "active" ? Active(options, call) : Variants(options, call);
}

}  // namespace

void AddReproduceBall(Command reproduce, Invocation& call) {
  Command ball;
  const auto options = AddCommand<ReproduceBallArguments>(
      reproduce, call, "ball", "Table 3 and figures 3 to 8 on learned landmarks, from simulated corridors",
      "cairn-reproduce ball --seeds 5 --out ball", Ball, &ball);
  ball.Add("--study", options->study,
           "paper: its table and figures; sensors: error reduction without each group of sensors; active: "
           "a camera that is pointed where it pays; adapt: going on after the corridor has changed; ways: "
           "ways to "
           "train, hidden units and layers")
      .OneOf({"paper", "sensors", "active", "adapt", "ways"})
      .ShowDefault();
  ball.Add("--out", options->out, "Folder of page, pictures, samples (inputs/) and results (results/)")
      .ShowDefault();
  ball.Add("--seed", options->seed, "The first corridor's").Check(CheckSeed).ShowDefault();
  ball.Add("--seeds", options->seeds, "Corridors, over which intervals are taken")
      .Within(1, 1000)
      .ShowDefault();
  ball.Add("--steps", options->steps, "Gradient steps of each training").Within(1, 1'000'000).ShowDefault();
  ball.Add("--workers", options->workers, "Worker processes (as many as there are cores)").Within(1, 1024);
  ball.AddFlag("--force", options->force, "Forget what an earlier run left in the folder");
  ball.AddFlag("--json", options->json, "Pictures, claims, tables and measured figures as JSON");
}

}  // namespace cairn::cli
