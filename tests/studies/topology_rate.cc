// How often landmark_map finds the right topology on simulated loops, and how exact its landmarks are.
//   topology_rate DIFFICULTY FIRST LAST [options of cairn simulate loop] [--rounds] [key=value …]
//   topology_rate --csv DIR [--rounds] [key=value …]
//   topology_rate DIFFICULTY FIRST LAST --statistics
// prints a line a log (with --rounds also one a round: the time so far and what the round found) and a
// summary, with how often what was stated of which confidence was right. With --unstated the logs do not say
// how many of their observations are false or missed, as logs from other files do not. The second form takes
// every folder in DIR that holds an odometry.csv.gz (docs/datasets.md, loops-csv). The pipeline sees the log
// without its truth. The third form maps nothing: it prints the range of each figure of the logs
// (pipelines/landmark_map/measured.h).
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "coordinator/cli/commands/simulate/loop_options.h"
#include "datasets/evaluate/evaluate.h"
#include "datasets/import/csv.h"
#include "datasets/simulate/loop.h"
#include "datasets/verdicts/landmark_map_verdict.h"
#include "pipelines/landmark_map/measured.h"
#include "pipelines/registry.h"
#include "pipelines/testing/in_process.h"
#include "tests/bench/stage_option.h"
namespace cairn {
namespace {

struct Tally {
  int jobs = 0, right = 0;
  int complete = 0;  // every landmark that was observed, and no other
  double seconds = 0.0;
  std::vector<double> rmse_m;
  struct Stated {
    int jobs = 0, right = 0;
  };
  std::map<datasets::Confidence, Stated> stated, verdicts;  // by the search alone; by all that tells
};

struct Arguments {
  std::vector<std::string> words;  // difficulty, first and last seed
  std::string csv;
  bool rounds = false, statistics = false, unstated = false;
  datasets::SimulateLoopOptions world;
  proto::Stage stage;
};

// Of the processor: others may use the machine.
double SecondsSince(std::clock_t start) { return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC; }

// The least and the largest of each figure of the logs so far.
struct Ranges {
  std::map<std::string, std::pair<double, double>> of;
  void Add(const std::string& name, double value) {
    auto& [least, most] = of.try_emplace(name, value, value).first->second;
    least = std::min(least, value);
    most = std::max(most, value);
  }
};

void AddFigures(const Blob& log, Ranges* ranges) {
  const landmark_map::LogStatistics statistics = landmark_map::MeasureLog(log);
  landmark_map::VisitLogStatistics(statistics,
                                   [&](const char* name, double value) { ranges->Add(name, value); });
  const auto seen = log.Get<std::int32_t>("truth/robot/0/observations/landmark");
  const std::set<std::int32_t> landmarks(seen.begin(), seen.end());
  ranges->Add("landmarks", static_cast<double>(landmarks.size() - landmarks.count(-1)));
}

void RunLog(const std::string& name, Blob log, const Arguments& arguments, Tally* tally) {
  if (arguments.unstated) log = log.Without("noise/false_ratio").Without("noise/miss_ratio");
  const std::clock_t start = std::clock();
  ++tally->jobs;
  BlobPtr result;
  try {
    result = RunInProcess(*MakePipeline(arguments.stage, arguments.world.seed),
                          {{"log", std::make_shared<const Blob>(log.Without("truth/"))}},
                          [&](const proto::Step& step) {
                            if (!arguments.rounds) return;
                            std::printf("%7.2f s  %s\n", SecondsSince(start), step.note().c_str());
                          });
  } catch (const InputError& error) {
    std::printf("%s: failed: %s\n", name.c_str(), error.what());
    return;
  }
  tally->seconds += SecondsSince(start);
  const datasets::Evaluation score = datasets::Evaluate(*result, log);
  const bool right = score.topology_correct.value_or(false);
  const double rmse_m = score.landmarks->rmse_m.value_or(-1.0);
  tally->right += right ? 1 : 0;
  for (Tally::Stated* stated : {&tally->stated[datasets::ReadConfidence(*result)],
                                &tally->verdicts[datasets::LandmarkMapVerdict(*result).trust]}) {
    ++stated->jobs;
    stated->right += right ? 1 : 0;
  }
  tally->complete += score.landmarks->missed == 0 && score.landmarks->spurious == 0 ? 1 : 0;
  if (right) tally->rmse_m.push_back(rmse_m);
  std::printf("%s: topology %s, %lld found, %lld missed, %lld spurious, rmse %.2f m, path %.2f m; %s\n",
              name.c_str(), right ? "right" : "wrong", static_cast<long long>(score.landmarks->found),
              static_cast<long long>(score.landmarks->missed),
              static_cast<long long>(score.landmarks->spurious), rmse_m,
              score.trajectory_rmse_m.value_or(-1.0), datasets::LandmarkMapVerdict(*result).Text().c_str());
  std::fflush(stdout);
}

// Calls f(log, arguments of its seed) for each seed.
template <class F>
void ForEachSeed(Arguments arguments, const F& f) {
  arguments.world.difficulty = arguments.words[0];
  for (std::uint64_t seed = std::stoull(arguments.words[1]); seed <= std::stoull(arguments.words[2]);
       ++seed) {
    arguments.world.seed = seed;
    f(datasets::SimulateLoop(arguments.world), arguments);
  }
}

void RunSeeds(const Arguments& arguments, Tally* tally) {
  ForEachSeed(arguments, [&](const Blob& log, const Arguments& of_seed) {
    RunLog("seed " + std::to_string(of_seed.world.seed), log, of_seed, tally);
  });
}

int PrintFigures(const Arguments& arguments) {
  Ranges ranges;
  ForEachSeed(arguments, [&](const Blob& log, const Arguments&) { AddFigures(log, &ranges); });
  for (const auto& [name, range] : ranges.of)
    std::printf("%s %s: %.4g to %.4g\n", arguments.words[0].c_str(), name.c_str(), range.first, range.second);
  return 0;
}

Blob ImportFolder(const std::filesystem::path& folder) {
  datasets::CsvImportOptions options;
  options.odometry = folder / "odometry.csv.gz";
  options.observations = folder / "observations.csv";
  options.truth_poses = folder / "truth_poses.csv.gz";
  options.truth_landmarks = folder / "truth_landmarks.csv";
  options.truth_associations = folder / "truth_associations.csv";
  Blob log;
  datasets::ImportCsv(options, &log);
  return log;
}

void RunFolders(const Arguments& arguments, Tally* tally) {
  std::vector<std::filesystem::path> folders;
  for (const auto& entry : std::filesystem::directory_iterator(arguments.csv)) {
    if (std::filesystem::exists(entry.path() / "odometry.csv.gz")) folders.push_back(entry.path());
  }
  std::ranges::sort(folders);
  for (const auto& folder : folders) RunLog(folder.filename(), ImportFolder(folder), arguments, tally);
}

std::string Title(const Arguments& arguments) {
  if (!arguments.csv.empty()) return arguments.csv;
  return arguments.words[0] + ", seeds " + arguments.words[1] + " to " + arguments.words[2];
}

// The words with a '=' are options of the stage.
void TakeStageOptions(Arguments* arguments) {
  arguments->stage.set_name("landmarks");
  arguments->stage.set_pipeline("landmark_map");
  std::erase_if(arguments->words, [&](const std::string& word) {
    if (word.find('=') == std::string::npos) return false;
    SetOption(word, &arguments->stage);
    return true;
  });
  if (arguments->words.size() != (arguments->csv.empty() ? 3U : 0U)) {
    throw InputError("say DIFFICULTY FIRST LAST, or --csv DIR; see --help");
  }
}

int Main(const Arguments& arguments) {
  if (arguments.statistics) return PrintFigures(arguments);
  Tally tally;
  arguments.csv.empty() ? RunSeeds(arguments, &tally) : RunFolders(arguments, &tally);
  if (tally.jobs == 0) throw InputError(Title(arguments) + ": no logs");
  std::ranges::sort(tally.rmse_m);
  std::printf(
      "%s: topology right in %d of %d, every landmark and no other in %d; median landmark rmse of the right "
      "%.2f m; %.2f s of processor time a job\n",
      Title(arguments).c_str(), tally.right, tally.jobs, tally.complete,
      tally.rmse_m.empty() ? -1.0 : tally.rmse_m[tally.rmse_m.size() / 2], tally.seconds / tally.jobs);
  for (const auto& [confidence, stated] : tally.stated)
    std::printf("confidence %s: topology right in %d of %d\n", datasets::Word(confidence), stated.right,
                stated.jobs);
  for (const auto& [confidence, stated] : tally.verdicts)
    std::printf("verdict %s: topology right in %d of %d\n", datasets::Word(confidence), stated.right,
                stated.jobs);
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) {
  CLI::App app("How often landmark_map finds the right topology, and how exact its landmarks are");
  cairn::Arguments arguments;
  app.add_option("words", arguments.words, "DIFFICULTY FIRST LAST, and key=value for the stage's options");
  app.add_option("--csv", arguments.csv, "Logs from the folders in this one, instead of simulated ones");
  app.add_flag("--rounds", arguments.rounds, "A line a round, too");
  app.add_flag("--statistics", arguments.statistics, "Print the ranges of the logs' statistics, map nothing");
  app.add_flag("--unstated", arguments.unstated,
               "Leave the rates of false and missed observations out of the logs");
  cairn::cli::AddLoopOptions(cairn::cli::Command(&app), &arguments.world);
  CLI11_PARSE(app, argc, argv);
  try {
    cairn::TakeStageOptions(&arguments);
    return cairn::Main(arguments);
  } catch (const cairn::InputError& error) {
    std::fprintf(stderr, "topology_rate: %s\n", error.what());
    return 2;
  }
}
