#include "coordinator/server/refusals.h"

#include "schema/text.h"

namespace cairn::coordinator {
namespace {

constexpr std::size_t kReasonBytes = 300;

}  // namespace

void Refusals::Add(const wire::Refusal& refusal, double now_s) {
  const auto [it, fresh] = kinds_.try_emplace(refusal.kind);
  Kind& kind = it->second;
  kind.count += refusal.count;
  kind.untold += refusal.count;
  if (!fresh && now_s - kind.told_s < kQuiet_s) return;
  const std::string more =
      kind.untold > 1 ? " (and " + std::to_string(kind.untold - 1) + " more of this kind)" : "";
  log_(Severity::kWarning, std::string("refused (") + wire::KindName(refusal.kind) +
                               "): " + Printable(refusal.reason, kReasonBytes) + more);
  kind.untold = 0;
  kind.told_s = now_s;
}

std::uint64_t Refusals::count(wire::RefusalKind kind) const {
  const auto it = kinds_.find(kind);
  return it == kinds_.end() ? 0 : it->second.count;
}

std::map<std::string, std::uint64_t> Refusals::Counts() const {
  std::map<std::string, std::uint64_t> counts;
  for (const auto& [kind, facts] : kinds_) counts[wire::KindName(kind)] = facts.count;
  return counts;
}

}  // namespace cairn::coordinator
