#include <cstdio>

#include "coordinator/cli/failure.h"
#include "coordinator/cli/invocation.h"
#include "coordinator/cli/loop_options.h"
#include "coordinator/cli/output_path.h"
#include "coordinator/cli/scalar.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {
namespace {

struct Options {
  datasets::SimulateLoopOptions loop;
  std::string out;
  bool force = false;
};

int Simulate(const Options& options, const Invocation&) {
  RefuseToOverwrite(options.out, options.force);
  const Blob log = datasets::SimulateLoop(options.loop);
  Check(WriteBlobFile(options.out, "log", log));
  std::printf("%s: %d robot%s, %zu landmarks in truth, odometry ends %.1f m off\n", options.out.c_str(),
              options.loop.robots, options.loop.robots == 1 ? "" : "s",
              log.Texts("truth/landmarks/name").size(), datasets::FinalOdometricErrorM(log, 0));
  return kExitDone;
}

}  // namespace

void AddSimulate(CLI::App& app, Invocation& call) {
  CLI::App* simulate = app.add_subcommand("simulate", "Makes a synthetic log, with its ground truth inside");
  simulate->require_subcommand(1);
  simulate->footer("Example:\n  cairn simulate loop --difficulty base --robots 4 --seed 1 log.h5");
  CLI::App* loop = nullptr;
  const auto options = AddCommand<Options>(
      *simulate, call, "loop",
      "Robots in corridors round a large cycle; a button is pressed at each junction",
      "cairn simulate loop --difficulty paper --types 3 --confusion 0.1 --seed 7 log.h5", Simulate, &loop);
  loop->add_option("--difficulty", options->loop.difficulty, "How hard (paper, base, hard, extreme, museum)")
      ->check(CLI::IsMember(LoopDifficultyNames()))
      ->capture_default_str();
  AddLoopOptions(loop, &options->loop);
  loop->add_option("--seed", options->loop.seed, "Same seed, same log")
      ->check(CheckSeed)
      ->capture_default_str();
  loop->add_flag("--force", options->force, "Replace OUT.h5 where it is there already");
  loop->add_option("OUT.h5", options->out, "The log to write")->required();
}

}  // namespace cairn::cli
