#include "datasets/simulate/office/office.h"

#include <fmt/format.h>

#include "coordinator/cli/commands/simulate/halls.h"
#include "coordinator/cli/commands/simulate/simulated.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/output/path.h"
#include "datasets/simulate/loop.h"

namespace cairn::cli {
namespace {

struct SimulateOfficeArguments : SimulateOutput {
  datasets::SimulateOfficeOptions office;
  bool nobody = false;
};

int Simulate(const SimulateOfficeArguments& options, const Invocation&) {
  CheckOverwrite(options.out, options.force);
  datasets::SimulateOfficeOptions office = options.office;
  office.persons = !options.nobody;
  const Blob log = datasets::SimulateOffice(office);
  const auto time = log.Get<double>("robot/0/sonar/time_s");
  double travelled_m = 0;
  for (const double forward : log.Get<double>("robot/0/odometry/forward_m")) travelled_m += forward;
  return StoreSimulated(
      options, "log", log,
      fmt::format("{} scans over {:.0f} s and {:.0f} m, odometry ends {:.1f} m off", time.size(), time.back(),
                  travelled_m, datasets::FinalOdometricErrorM(log, 0)));
}

}  // namespace

void AddSimulateOffice(Command simulate, Invocation& call) {
  Command app;
  const auto options = AddCommand<SimulateOfficeArguments>(
      simulate, call, "office",
      "Sonars and infra-red on a turret through rooms and a corridor with metallic walls, again and again",
      "cairn simulate office --seed 1 office.h5", Simulate, &app);
  datasets::SimulateOfficeOptions& office = options->office;
  app.Add("--minutes", office.minutes, "Of driving").Within(1.0, 120.0).ShowDefault();
  app.AddFlag("--moved", office.moved, "In the middle of the drive half of the furniture moves");
  app.AddFlag("--turned", office.turned, "One more room, at the corridor's end, turned by 30 degrees");
  app.AddFlag("--hints", office.hints, "Somebody marks the doorways that the robot drives through");
  app.AddFlag("--nobody", options->nobody, "The same drive, and nobody else in the office");
  app.Add("--seed", office.seed, "Same seed, same log").Check(CheckSeed).ShowDefault();
  AddOutput(app, *options, "log");
}

}  // namespace cairn::cli
