#include <algorithm>
#include <thread>

#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/reproduce/reproduce.h"
#include "datasets/reproduce/local/figures.h"

namespace cairn::cli {
namespace {

struct ReproduceLocalArguments {
  std::string out = "reproduce-local";
  std::uint64_t seed = 101;
  int seeds = 20;
  int workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  bool force = false, json = false;
};

int Local(const ReproduceLocalArguments& options, const Invocation& call) {
  const datasets::LocalStudy study = datasets::MakeLocalStudy(options.seed, options.seeds);
  const coordinator::EmbeddedResult run =
      RunStudy({options.out, options.workers, options.force}, study.job, study.inputs, call);
  if (!IsDone(run)) return ExplainUndone(run);
  const std::uint64_t last = options.seed + static_cast<std::uint64_t>(options.seeds) - 1;
  PublishPage(options.out, "Efficient occupancy grids for variable resolution map building",
              "The figures of Dedieu and Millan (1998) from simulated offices: seeds " +
                  std::to_string(options.seed) + " to " + std::to_string(last) + ", pictures of the first.",
              datasets::LocalFigures(study, ReadResults(run)), options.json);
  return kExitDone;
}

}  // namespace

void AddReproduceLocal(Command reproduce, Invocation& call) {
  Command app;
  const auto options = AddCommand<ReproduceLocalArguments>(
      reproduce, call, "local", "Figures 2 to 4 on local grids and edge traces, from simulated offices",
      "cairn-reproduce local --seeds 5 --out local", Local, &app);
  app.Add("--out", options->out, "Folder of page, pictures, logs (inputs/) and results (results/)")
      .ShowDefault();
  app.Add("--seed", options->seed, "The first office's").Check(CheckSeed).ShowDefault();
  app.Add("--seeds", options->seeds,
          "Offices of each kind: as it stands, furniture that moves, a room turned")
      .Within(1, 1000)
      .ShowDefault();
  app.Add("--workers", options->workers, "Worker processes (as many as there are cores)").Within(1, 1024);
  app.AddFlag("--force", options->force, "Forget what an earlier run left in the folder");
  app.AddFlag("--json", options->json, "Pictures, claims, tables and measured figures as JSON");
}

}  // namespace cairn::cli
