#include "coordinator/store/result_file.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <numeric>
#include <vector>

#include "coordinator/store/job_yaml.h"
#include "schema/kinds/kind.h"
#include "schema/kinds/provenance.h"
#include "schema/store/blob_file.h"
#include "schema/text.h"

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
  const int index = static_cast<int>(stage);
  const proto::StageFacts facts =
      index < checkpoint.facts_size() ? checkpoint.facts(index) : proto::StageFacts();
  const proto::Stage& plan = checkpoint.job().stages(index);
  const wire::Build& build = checkpoint.build();
  const std::vector<proto::RoundFacts> rounds(facts.rounds().begin(), facts.rounds().end());
  const auto column = [&](const auto& of) { return ColumnOf(rounds, of); };
  const auto count = [](std::uint64_t n) { return static_cast<std::int64_t>(n); };
  kinds::Provenance of;
  of.round.note = column([](const proto::RoundFacts& round) { return CutTo(round.note(), kMostTextBytes); });
  of.round.rounds =
      column([&](const auto& round) { return std::max<std::int64_t>(1, count(round.rounds())); });
  of.round.tasks = column([&](const auto& round) { return count(round.tasks()); });
  of.round.seconds_s = column([](const auto& round) { return round.seconds(); });
  of.round.compute_s = column([](const auto& round) { return round.compute_seconds(); });
  of.seconds_s = std::accumulate(of.round.seconds_s.begin(), of.round.seconds_s.end(), 0.0);
  of.job_yaml = JobAsYaml(checkpoint.job());
  const std::string job = checkpoint.job().SerializeAsString();
  of.job = std::vector<std::uint8_t>(job.begin(), job.end());
  of.stage = plan.name();
  of.kind = KindOf(result);
  of.version = build.version();
  of.build = build.compiler() + "; " + build.flags() + "; " + build.libc() + "; sources " + build.sources();
  of.finished_utc = finished_utc;
  of.hosts = std::vector<std::string>(facts.hosts().begin(), facts.hosts().end());
  of.workers = facts.workers();
  of.retries = count(facts.retries());
  Blob blob = result.Without("provenance/");
  PutFields("provenance/", of, &blob);
  return blob;
}

Result<PublishedResult> ReadPublished(const std::filesystem::path& path) {
  Result<BlobFile> file = ReadStoredFile(path);
  if (!file.ok()) return file.status();
  const Blob& blob = file.value().blob;
  PublishedResult result;
  try {
    const auto of = kinds::Provenance::In(blob);
    if (!result.job.ParseFromArray(of.job.values().data(), static_cast<int>(of.job.size())))
      return Status(Code::kCorrupt, path.string() + ": its job cannot be parsed");
    result.stage = of.stage.Scalar();
    result.seconds = of.seconds_s.Scalar();
  } catch (const InputError& error) {
    return Status(Code::kCorrupt, path.string() + ": " + error.what());
  }
  result.hash = blob.Without("provenance/").ContentHash();
  return result;
}

}  // namespace cairn::coordinator
