// All registered pipelines as JSON, for programs that check job files without linking the science.
#pragma once

#include <string>
#include <vector>

#include "pipelines/registry.h"

namespace cairn::worker {

// {"version": "0.1.0", "pipelines": [{"name", "summary",
//   "inputs":  ["log", "poses?"],      (with '?': optional)
//   "options": [{"name", "type", "unit", "help", "default", "low", "high", "choices"}]}]}
// `type` is real, integer, boolean or text; low and high stand with numbers only, choices with texts that
// have some.
std::string DescribePipelines(const std::vector<PipelineInfo>& pipelines);

}  // namespace cairn::worker
