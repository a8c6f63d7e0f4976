#include <fmt/format.h>

#include <filesystem>

#include "coordinator/cli/commands/simulate/halls.h"
#include "coordinator/cli/commands/simulate/loop_options.h"
#include "coordinator/cli/commands/simulate/simulated.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/common/suggest.h"
#include "coordinator/cli/output/path.h"
#include "datasets/simulate/corridor/corridor.h"
#include "schema/store/atomic_file.h"

namespace cairn::cli {
namespace {

struct SimulateArguments : SimulateOutput {
  datasets::SimulateLoopOptions loop;
};

int Simulate(const SimulateArguments& options, const Invocation&) {
  CheckOutputs(options);
  const Blob log = datasets::SimulateLoop(options.loop);
  return StoreSimulated(
      options, "log", log,
      fmt::format("{} robot{}, {} landmarks in truth, odometry ends {:.1f} m off", options.loop.robots,
                  options.loop.robots == 1 ? "" : "s", log.Texts("truth/landmarks/name").size(),
                  datasets::FinalOdometricErrorM(log, 0)));
}

struct CorridorOptions : SimulateOutput {
  datasets::SimulateCorridorOptions corridor;
  std::string pictures;  // a folder
};

std::string PictureOf(const CorridorOptions& options, const std::string& run) {
  return (std::filesystem::path(options.pictures) / (run + ".png")).string();
}

void CheckPictures(const CorridorOptions& options) {
  if (options.pictures.empty()) return;
  if (!std::filesystem::is_directory(options.pictures))
    throw InputError("there is no folder '" + options.pictures + "' to write pictures to");
  for (int number = 0; number < options.corridor.runs; ++number)
    CheckOverwrite(PictureOf(options, datasets::CorridorRunName(options.corridor, number)), options.force);
}

int SimulateCorridor(const CorridorOptions& options, const Invocation&) {
  CheckOverwrite(options.out, options.force);
  CheckPictures(options);
  std::vector<datasets::CorridorPicture> pictures;
  const Blob samples =
      datasets::SimulateCorridor(options.corridor, options.pictures.empty() ? nullptr : &pictures);
  std::vector<std::string> written;
  for (const datasets::CorridorPicture& picture : pictures) {
    written.push_back(PictureOf(options, picture.name));
    WriteOutput(written.back(), picture.png, options.force);
  }
  return StoreSimulated(
      options, "samples", samples,
      fmt::format("{} run{} of {} snapshots, {} inputs, features: {}", options.corridor.runs,
                  options.corridor.runs == 1 ? "" : "s", options.corridor.snapshots,
                  samples.Texts("input_name").size(), Join(samples.Texts("feature_name"))),
      written);
}

void AddCorridor(Command simulate, Invocation& call) {
  Command app;
  const auto options = AddCommand<CorridorOptions>(
      simulate, call, "corridor",
      "Samples of a camera and 24 sonars in an office corridor, with doors and ceiling lights as features",
      "cairn simulate corridor --set d1 --seed 1 corridor.h5", SimulateCorridor, &app);
  datasets::SimulateCorridorOptions& corridor = options->corridor;
  app.Add("--set", corridor.set, "Where the camera points: d1 outer wall, d2 inner wall, d3 ceiling")
      .OneOf(datasets::CorridorSets())
      .ShowDefault();
  app.Add("--runs", corridor.runs, "Drives through the corridor").Within(1, 64).ShowDefault();
  app.Add("--snapshots", corridor.snapshots, "Of a run, at even times").Within(2, 100000).ShowDefault();
  app.Add("--length-m", corridor.length_m, "Of the corridor").Within(30.0, 1000.0).ShowDefault();
  app.Add("--label-error-m", corridor.label_error_m,
          "Error of the position labels, along and across: standard deviation")
      .Within(0.0, 5.0)
      .ShowDefault();
  app.Add("--seed", corridor.seed, "Same seed, same corridor and runs").Check(CheckSeed).ShowDefault();
  app.AddFlag("--odometry", corridor.odometry,
              "The file also holds what odometry makes of the way from each snapshot to the next");
  app.AddFlag("--both-ways", corridor.both_ways,
              "Every other run comes back; the camera then points at the other wall");
  app.Add("--changed", corridor.changed,
          "Share of posters, boards, doors' paint and bins that others have replaced since")
      .Within(0.0, 1.0)
      .ShowDefault();
  app.AddFlag("--images", corridor.images,
              "The images themselves instead of 140 inputs (for image_features)");
  app.Add("--pictures", options->pictures, "A folder: writes a PNG for each run, an image a metre");
  AddOutput(app, *options, "samples");
}

}  // namespace

void AddSimulate(Command app, Invocation& call) {
  Command simulate = app.AddCommand("simulate", "Makes a synthetic log, with its ground truth inside");
  simulate.NeedsCommand();
  simulate.Footer("Example:\n  cairn simulate loop --difficulty base --robots 4 --seed 1 log.h5");
  Command loop;
  const auto options = AddCommand<SimulateArguments>(
      simulate, call, "loop", "Robots in corridors round a large cycle; a button is pressed at each junction",
      "cairn simulate loop --difficulty paper --types 3 --confusion 0.1 --seed 7 log.h5", Simulate, &loop);
  loop.Add("--difficulty", options->loop.difficulty, "How hard (paper, base, hard, extreme, museum)")
      .OneOf(LoopDifficultyNames())
      .ShowDefault();
  AddLoopOptions(loop, &options->loop);
  loop.Add("--seed", options->loop.seed, "Same seed, same log").Check(CheckSeed).ShowDefault();
  AddBagOutput(loop, *options);
  AddOutput(loop, *options, "log");
  AddCorridor(simulate, call);
  AddSimulateHalls(simulate, call);
  AddSimulateOffice(simulate, call);
}

}  // namespace cairn::cli
