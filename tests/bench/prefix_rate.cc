// How soon after the large cycle closes the topology is right, and stays so: on simulated loops of paper
// difficulty, each prefix of the data mapped by a job of its own.
//   prefix_rate FIRST LAST [key=value …]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "datasets/evaluate/evaluate.h"
#include "datasets/reproduce/landmark_study.h"
#include "pipelines/in_process.h"
#include "pipelines/registry.h"
#include "tests/bench/bench_main.h"
#include "tests/bench/stage_option.h"

namespace cairn {
namespace {

bool RightAfter(const Blob& log, int observations, proto::Stage stage) {
  (*stage.mutable_options())["prefix_observations"].set_i(observations);
  const auto input = std::make_shared<const Blob>(log.Without("truth/"));
  const BlobPtr result = RunInProcess(*MakePipeline(stage, 0), {{"log", input}});
  return datasets::Evaluate(*result, log).topology_correct.value_or(false);
}

int Main(const std::vector<std::string>& args) {
  if (args.size() < 2) {
    std::fprintf(stderr, "usage: prefix_rate FIRST LAST [key=value ...]\n");
    return 2;
  }
  proto::Stage stage;
  stage.set_name("landmarks");
  stage.set_pipeline("landmark_map");
  for (std::size_t i = 2; i < args.size(); ++i) SetOption(args[i], &stage);
  int seeds = 0;
  std::vector<int> right_from;  // observations after the closing one
  for (int seed = std::atoi(args[0].c_str()); seed <= std::atoi(args[1].c_str()); ++seed) {
    const datasets::LandmarkStudy study = datasets::MakeLandmarkStudy(static_cast<std::uint64_t>(seed));
    const Blob& log = study.inputs.at("first");
    int from = study.observations + 1;
    std::printf("seed %d, closes with observation %d of %d:", seed, study.closing, study.observations);
    for (int n = study.closing; n <= study.observations; ++n) {
      const bool right = RightAfter(log, n, stage);
      if (!right) from = study.observations + 1;
      if (right && from > n) from = n;
      std::printf(" %s", right ? "right" : "wrong");
      std::fflush(stdout);
    }
    std::printf("\n");
    ++seeds;
    if (from <= study.observations) right_from.push_back(from - study.closing);
  }
  std::ranges::sort(right_from);
  std::printf("paper, seeds %s to %s: right for good in %zu of %d", args[0].c_str(), args[1].c_str(),
              right_from.size(), seeds);
  if (!right_from.empty())
    std::printf(", from %d observations after the closing one on in the median, %d at most",
                right_from[right_from.size() / 2], right_from.back());
  std::printf("\n");
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("prefix_rate", cairn::Main, argc, argv); }
