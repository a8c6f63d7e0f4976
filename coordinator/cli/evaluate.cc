#include "datasets/evaluate/evaluate.h"

#include <cstdio>

#include "coordinator/cli/invocation.h"
#include "coordinator/cli/result_file.h"

namespace cairn::cli {
namespace {

struct Options {
  std::string result;
  std::string truth;
  bool json = false;
};

int Evaluate(const Options& options, const Invocation&) {
  const BlobFile result = ReadResult(options.result, "landmark_map");
  const BlobFile truth = ReadResult(options.truth, "log");
  const datasets::Evaluation evaluation = datasets::Evaluate(result.blob, truth.blob);
  if (options.json)
    std::printf("%s\n", datasets::EvaluationJson(evaluation).c_str());
  else
    std::fputs(datasets::EvaluationText(evaluation).c_str(), stdout);
  return kExitDone;
}

}  // namespace

void AddEvaluate(CLI::App& app, Invocation& call) {
  CLI::App* command = nullptr;
  const auto options = AddCommand<Options>(app, call, "evaluate", "Scores a result against ground truth",
                                           "cairn evaluate result --truth log.h5 --json", Evaluate, &command);
  command->add_option("RESULT", options->result, "A result file, or the folder given as --out")->required();
  command->add_option("--truth", options->truth, "A simulated log, or an imported one that has truth")
      ->required();
  command->add_flag("--json", options->json, "As JSON");
}

}  // namespace cairn::cli
