#include <algorithm>
#include <nlohmann/json.hpp>

#include "datasets/common/array_text.h"
#include "datasets/inspect/inspect.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

// One line of a text that may be long and of many lines.
std::string OneLine(std::string text) {
  constexpr std::size_t kMost = 70;
  std::ranges::replace_if(text, [](unsigned char c) { return c < ' '; }, ' ');
  if (text.size() <= kMost) return text;
  std::size_t end = kMost;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // not within a character
  return text.substr(0, end) + "…";
}

std::string ValuesText(const DatasetSummary& dataset) {
  if (!dataset.sample.empty()) return OneLine(dataset.sample);
  std::string text = dataset.low ? ShortNumber(*dataset.low) + " to " + ShortNumber(*dataset.high) : "";
  if (dataset.not_finite > 0)
    text += (text.empty() ? "" : ", ") + std::to_string(dataset.not_finite) + " not finite";
  return text;
}

nlohmann::json Json(const DatasetSummary& dataset) {
  nlohmann::json json{{"name", dataset.info.name},
                      {"type", DTypeName(dataset.info.type)},
                      {"shape", dataset.info.shape},
                      {"unit", dataset.info.unit},
                      {"stored_bytes", dataset.info.stored_bytes},
                      {"not_finite", dataset.not_finite}};
  json["low"] = dataset.low ? nlohmann::json(*dataset.low) : nlohmann::json();
  json["high"] = dataset.high ? nlohmann::json(*dataset.high) : nlohmann::json();
  if (!dataset.sample.empty()) json["sample"] = dataset.sample;
  return json;
}

}  // namespace

std::string InspectText(const Inspection& inspection) {
  std::string text = inspection.kind + ", format " + std::to_string(inspection.format) + ", content " +
                     inspection.hash + "\n";
  if (inspection.changed)
    text += "CHANGED by another program since Cairn wrote it: not what Cairn computed\n";
  if (!inspection.wrong.empty())
    text += "WRONG: " + inspection.wrong +
            (inspection.wrong_truth
                 ? "; a job, which leaves the truth behind, takes it, and `cairn diff`; no other "
                   "command does\n"
                 : "; but for `cairn diff` no other command takes it\n");
  std::size_t name_width = 0, fact_width = 0;
  for (const auto& [name, fact] : inspection.facts) fact_width = std::max(fact_width, TextColumns(name));
  for (const DatasetSummary& dataset : inspection.datasets)
    name_width = std::max(name_width, TextColumns(dataset.info.name));
  for (const auto& [name, fact] : inspection.facts)
    text += "  " + Padded(name, fact_width) + "  " + fact + "\n";
  for (const std::string& doubt : inspection.unit_doubts) text += "  in doubt: " + doubt + "\n";
  for (const std::string& warning : inspection.warnings) text += "  warning: " + warning + "\n";
  text += "\n";
  for (const DatasetSummary& dataset : inspection.datasets) {
    std::string line =
        "  " + Padded(dataset.info.name, name_width) + "  " + Padded(DTypeName(dataset.info.type), 7) + "  " +
        Padded(ShapeText(dataset.info.shape), 12) + "  " +
        Padded(dataset.info.unit == "1" ? "" : dataset.info.unit, 5) + "  " + ValuesText(dataset);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string InspectJson(const Inspection& inspection) {
  nlohmann::json facts = nlohmann::json::object(), datasets = nlohmann::json::array();
  for (const auto& [name, fact] : inspection.facts) facts[name] = fact;
  for (const DatasetSummary& dataset : inspection.datasets) datasets.push_back(Json(dataset));
  const nlohmann::json json{{"kind", inspection.kind},
                            {"format", inspection.format},
                            {"content", inspection.hash},
                            {"changed", inspection.changed},
                            {"wrong", inspection.wrong},
                            {"wrong_truth_only", inspection.wrong_truth},
                            {"facts", facts},
                            {"unit_doubts", inspection.unit_doubts},
                            {"warnings", inspection.warnings},
                            {"datasets", datasets}};
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace cairn::datasets
