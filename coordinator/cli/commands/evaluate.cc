#include "datasets/evaluate/evaluate.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/result_file.h"
#include "coordinator/cli/common/scalar.h"
#include "datasets/evaluate/features.h"
#include "datasets/evaluate/grid.h"
#include "datasets/evaluate/local.h"
#include "datasets/evaluate/localization.h"
#include "datasets/evaluate/networks.h"
#include "datasets/evaluate/relations.h"

namespace cairn::cli {
namespace {

struct EvaluateArguments {
  bool changed = false;
  std::string result;
  std::string truth;
  std::vector<std::string> features, holdout;
  std::string against;
  std::string relations, robot;
  double offset_s = 0;
  bool json = false;
  std::optional<int> nearest;
  std::optional<double> heading_window_deg;
  std::optional<std::uint64_t> seed;
};

datasets::Scores ScoreOfMap(const EvaluateArguments& options, const Blob& log) {
  if (options.nearest || options.seed || options.heading_window_deg)
    throw InputError(
        "--nearest, --seed and --heading-window-deg are for networks, whose truth is a file of samples");
  return ScoresOf(datasets::Evaluate(ReadResult(options.result, "landmark_map", options.changed).blob, log));
}

datasets::ScoreOptions HowToScore(const EvaluateArguments& options) {
  datasets::ScoreOptions how;
  how.nearest = options.nearest.value_or(how.nearest);
  how.heading_window_deg = options.heading_window_deg;
  how.seed = options.seed.value_or(how.seed);
  how.samples_name = options.truth;
  return how;
}

datasets::Scores ScoreOfNetworks(const EvaluateArguments& options, const Blob& samples) {
  datasets::ScoreOptions how = HowToScore(options);
  how.map_name = ResultPath(options.result, "networks");
  how.samples_name = options.truth;
  const Blob networks = ReadResult(how.map_name, "networks", options.changed).blob;
  return ScoresOf(datasets::EvaluateNetworks(networks, samples, how));
}

datasets::Scores ScoreOfFeatures(const EvaluateArguments& options) {
  datasets::ScoreOptions how = HowToScore(options);
  how.map_name = ResultPath(options.result, "samples");
  const Blob samples = ReadResult(how.map_name, "samples", options.changed).blob;
  std::optional<Blob> truth;
  if (!options.truth.empty()) truth = ReadResult(options.truth, "samples", options.changed).blob;
  const datasets::FeatureEvaluation score =
      datasets::EvaluateFeatures(samples, truth ? &*truth : nullptr, options.features, options.holdout, how);
  std::optional<datasets::Detection> detection;
  if (!options.against.empty())
    detection = datasets::CompareFeatures(samples, options.features.front(), options.against);
  return ScoresOf(score, detection);
}

void CheckFeatureOptions(const EvaluateArguments& options) {
  if (options.features.empty() && !(options.holdout.empty() && options.against.empty()))
    throw InputError("--holdout and --against are for hand-made features: name one by --feature");
  if (!options.against.empty() && options.features.size() != 1)
    throw InputError("--against compares one feature with another");
  if (!options.truth.empty() && !options.holdout.empty())
    throw InputError("--truth and --holdout both say what is held out; one will do");
  if (options.features.empty() && options.truth.empty())
    throw InputError(
        "--truth is needed (or --feature, for hand-made features of samples; or --relations, for poses)");
}

datasets::Scores ScoreOfLocalization(const EvaluateArguments& options, const Blob& samples) {
  if (options.nearest || options.seed || options.heading_window_deg)
    throw InputError("--nearest, --seed and --heading-window-deg are for networks");
  return ScoresOf(datasets::EvaluateLocalization(
      ReadResult(options.result, "localization", options.changed).blob, samples));
}

// A folder counts as one where it holds that and no networks.
bool IsLocalization(const std::string& result) {
  if (std::filesystem::is_regular_file(result)) return Take(ListBlobFile(result)).kind == "localization";
  bool is = false;
  for (const std::string& file : FilesOf(result)) {
    const std::string kind = Take(ListBlobFile(file)).kind;
    if (kind == "networks") return false;
    is |= kind == "localization";
  }
  return is;
}

datasets::Scores ScoreOnSamples(const EvaluateArguments& options, const Blob& samples) {
  return IsLocalization(options.result) ? ScoreOfLocalization(options, samples)
                                        : ScoreOfNetworks(options, samples);
}

// A folder counts as one where it holds a grid map and no landmark map.
bool IsGridMap(const std::string& result) {
  if (std::filesystem::is_regular_file(result)) return Take(ListBlobFile(result)).kind == "grid_map";
  bool is = false;
  for (const std::string& file : FilesOf(result)) {
    const std::string kind = Take(ListBlobFile(file)).kind;
    if (kind == "landmark_map") return false;
    is |= kind == "grid_map";
  }
  return is;
}

datasets::Scores ScoreOfGrid(const EvaluateArguments& options, const BlobFile& truth) {
  if (options.nearest || options.seed || options.heading_window_deg)
    throw InputError("--nearest, --seed and --heading-window-deg are for networks");
  const Blob map = ReadResult(options.result, "grid_map", options.changed).blob;
  return ScoresOf(truth.kind == "log" ? datasets::EvaluateGrid(map, truth.blob)
                                      : datasets::CompareGrids(map, truth.blob));
}

// A folder counts as one where it holds that and no map that may have been made of it.
bool IsLocalMap(const std::string& result) {
  if (std::filesystem::is_regular_file(result)) return Take(ListBlobFile(result)).kind == "local_map";
  const std::vector<std::string> files = FilesOf(result);
  const auto is = [](const char* kind) {
    return [kind](const std::string& file) { return Take(ListBlobFile(file)).kind == kind; };
  };
  return std::ranges::any_of(files, is("local_map")) && std::ranges::none_of(files, is("grid_map"));
}

datasets::Scores ScoreOfLocalMap(const EvaluateArguments& options, const Blob& log) {
  if (options.nearest || options.seed || options.heading_window_deg)
    throw InputError("--nearest, --seed and --heading-window-deg are for networks");
  return ScoresOf(
      datasets::EvaluateLocal(ReadResult(options.result, "local_map", options.changed).blob, log));
}

// A file of any kind that has poses, or those of a folder: of its landmark_map or local_map, else of its
// grid_map.
Blob PosesOf(const EvaluateArguments& options) {
  const std::string& path = options.result;
  if (std::filesystem::is_regular_file(path)) return ReadFile(path, options.changed).blob;
  const std::vector<std::string> files = FilesOf(path);
  for (const char* kind : {"landmark_map", "local_map"}) {
    const auto is = [&](const std::string& file) { return Take(ListBlobFile(file)).kind == kind; };
    if (std::ranges::any_of(files, is)) return ReadResult(path, kind, options.changed).blob;
  }
  return ReadResult(path, "grid_map", options.changed).blob;
}

datasets::Scores ScoreOfRelations(const EvaluateArguments& options) {
  if (!options.truth.empty() || !options.features.empty())
    throw InputError(
        "--relations are what is held against the poses: neither --truth nor --feature goes with it");
  const datasets::Track track = datasets::TrajectoryOf(PosesOf(options), options.robot);
  return ScoresOf(
      datasets::ScoreRelations(track, datasets::ReadRelations(options.relations), options.offset_s));
}

// What the truth is says what is scored: the folder of a job may hold results of several kinds.
datasets::Scores ScoreOf(const EvaluateArguments& options) {
  if (!options.relations.empty()) return ScoreOfRelations(options);
  CheckFeatureOptions(options);
  if (!options.features.empty()) return ScoreOfFeatures(options);
  const BlobFile truth = ReadFile(ResultPath(options.truth, "log"), options.changed);
  if (truth.kind == "grid_map" || (truth.kind == "log" && IsGridMap(options.result)))
    return ScoreOfGrid(options, truth);
  if (truth.kind == "log" && IsLocalMap(options.result)) return ScoreOfLocalMap(options, truth.blob);
  if (truth.kind == "log") return ScoreOfMap(options, truth.blob);
  if (truth.kind == "samples") return ScoreOnSamples(options, truth.blob);
  throw InputError(options.truth + ": a " + truth.kind + ", where a log, samples or a grid_map are needed");
}

int Evaluate(const EvaluateArguments& options, const Invocation&) {
  const datasets::Scores scores = ScoreOf(options);
  std::fputs((options.json ? scores.ToJson() + "\n" : scores.ToText()).c_str(), stdout);
  return kExitDone;
}

}  // namespace

void AddEvaluate(Command app, Invocation& call) {
  Command command;
  const auto options =
      AddCommand<EvaluateArguments>(app, call, "evaluate", "Scores a result against ground truth",
                                    "cairn evaluate result --truth log.h5 --json", Evaluate, &command);
  command.Add("RESULT", options->result, "A result file, or the folder given as --out").Required();
  command.Add(
      "--truth", options->truth,
      "For a landmark_map or a local_map a simulated log, or an imported one that has truth; for a grid_map "
      "the log that it "
      "is "
      "made of, or another grid_map; for networks samples "
      "of runs that they were not trained on; for a localization the samples that it is of; for hand-made "
      "features samples of other runs");
  command.Add("--feature", options->features,
              "RESULT is samples: score this hand-made feature of them (again: several together)");
  command.Add("--holdout", options->holdout,
              "With --feature: the run to score on, the map being of the others (again: several); "
              "without it and --truth each run in turn");
  command.Add("--against", options->against,
              "With --feature: the feature that it should find; prints precision and recall");
  const Argument relations =
      command.Add("--relations", options->relations,
                  "RESULT has poses, or is a log: score them by a relations file of the SLAM benchmark");
  command
      .Add("--offset-s", options->offset_s,
           "With --relations: what their clock says when that of the poses says 0")
      .Needs(relations);
  command.Add("--robot", options->robot, "With --relations: whose poses, where there are several robots")
      .Needs(relations);
  command.AddFlag("--json", options->json, "As JSON");
  AddChangedFlag(command, &options->changed);
  command.Add("--nearest", options->nearest,
              "Networks, features: training samples, of which the features at a place are the mean (5)");
  command
      .Add("--heading-window-deg", options->heading_window_deg,
           "Networks, features: what the robot knows of its heading, in samples that do not all face one "
           "way; 180: nothing (what the networks were trained for; features: 180)")
      .Within(0.0, 180.0);
  command
      .Add("--seed", options->seed,
           "Networks, features: of the sampled features and of the intervals' bootstrap (1)")
      .Check(CheckSeed);
}

}  // namespace cairn::cli
