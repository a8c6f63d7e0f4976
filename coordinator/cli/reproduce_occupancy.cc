#include <algorithm>
#include <filesystem>
#include <optional>
#include <thread>

#include "coordinator/cli/console.h"
#include "coordinator/cli/failure.h"
#include "coordinator/cli/programs.h"
#include "coordinator/cli/reproduce.h"
#include "coordinator/cli/result_file.h"
#include "coordinator/cli/scalar.h"
#include "coordinator/cli/stop_signal.h"
#include "datasets/reproduce/occupancy_figures.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string out = "reproduce-occupancy";
  std::string study = "paper";
  std::string log;
  std::uint64_t seed = 101;
  int seeds = 20;
  int workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  bool force = false;
  bool json = false;
};

// Beside the results, so that each can be made again by hand.
void WriteInputs(const datasets::OccupancyStudy& study, const fs::path& out) {
  fs::create_directories(out / "inputs");
  for (const auto& [name, blob] : study.inputs)
    Check(WriteBlobFile((out / "inputs" / (name + ".h5")).string(), "log", blob));
}

datasets::OccupancyStudy MakeStudy(const Options& options) {
  if (options.study == "curve") {
    if (!options.log.empty()) throw InputError("--log: the curve is of simulated hallways alone");
    return datasets::MakeCurveStudy(options.seed, options.seeds);
  }
  std::optional<Blob> log;
  if (!options.log.empty()) log = ReadResult(options.log, "log").blob;
  return datasets::MakeOccupancyStudy(options.seed, options.seeds, log ? &*log : nullptr);
}

int Occupancy(const Options& options, const Invocation& call) {
  const datasets::OccupancyStudy study = MakeStudy(options);
  coordinator::EmbeddedOptions embedded;
  embedded.dir = (fs::path(options.out) / "results").string();
  embedded.workers = options.workers;
  embedded.worker_program = WorkerProgram();
  embedded.force = options.force;
  std::map<std::string, BlobPtr> inputs;
  for (const auto& [name, blob] : study.inputs)
    inputs[name] = std::make_shared<const Blob>(blob.Without("truth/"));
  Console console(call);
  embedded.log = console.Sink();
  const coordinator::EmbeddedResult run = coordinator::RunEmbedded(
      embedded, study.job, inputs,
      [&](const coordinator::EmbeddedProgress& progress) { console.Progress(progress.info); },
      StopOnSignals());
  console.Clear();
  if (!IsDone(run)) return ExplainUndone(run);
  WriteInputs(study, options.out);
  const std::uint64_t last = options.seed + static_cast<std::uint64_t>(options.seeds) - 1;
  const auto results = ReadResults(run);
  PublishPage(options.out, "Learning occupancy grids with forward models",
              "The figures of Thrun (IROS 2001) from simulated sonar: seeds " + std::to_string(options.seed) +
                  " to " + std::to_string(last) + ", pictures of the first.",
              options.study == "curve" ? CurveFigures(study, results) : OccupancyFigures(study, results),
              options.json);
  return kExitDone;
}

}  // namespace

void AddReproduceOccupancy(CLI::App& reproduce, Invocation& call) {
  CLI::App* app = nullptr;
  const auto options = AddCommand<Options>(
      reproduce, call, "occupancy",
      "Figures 1 to 5 on occupancy grids, from simulated sonar; the chain after landmark_map",
      "cairn reproduce occupancy --seeds 5 --out occupancy", Occupancy, &app);
  app->add_option("--study", options->study,
                  "paper: its figures; curve: walls found against doors found, by evidence_map's parameters")
      ->check(CLI::IsMember({"paper", "curve"}))
      ->capture_default_str();
  app->add_option("--log", options->log, "Also maps of this log, scored on readings that are held out");
  app->add_option("--out", options->out, "Folder of page, pictures, logs (inputs/) and results (results/)")
      ->capture_default_str();
  app->add_option("--seed", options->seed, "The first hallway's")->check(CheckSeed)->capture_default_str();
  app->add_option("--seeds", options->seeds, "Hallways of each kind")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app->add_option("--workers", options->workers, "Worker processes (as many as there are cores)")
      ->check(CLI::Range(1, 1024));
  app->add_flag("--force", options->force, "Forget what an earlier run left in the folder");
  app->add_flag("--json", options->json, "Pictures, claims, tables and measured figures as JSON");
}

}  // namespace cairn::cli
