// The pages on which a job is started, as HTML: pure functions of what lies on the desk. They are forms,
// which need no script.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "coordinator/page/desk.h"

namespace cairn::page {

struct StartContext {
  std::vector<BroughtFile> files;
  std::uint64_t most_bytes = 0;  // of all of them together
  std::string token;             // that forms have with them
  std::string job = {};          // from which a file may be taken
};

// Which files are here, and the form that brings another. `trouble`: a sentence on what went wrong before;
// empty: nothing did.
std::string FilesHtml(const StartContext& context, const std::string& trouble);
// What is in a file, and which of the `pipelines` (`cairn pipelines --json`) read it.
std::string FileHtml(const StartContext& context, const BroughtFile& file, const nlohmann::json& pipelines);
// The form of a pipeline's options, filled in as `order` says. `said`: what came of it when it was sent;
// HTML.
std::string OrderHtml(const StartContext& context, const BroughtFile& file, const nlohmann::json& pipeline,
                      const JobOrder& order, const std::string& said);
// What a job would take, as `cairn run --dry-run --json` says it.
std::string PlanHtml(const nlohmann::json& plan);

// What `json` has by that name; empty where that is no list.
const nlohmann::json& ListIn(const nlohmann::json& json, const char* name);
// "/new/3"
std::string AddressOf(const BroughtFile& file);

}  // namespace cairn::page
