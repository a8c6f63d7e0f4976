// How often a local map is right of which the verdict says high, fair, low, not known: on simulated offices
// as they are, and with odometry that goes wrong as people's does.
//   local_verdict FIRST LAST
// Each seed of each kind is a job. Right: no pose of the path is off by 0.5 m or more. Logs that an import
// would ask about (FindUnitDoubts) are counted apart and not mapped.
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "datasets/common/unit_doubts.h"
#include "datasets/evaluate/local.h"
#include "datasets/simulate/office/office.h"
#include "datasets/verdicts/local_map_verdict.h"
#include "pipelines/registry.h"
#include "pipelines/testing/in_process.h"
#include "schema/kinds/log.h"

namespace cairn {
namespace {

void Scale(Column<double>* values, double factor) {
  std::vector<double> scaled = values->vector();
  for (double& value : scaled) value *= factor;
  *values = scaled;
}

using Spoil = void (*)(kinds::Log::Robot* robot);

struct World {
  const char* name;
  datasets::SimulateOfficeOptions office;
  Spoil spoil = nullptr;
};

// In the middle of the drive, unnoticed.
void SlipBy(double turn_rad, kinds::Log::Robot* robot) {
  std::vector<double> turns = robot->odometry.turn_rad.vector();
  turns[turns.size() / 2] += turn_rad;
  robot->odometry.turn_rad = turns;
}

void Carry(kinds::Log::Robot* robot) {
  std::vector<double> forward = robot->odometry.forward_m.vector();
  forward[forward.size() / 2] += 3;
  robot->odometry.forward_m = forward;
}

const World kWorlds[] = {
    {"as it is", {}},
    {"furniture moved", {.moved = true}},
    {"a room turned", {.turned = true}},
    {"5 minutes", {.minutes = 5}},
    {"3 minutes", {.minutes = 3}},
    {"20 minutes", {.minutes = 20}},
    {"turns drift by 0.05 rad a metre",
     {},
     [](kinds::Log::Robot* robot) {
       std::vector<double> turns = robot->odometry.turn_rad.vector();
       for (std::size_t i = 0; i < turns.size(); ++i)
         turns[i] += 0.05 * std::abs(robot->odometry.forward_m[i]);
       robot->odometry.turn_rad = turns;
     }},
    {"distances 10% too long", {}, [](kinds::Log::Robot* robot) { Scale(&robot->odometry.forward_m, 1.1); }},
    {"distances 30% too short", {}, [](kinds::Log::Robot* robot) { Scale(&robot->odometry.forward_m, 0.7); }},
    {"turns 30% too large", {}, [](kinds::Log::Robot* robot) { Scale(&robot->odometry.turn_rad, 1.3); }},
    {"turns mirrored", {}, [](kinds::Log::Robot* robot) { Scale(&robot->odometry.turn_rad, -1); }},
    {"a slip by 1 rad", {}, [](kinds::Log::Robot* robot) { SlipBy(1, robot); }},
    {"a slip by a quarter turn", {}, [](kinds::Log::Robot* robot) { SlipBy(1.5708, robot); }},
    {"carried 3 m", {}, Carry},
};

struct Tally {
  int jobs = 0, right = 0;
};

void Study(const World& world, std::uint64_t first, std::uint64_t last,
           std::map<datasets::Confidence, Tally>* all) {
  std::map<datasets::Confidence, Tally> here;
  int asked = 0;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    datasets::SimulateOfficeOptions options = world.office;
    options.seed = seed;
    Blob blob = datasets::SimulateOffice(options);
    if (world.spoil != nullptr) {
      auto log = Read<kinds::Log>(blob);
      world.spoil(&log.robot[0]);
      blob = BlobOf(log);
    }
    if (!datasets::FindUnitDoubts(blob).empty()) {
      ++asked;
      continue;
    }
    proto::Stage stage;
    stage.set_pipeline("local_map");
    const BlobPtr map = RunInProcess(*MakePipeline(stage, 0),
                                     {{"log", std::make_shared<const Blob>(blob.Without("truth/"))}});
    constexpr double kRight_m = 0.5;
    const bool right = datasets::EvaluateLocal(*map, blob).path.worst_m < kRight_m;
    for (auto* tallies : {&here, all}) {
      Tally& tally = (*tallies)[datasets::LocalMapVerdict(*map).trust];
      ++tally.jobs;
      tally.right += right;
    }
  }
  std::printf("%-32s asked %d", world.name, asked);
  for (const auto& [trust, tally] : here)
    std::printf("; %s %d, %d right", datasets::Word(trust), tally.jobs, tally.right);
  std::printf("\n");
  std::fflush(stdout);
}

int Main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "local_verdict FIRST LAST\n");
    return 2;
  }
  std::map<datasets::Confidence, Tally> all;
  for (const World& world : kWorlds) Study(world, std::stoull(argv[1]), std::stoull(argv[2]), &all);
  for (const auto& [trust, tally] : all)
    std::printf("all: %s %d, %d right\n", datasets::Word(trust), tally.jobs, tally.right);
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::Main(argc, argv); }
