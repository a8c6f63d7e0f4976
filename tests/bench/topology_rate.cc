// How often landmark_map finds the right topology on simulated loops, and how exact its landmarks are.
//   topology_rate DIFFICULTY FIRST LAST [--robots N] [--rounds] [key=value …]
// prints a line a seed (with --rounds also one a round: the time so far and what the round found) and a
// summary. The pipeline sees the log without its truth.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "datasets/evaluate/evaluate.h"
#include "datasets/simulate_loop.h"
#include "pipelines/in_process.h"
#include "pipelines/registry.h"
#include "tests/bench/stage_option.h"
namespace cairn {
namespace {

struct Tally {
  int jobs = 0, right = 0;
  double seconds = 0.0;
  std::vector<double> rmse_m;
};

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void RunSeed(const datasets::SimulateLoopOptions& world, const proto::Stage& stage, bool rounds,
             Tally* tally) {
  const Blob log = datasets::SimulateLoop(world);
  const auto start = std::chrono::steady_clock::now();
  const BlobPtr result = RunInProcess(
      *MakePipeline(stage, world.seed), {{"log", std::make_shared<const Blob>(log.Without("truth/"))}},
      [&](const proto::Step& step) {
        if (rounds) std::printf("%7.2f s  %s\n", SecondsSince(start), step.note().c_str());
      });
  tally->seconds += SecondsSince(start);
  const datasets::Evaluation score = datasets::Evaluate(*result, log);
  const bool right = score.topology_correct.value_or(false);
  const double rmse_m = score.landmarks->rmse_m.value_or(-1.0);
  ++tally->jobs;
  tally->right += right ? 1 : 0;
  if (right) tally->rmse_m.push_back(rmse_m);
  std::printf("seed %llu: topology %s, %lld found, %lld missed, %lld spurious, rmse %.2f m, path %.2f m\n",
              static_cast<unsigned long long>(world.seed), right ? "right" : "wrong",
              static_cast<long long>(score.landmarks->found), static_cast<long long>(score.landmarks->missed),
              static_cast<long long>(score.landmarks->spurious), rmse_m,
              score.trajectory_rmse_m.value_or(-1.0));
}

int Main(const std::vector<std::string>& args) {
  if (args.size() < 3) {
    std::fprintf(stderr,
                 "usage: topology_rate DIFFICULTY FIRST LAST [--robots N] [--rounds] [key=value ...]\n");
    return 2;
  }
  datasets::SimulateLoopOptions world;
  world.difficulty = args[0];
  bool rounds = false;
  proto::Stage stage;
  stage.set_name("landmarks");
  stage.set_pipeline("landmark_map");
  for (std::size_t i = 3; i < args.size(); ++i) {
    if (args[i] == "--robots" && i + 1 < args.size())
      world.robots = std::atoi(args[++i].c_str());
    else if (args[i] == "--rounds")
      rounds = true;
    else
      SetOption(args[i], &stage);
  }
  Tally tally;
  for (int seed = std::atoi(args[1].c_str()); seed <= std::atoi(args[2].c_str()); ++seed) {
    world.seed = static_cast<std::uint64_t>(seed);
    RunSeed(world, stage, rounds, &tally);
  }
  std::ranges::sort(tally.rmse_m);
  std::printf(
      "%s, seeds %s to %s: topology right in %d of %d; median landmark rmse of those %.2f m; %.2f s a job\n",
      args[0].c_str(), args[1].c_str(), args[2].c_str(), tally.right, tally.jobs,
      tally.rmse_m.empty() ? -1.0 : tally.rmse_m[tally.rmse_m.size() / 2], tally.seconds / tally.jobs);
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) {
  try {
    return cairn::Main({argv + 1, argv + argc});
  } catch (const cairn::InputError& error) {
    std::fprintf(stderr, "topology_rate: %s\n", error.what());
    return 2;
  }
}
