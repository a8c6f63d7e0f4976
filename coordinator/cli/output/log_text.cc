#include "coordinator/cli/output/log_text.h"

#include <nlohmann/json.hpp>

namespace cairn::cli {

std::string LineText(const wire::LogLine& line) {
  const std::string level = line.level() == "info" ? "" : line.level() + ": ";
  return line.utc() + "  " + level + line.text() + "\n";
}

std::string LineJson(const wire::LogLine& line) {
  const nlohmann::ordered_json json = {
      {"number", line.number()}, {"utc", line.utc()}, {"level", line.level()}, {"text", line.text()}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string GoneText(const wire::LogLine& first) {
  if (first.number() <= 1) return "";
  return "(" + std::to_string(first.number() - 1) + " earlier lines are gone: the oldest go first)\n";
}

}  // namespace cairn::cli
