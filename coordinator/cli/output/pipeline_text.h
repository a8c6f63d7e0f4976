// `cairn pipelines`: what there is to run, for people and for programs, as the catalog knows it.
#pragma once

#include <string>
#include <vector>

#include "coordinator/cli/job_file/catalog.h"
#include "schema/command_line/command.h"

namespace CLI {
class App;
}

namespace cairn::cli {

struct Invocation;

// Adds the command.
void AddPipelines(Command app, Invocation& call);

// A line each.
std::string PipelineList(const std::vector<PipelineSpec>& pipelines);

// What it does and reads, and each of its options: default, unit, range, effect.
std::string PipelineText(const PipelineSpec& pipeline);

std::string PipelinesJson(const std::vector<PipelineSpec>& pipelines);

}  // namespace cairn::cli
