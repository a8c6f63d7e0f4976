#include "worker/peer_log.h"

#include "schema/text.h"
#include "schema/wire/limits.h"

namespace cairn::worker {

void PeerLog::Say(Topic topic, Severity severity, const std::string& line, double now_s) {
  const auto [it, first] = topics_.try_emplace(topic);
  Told& told = it->second;
  if (!first && now_s - told.at_s < kQuiet_s) {
    ++told.untold;
    return;
  }
  std::string text = Printable(line, wire::JobLimits().text_bytes);
  if (told.untold > 0) text += " (and " + std::to_string(told.untold) + " more of this kind)";
  told = {now_s, 0};
  sink_(severity, text);
}

}  // namespace cairn::worker
