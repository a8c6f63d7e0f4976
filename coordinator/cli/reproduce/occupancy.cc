#include <algorithm>
#include <optional>
#include <thread>

#include "coordinator/cli/common/result_file.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/reproduce/reproduce.h"
#include "datasets/reproduce/occupancy/figures.h"

namespace cairn::cli {
namespace {

struct ReproduceOccupancyArguments {
  std::string out = "reproduce-occupancy";
  std::string study = "paper";
  std::string log;
  std::uint64_t seed = 101;
  int seeds = 20;
  int workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  bool force = false;
  bool json = false;
};

datasets::OccupancyStudy MakeStudy(const ReproduceOccupancyArguments& options) {
  if (options.study == "curve") {
    if (!options.log.empty()) throw InputError("--log: the curve is of simulated hallways alone");
    return datasets::MakeCurveStudy(options.seed, options.seeds);
  }
  std::optional<Blob> log;
  if (!options.log.empty()) log = ReadResult(options.log, "log").blob;
  return datasets::MakeOccupancyStudy(options.seed, options.seeds, log ? &*log : nullptr);
}

int Occupancy(const ReproduceOccupancyArguments& options, const Invocation& call) {
  const datasets::OccupancyStudy study = MakeStudy(options);
  const coordinator::EmbeddedResult run =
      RunStudy({options.out, options.workers, options.force}, study.job, study.inputs, call);
  if (!IsDone(run)) return ExplainUndone(run);
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

void AddReproduceOccupancy(Command reproduce, Invocation& call) {
  Command app;
  const auto options = AddCommand<ReproduceOccupancyArguments>(
      reproduce, call, "occupancy",
      "Figures 1 to 5 on occupancy grids, from simulated sonar; the chain after landmark_map",
      "cairn-reproduce occupancy --seeds 5 --out occupancy", Occupancy, &app);
  app.Add("--study", options->study,
          "paper: its figures; curve: walls found against doors found, by evidence_map's parameters")
      .OneOf({"paper", "curve"})
      .ShowDefault();
  app.Add("--log", options->log, "Also maps of this log, scored on readings that are held out");
  app.Add("--out", options->out, "Folder of page, pictures, logs (inputs/) and results (results/)")
      .ShowDefault();
  app.Add("--seed", options->seed, "The first hallway's").Check(CheckSeed).ShowDefault();
  app.Add("--seeds", options->seeds, "Hallways of each kind").Within(1, 1000).ShowDefault();
  app.Add("--workers", options->workers, "Worker processes (as many as there are cores)").Within(1, 1024);
  app.AddFlag("--force", options->force, "Forget what an earlier run left in the folder");
  app.AddFlag("--json", options->json, "Pictures, claims, tables and measured figures as JSON");
}

}  // namespace cairn::cli
