#include "coordinator/store/result_file.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <numeric>
#include <span>
#include <vector>

#include "coordinator/store/job_yaml.h"
#include "schema/kinds/kind.h"
#include "schema/store/blob_file.h"

namespace cairn::coordinator {

std::string UtcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text.data();
}

namespace {

void PutRounds(Blob& blob, const proto::StageFacts& facts) {
  std::vector<std::string> notes;
  std::vector<std::int64_t> tasks, rounds;
  std::vector<double> seconds, compute_s;
  for (const proto::RoundFacts& round : facts.rounds()) {
    notes.push_back(round.note());
    tasks.push_back(static_cast<std::int64_t>(round.tasks()));
    rounds.push_back(std::max<std::int64_t>(1, static_cast<std::int64_t>(round.rounds())));
    seconds.push_back(round.seconds());
    compute_s.push_back(round.compute_seconds());
  }
  blob.PutScalar<double>("provenance/seconds_s", std::accumulate(seconds.begin(), seconds.end(), 0.0));
  blob.Put("provenance/round/note", Array::Texts(notes));
  blob.PutVector<std::int64_t>("provenance/round/rounds", rounds);
  blob.PutVector<std::int64_t>("provenance/round/tasks", tasks);
  blob.PutVector<double>("provenance/round/seconds_s", seconds);
  blob.PutVector<double>("provenance/round/compute_s", compute_s);
}

}  // namespace

Blob WithProvenance(const Blob& result, const proto::Checkpoint& checkpoint, std::uint32_t stage,
                    const std::string& finished_utc) {
  const int index = static_cast<int>(stage);
  const proto::StageFacts facts =
      index < checkpoint.facts_size() ? checkpoint.facts(index) : proto::StageFacts();
  const proto::Stage& plan = checkpoint.job().stages(index);
  const wire::Build& build = checkpoint.build();
  Blob blob = result.Without("provenance/");
  const auto text = [&blob](const char* name, const std::string& value) {
    blob.Put(name, Array::Text(value));
  };
  text("provenance/job_yaml", JobAsYaml(checkpoint.job()));
  const std::string job = checkpoint.job().SerializeAsString();
  blob.Put("provenance/job",
           Array::Of<std::uint8_t>({static_cast<std::int64_t>(job.size())},
                                   std::span(reinterpret_cast<const std::uint8_t*>(job.data()), job.size())));
  text("provenance/stage", plan.name());
  text("provenance/kind", KindOf(result));
  text("provenance/version", build.version());
  text("provenance/build", build.compiler() + "; " + build.flags() + "; " + build.libc());
  text("provenance/finished_utc", finished_utc);
  blob.Put("provenance/hosts", Array::Texts({facts.hosts().begin(), facts.hosts().end()}));
  blob.PutScalar<std::int64_t>("provenance/workers", facts.workers());
  blob.PutScalar<std::int64_t>("provenance/retries", static_cast<std::int64_t>(facts.retries()));
  PutRounds(blob, facts);
  return blob;
}

Result<PublishedResult> ReadPublished(const std::filesystem::path& path) {
  Result<BlobFile> file = ReadStoredFile(path);
  if (!file.ok()) return file.status();
  const Blob& blob = file.value().blob;
  PublishedResult result;
  try {
    const std::span<const std::uint8_t> job = blob.Get<std::uint8_t>("provenance/job");
    if (!result.job.ParseFromArray(job.data(), static_cast<int>(job.size())))
      return Status(Code::kCorrupt, path.string() + ": its job cannot be parsed");
    result.stage = blob.Text("provenance/stage");
    result.seconds = blob.Scalar<double>("provenance/seconds_s");
  } catch (const InputError& error) {
    return Status(Code::kCorrupt, path.string() + ": " + error.what());
  }
  result.hash = blob.Without("provenance/").ContentHash();
  return result;
}

}  // namespace cairn::coordinator
