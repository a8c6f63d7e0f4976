#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "coordinator/cli/commands/folder_jobs.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/result_file.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/common/suggest.h"
#include "datasets/common/made_from.h"
#include "datasets/evaluate/learning/features.h"
#include "datasets/evaluate/relations.h"
#include "datasets/kinds/result_kinds.h"
#include "schema/kinds/kind.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

struct EvaluateArguments {
  bool changed = false;
  std::string result;
  std::string truth;
  std::vector<std::string> features, holdout;
  std::string against;
  std::string relations, robot, reference_point;
  double offset_s = 0;
  bool json = false;
  std::optional<int> nearest;
  std::optional<double> heading_window_deg;
  std::optional<std::uint64_t> seed;
};

datasets::ScoreOptions HowToScore(const EvaluateArguments& options) {
  datasets::ScoreOptions how;
  how.nearest = options.nearest.value_or(how.nearest);
  how.heading_window_deg = options.heading_window_deg;
  how.seed = options.seed.value_or(how.seed);
  if (!options.reference_point.empty())
    how.reference_point = datasets::ReferencePoint::Parse(options.reference_point);
  how.samples_name = options.truth;
  return how;
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
  return MakeScores(score, detection);
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

std::vector<std::string> KindsIn(const std::string& result) {
  std::vector<std::string> kinds;
  for (const std::string& file :
       std::filesystem::is_regular_file(result) ? std::vector{result} : FilesOf(result))
    kinds.push_back(Take(ListBlobFile(file)).kind);
  return kinds;
}

// What the truth is says what is scored: the folder of a job may hold results of several kinds, of which the
// first in the table counts.
const datasets::ResultKind& KindToScore(const std::string& result, const std::string& truth,
                                        const std::string& truth_kind) {
  std::vector<std::string> fitting;
  const std::vector<std::string> there = KindsIn(result);
  for (const datasets::ResultKind& row : datasets::ResultKinds()) {
    if (row.made_of != truth_kind && !(row.compares && row.name == truth_kind)) continue;
    fitting.emplace_back(row.name);
    if (std::ranges::find(there, row.name) != there.end()) return row;
  }
  if (fitting.empty())
    throw InputError(truth + ": " + WithArticle(truth_kind) +
                     ", where a log, samples or a grid_map are needed");
  throw InputError(result + ": " + (there.empty() ? "no result" : WithArticle(Join(there))) + ", where " +
                   Join(fitting) + " can be held against " + WithArticle(truth_kind));
}

datasets::Scores ScoreOfResult(const EvaluateArguments& options, const BlobFile& truth) {
  const datasets::ResultKind& row = KindToScore(options.result, options.truth, truth.kind);
  if (!row.takes_score_options && (options.nearest || options.seed || options.heading_window_deg))
    throw InputError(
        "--nearest, --seed and --heading-window-deg are for networks, whose truth is a file of samples");
  const std::string kind(row.name);
  if (!options.reference_point.empty() && kind != "landmark_map")
    throw InputError("--reference-point is for the true poses of a landmark_map");
  datasets::ScoreOptions how = HowToScore(options);
  how.map_name = ResultPath(options.result, kind);
  WarnOfSeveralJobs(options.result, "it is " + Escaped(how.map_name) + " that is scored");
  const Blob result = ReadResult(how.map_name, kind, options.changed).blob;
  // A log that a map was not made from is refused. Two maps may be of two drives through one place.
  if (truth.kind == kind && datasets::MadeFromOtherLogs(result, truth.blob))
    std::fprintf(stderr,
                 "cairn: warning: %s and %s were made from two logs: they are compared as if of one place, "
                 "in one frame\n",
                 Escaped(how.map_name).c_str(), Escaped(options.truth).c_str());
  return MakeScores(row.evaluate(result, truth.blob, how));
}

datasets::Scores ScoreOfRelations(const EvaluateArguments& options) {
  if (!options.truth.empty() || !options.features.empty())
    throw InputError(
        "--relations are what is held against the poses: neither --truth nor --feature goes with it");
  const BlobFile poses =
      ReadFirstOf(options.result, {"landmark_map", "local_map", "grid_map"}, options.changed);
  WarnOfSeveralJobs(options.result, "it is the " + poses.kind + " that is scored");
  const datasets::Track track = datasets::ReadTrajectory(poses.blob, options.robot);
  return MakeScores(
      datasets::ScoreRelations(track, datasets::ReadRelations(options.relations), options.offset_s));
}

datasets::Scores ScoreOf(const EvaluateArguments& options) {
  if (!options.relations.empty()) return ScoreOfRelations(options);
  CheckFeatureOptions(options);
  if (!options.features.empty()) return ScoreOfFeatures(options);
  const BlobFile truth = ReadFirstOf(options.truth, {"log", "samples", "grid_map"}, options.changed);
  return ScoreOfResult(options, truth);
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
  command.Add("--reference-point", options->reference_point,
              "landmark_map: of which point of the robots the true poses are, X,Y in metres ahead and to the "
              "left; estimate: it, and the scale of the true positions, by the path, with the calibration "
              "that is left");
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
