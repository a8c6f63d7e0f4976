#include "coordinator/result_file.h"

#include <array>
#include <ctime>
#include <numeric>
#include <vector>

#include "coordinator/checkpoint_file.h"

namespace cairn::coordinator {

std::string UtcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text.data();
}

Blob WithProvenance(const Blob& result, const proto::Checkpoint& checkpoint, std::uint32_t stage,
                    const std::string& finished_utc) {
  const proto::StageFacts facts = static_cast<int>(stage) < checkpoint.facts_size()
                                      ? checkpoint.facts(static_cast<int>(stage))
                                      : proto::StageFacts();
  const std::vector<double> rounds_s(facts.round_seconds().begin(), facts.round_seconds().end());
  Blob blob = result.Without("provenance/");
  const auto text = [&blob](const char* name, const std::string& value) {
    blob.Put(name, Array::Text(value));
  };
  text("provenance/job", JobAsJson(checkpoint.job()));
  text("provenance/kind", checkpoint.job().stages(static_cast<int>(stage)).pipeline());
  text("provenance/version", checkpoint.build().version());
  text("provenance/compiler", checkpoint.build().compiler());
  text("provenance/flags", checkpoint.build().flags());
  text("provenance/libc", checkpoint.build().libc());
  text("provenance/finished_utc", finished_utc);
  blob.Put("provenance/hosts", Array::Texts({facts.hosts().begin(), facts.hosts().end()}));
  blob.PutScalar<std::int64_t>("provenance/workers", facts.workers());
  blob.PutScalar<double>("provenance/wall_s", std::accumulate(rounds_s.begin(), rounds_s.end(), 0.0));
  blob.PutScalar<double>("provenance/compute_s", facts.compute_seconds());
  blob.PutVector<double>("provenance/round_s", rounds_s);
  blob.PutScalar<std::int64_t>("provenance/tasks", static_cast<std::int64_t>(facts.tasks()));
  blob.PutScalar<std::int64_t>("provenance/retries", static_cast<std::int64_t>(facts.retries()));
  return blob;
}

}  // namespace cairn::coordinator
