#include "datasets/evaluate/evaluate.h"

#include <cstdio>
#include <optional>

#include "coordinator/cli/failure.h"
#include "coordinator/cli/invocation.h"
#include "coordinator/cli/result_file.h"
#include "coordinator/cli/scalar.h"
#include "datasets/evaluate/evaluate_networks.h"

namespace cairn::cli {
namespace {

struct Options {
  std::string result;
  std::string truth;
  bool json = false;
  std::optional<int> nearest;
  std::optional<std::uint64_t> seed;
};

std::string ScoreOfMap(const Options& options, const Blob& log) {
  if (options.nearest || options.seed)
    throw InputError("--nearest and --seed are for networks, whose truth is a file of samples");
  const datasets::Evaluation score = datasets::Evaluate(ReadResult(options.result, "landmark_map").blob, log);
  return options.json ? datasets::EvaluationJson(score) + "\n" : datasets::EvaluationText(score);
}

std::string ScoreOfNetworks(const Options& options, const Blob& samples) {
  datasets::ScoreOptions how;
  how.nearest = options.nearest.value_or(how.nearest);
  how.seed = options.seed.value_or(how.seed);
  how.map_name = ResultPath(options.result, "networks");
  how.samples_name = options.truth;
  const Blob networks = ReadResult(how.map_name, "networks").blob;
  const datasets::NetworkEvaluation score = datasets::EvaluateNetworks(networks, samples, how);
  return options.json ? datasets::NetworkEvaluationJson(score) + "\n"
                      : datasets::NetworkEvaluationText(score);
}

// What the truth is says what is scored: the folder of a job may hold results of both kinds.
int Evaluate(const Options& options, const Invocation&) {
  const BlobFile truth = Take(ReadBlobFile(ResultPath(options.truth, "log")));
  std::string text;
  if (truth.kind == "log")
    text = ScoreOfMap(options, truth.blob);
  else if (truth.kind == "samples")
    text = ScoreOfNetworks(options, truth.blob);
  else
    throw InputError(options.truth + ": a " + truth.kind + ", where a log or samples are needed");
  std::fputs(text.c_str(), stdout);
  return kExitDone;
}

}  // namespace

void AddEvaluate(CLI::App& app, Invocation& call) {
  CLI::App* command = nullptr;
  const auto options = AddCommand<Options>(app, call, "evaluate", "Scores a result against ground truth",
                                           "cairn evaluate result --truth log.h5 --json", Evaluate, &command);
  command->add_option("RESULT", options->result, "A result file, or the folder given as --out")->required();
  command
      ->add_option(
          "--truth", options->truth,
          "For a landmark_map a simulated log, or an imported one that has truth; for networks samples "
          "of runs that they were not trained on")
      ->required();
  command->add_flag("--json", options->json, "As JSON");
  command->add_option("--nearest", options->nearest,
                      "Networks: training samples, of which the features at a place are the mean (5)");
  command
      ->add_option("--seed", options->seed,
                   "Networks: of the sampled features and of the intervals' bootstrap (1)")
      ->check(CheckSeed);
}

}  // namespace cairn::cli
