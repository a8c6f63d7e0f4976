// On simulated loops of paper difficulty: how soon after the large cycle closes the topology is right, and
// stays so, each prefix of the data mapped by a job of its own; or, with --iterations, after how many
// iterations of EM over all data the topology is right and every landmark found, each number a job of its
// own.
//   prefix_rate FIRST LAST [--iterations] [key=value …]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "datasets/common/log_parts.h"
#include "datasets/evaluate/evaluate.h"
#include "datasets/reproduce/landmarks/study.h"
#include "datasets/simulate/loop.h"
#include "pipelines/registry.h"
#include "pipelines/testing/in_process.h"
#include "tests/bench/bench_main.h"
#include "tests/bench/stage_option.h"

namespace cairn {
namespace {

constexpr int kIterations = 8;  // at most, with --iterations

datasets::Evaluation ScoreOf(const Blob& log, const proto::Stage& stage) {
  const auto input = std::make_shared<const Blob>(log.Without("truth/"));
  return datasets::Evaluate(*RunInProcess(*MakePipeline(stage, 0), {{"log", input}}), log);
}

bool RightAfter(const Blob& log, int observations, proto::Stage stage) {
  (*stage.mutable_options())["prefix_observations"].set_i(observations);
  return ScoreOf(log, stage).topology_correct.value_or(false);
}

// From which number on a run of successes goes on to the end; one more than the last where it does not.
class LastRun {
 public:
  void Add(int number, bool success) {
    if (!success) from_ = number + 1;
    if (from_ < 0) from_ = number;
  }
  int from() const { return from_; }

 private:
  int from_ = -1;
};

// "in N of M; median, most" of the numbers from which on it was so.
std::string Summary(std::vector<int> from, int seeds, const char* unit) {
  std::ranges::sort(from);
  std::string text = std::to_string(from.size()) + " of " + std::to_string(seeds);
  if (from.empty()) return text;
  return text + ", " + std::to_string(from[from.size() / 2]) + " " + unit + " in the median, " +
         std::to_string(from.back()) + " at most";
}

void Prefixes(int first, int last, const proto::Stage& stage) {
  std::vector<int> right_from;  // observations after the closing one
  int seeds = 0;
  for (int seed = first; seed <= last; ++seed) {
    datasets::LandmarkStudy study;
    try {
      study = datasets::MakeLandmarkStudy(static_cast<std::uint64_t>(seed));
    } catch (const InputError& no_cycle) {
      std::printf("seed %d: %s\n", seed, no_cycle.what());
      continue;
    }
    ++seeds;
    std::printf("seed %d, closes with observation %d of %d:", seed, study.closing, study.observations);
    LastRun run;
    for (int n = study.closing; n <= study.observations; ++n) {
      const bool right = RightAfter(study.inputs.at("first"), n, stage);
      run.Add(n, right);
      std::printf(" %s", right ? "right" : "wrong");
      std::fflush(stdout);
    }
    std::printf("\n");
    if (run.from() <= study.observations) right_from.push_back(run.from() - study.closing);
  }
  std::printf("paper, seeds %d to %d: right for good in %s\n", first, last,
              Summary(right_from, seeds, "observations after the closing one").c_str());
}

void Iterations(int first, int last, proto::Stage stage) {
  std::vector<int> right_from, all_from;
  (*stage.mutable_options())["tolerance"].set_d(0);
  for (int seed = first; seed <= last; ++seed) {
    // The same robot as the study's, which drives with a second one.
    const Blob log = datasets::RobotsOf(
        datasets::SimulateLoop(
            {.difficulty = "paper", .robots = 2, .seed = static_cast<std::uint64_t>(seed)}),
        {0});
    std::printf("seed %d:", seed);
    LastRun right, all;
    for (int n = 1; n <= kIterations; ++n) {
      (*stage.mutable_options())["iterations"].set_i(n);
      const datasets::Evaluation score = ScoreOf(log, stage);
      const bool correct = score.topology_correct.value_or(false);
      right.Add(n, correct);
      all.Add(n, correct && score.landmarks->missed == 0 && score.landmarks->spurious == 0);
      std::printf(" %s %lld+%lld", correct ? "right" : "wrong",
                  static_cast<long long>(score.landmarks->found),
                  static_cast<long long>(score.landmarks->spurious));
      std::fflush(stdout);
    }
    std::printf("\n");
    if (right.from() <= kIterations) right_from.push_back(right.from());
    if (all.from() <= kIterations) all_from.push_back(all.from());
  }
  const int seeds = last - first + 1;
  std::printf("paper, seeds %d to %d: topology right for good in %s\n", first, last,
              Summary(right_from, seeds, "iterations").c_str());
  std::printf("every landmark and no other, for good, in %s\n",
              Summary(all_from, seeds, "iterations").c_str());
}

int Main(const std::vector<std::string>& given) {
  std::vector<std::string> args = given;
  const bool iterations = std::erase(args, "--iterations") > 0;
  if (args.size() < 2) {
    std::fprintf(stderr, "usage: prefix_rate FIRST LAST [--iterations] [key=value ...]\n");
    return 2;
  }
  proto::Stage stage;
  stage.set_name("landmarks");
  stage.set_pipeline("landmark_map");
  for (std::size_t i = 2; i < args.size(); ++i) SetOption(args[i], &stage);
  const int first = std::atoi(args[0].c_str()), last = std::atoi(args[1].c_str());
  iterations ? Iterations(first, last, stage) : Prefixes(first, last, stage);
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("prefix_rate", cairn::Main, argc, argv); }
