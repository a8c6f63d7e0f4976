#include "coordinator/cli/commands/simulate/halls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coordinator/cli/commands/simulate/simulated.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/output/path.h"
#include "datasets/simulate/hall/hall.h"

namespace cairn::cli {
namespace {

struct SimulateHallsArguments : SimulateOutput {
  datasets::SimulateHallwayOptions hall;  // of the other two the seed alone counts
};

int Publish(const SimulateHallsArguments& options, const Blob& log) {
  const auto range = log.Get<double>("robot/0/sonar/range_m");
  const auto cause = log.Get<std::uint8_t>("truth/robot/0/sonar/cause");
  const auto heard = std::ranges::count_if(range, [](double r) { return !std::isnan(r); });
  const auto doors = log.at("truth/doors/open").size();
  return StoreSimulated(
      options, "log", log,
      fmt::format("{} sonar readings, {} echoes, {} through {}", range.size(), heard,
                  std::ranges::count(cause, 2), doors == 1 ? "the door" : std::to_string(doors) + " doors"));
}

template <class Simulate>
int Run(const SimulateHallsArguments& options, const Simulate& simulate) {
  CheckOutputs(options);
  return Publish(options, simulate());
}

int Hallway(const SimulateHallsArguments& options, const Invocation&) {
  return Run(options, [&] { return datasets::SimulateHallway(options.hall); });
}

int NarrowDoors(const SimulateHallsArguments& options, const Invocation&) {
  return Run(options, [&] { return datasets::SimulateNarrowDoors(options.hall.seed); });
}

int SmoothWall(const SimulateHallsArguments& options, const Invocation&) {
  return Run(options, [&] { return datasets::SimulateSmoothWall(options.hall.seed); });
}

std::shared_ptr<SimulateHallsArguments> AddHall(Command simulate, Invocation& call, const char* name,
                                                const char* summary, const char* example,
                                                int (*run)(const SimulateHallsArguments&, const Invocation&),
                                                Command* app) {
  const auto options = AddCommand<SimulateHallsArguments>(simulate, call, name, summary, example, run, app);
  app->Add("--seed", options->hall.seed, "Same seed, same log").Check(CheckSeed).ShowDefault();
  AddBagOutput(*app, *options);
  AddOutput(*app, *options, "log");
  return options;
}

}  // namespace

void AddSimulateHalls(Command simulate, Invocation& call) {
  Command app;
  const auto hallway =
      AddHall(simulate, call, "hallway", "24 sonars along a hall with a door that few readings get through",
              "cairn simulate hallway --door-readings 3 --seed 1 hallway.h5", Hallway, &app);
  app.Add("--door-readings", hallway->hall.door_readings,
          "How many get through it, exactly; the others are bounced off its posts")
      .Within(1, 24)
      .ShowDefault();
  app.AddFlag("--closed", hallway->hall.closed, "The same hall and drive, the door closed");
  AddHall(simulate, call, "narrow-doors", "24 sonars along a hall with two narrow doors; somebody walks past",
          "cairn simulate narrow-doors --seed 1 doors.h5", NarrowDoors, &app);
  AddHall(simulate, call, "smooth-wall",
          "24 sonars along 50 m, one wall a mirror for sound; somebody walks behind the robot",
          "cairn simulate smooth-wall --seed 1 smooth.h5", SmoothWall, &app);
}

}  // namespace cairn::cli
