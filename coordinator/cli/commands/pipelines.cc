// cairn pipelines: what there is to run, and all options of one.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/output/pipeline_text.h"

namespace cairn::cli {
namespace {

struct PipelinesArguments {
  std::string pipeline;
  bool json = false;
};

int Pipelines(const PipelinesArguments& options, const Invocation&) {
  const Catalog catalog = LoadCatalog();
  std::vector<PipelineSpec> shown = catalog.pipelines();
  if (!options.pipeline.empty()) shown = {catalog.At(options.pipeline)};
  const std::string text = options.json               ? PipelinesJson(shown)
                           : options.pipeline.empty() ? PipelineList(shown)
                                                      : PipelineText(shown.front());
  std::fputs(text.c_str(), stdout);
  return kExitDone;
}

}  // namespace

void AddPipelines(Command app, Invocation& call) {
  Command command;
  const auto options = AddCommand<PipelinesArguments>(
      app, call, "pipelines", "Which pipelines there are, and the options of one",
      "cairn pipelines\n  cairn pipelines landmark_map", Pipelines, &command);
  command.Add("PIPELINE", options->pipeline, "All options of this one: unit, range, default, effect");
  command.AddFlag("--json", options->json, "As JSON, always with all options");
}

}  // namespace cairn::cli
