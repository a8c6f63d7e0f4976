#include "coordinator/store/checkpoint_file.h"

#include <cmath>
#include <limits>
#include <span>

#include "coordinator/core/round.h"
#include "coordinator/store/job_yaml.h"
#include "schema/blob.h"
#include "schema/store/blob_file.h"

namespace cairn::coordinator {
namespace {

bool IsHash(const std::string& binary) { return binary.size() == sizeof(Hash::bytes); }

// A core that restores it may rely on this.
std::string WhatIsWrong(const proto::Checkpoint& checkpoint) {
  if (checkpoint.job_id().empty() || checkpoint.number() == 0) return "it names no job or has no number";
  if (checkpoint.results_size() != static_cast<int>(checkpoint.stage()))
    return "its results are not its stages'";
  for (const std::string& hash : checkpoint.results())
    if (!IsHash(hash)) return "a result has no hash";
  for (const std::string& hash : checkpoint.blobs())
    if (!IsHash(hash)) return "a blob has no hash";
  if (static_cast<int>(checkpoint.stage()) > checkpoint.job().stages_size())
    return "it has more stages than its job";
  if (!(checkpoint.ended_served_s() >= 0 && std::isfinite(checkpoint.ended_served_s())))
    return "it ended at no time";
  return checkpoint.has_step() ? CheckStep(checkpoint.step()) : "";
}

}  // namespace

Status WriteCheckpoint(const std::filesystem::path& path, const proto::Checkpoint& checkpoint) {
  const std::string bytes = checkpoint.SerializeAsString();
  Blob blob;
  blob.Put("checkpoint", Array::Of<std::uint8_t>(
                             {static_cast<std::int64_t>(bytes.size())},
                             std::span(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size())));
  blob.Put("job_yaml", Array::Text(JobAsYaml(checkpoint.job())));
  return WriteBlobFile(path, "checkpoint", blob);
}

Result<proto::Checkpoint> ParseCheckpoint(std::span<const std::uint8_t> bytes) {
  proto::Checkpoint checkpoint;
  if (bytes.size() > std::numeric_limits<int>::max() ||
      !checkpoint.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    return Status(Code::kCorrupt, "not a checkpoint");
  const std::string wrong = WhatIsWrong(checkpoint);
  if (!wrong.empty()) return Status(Code::kCorrupt, wrong);
  return checkpoint;
}

Result<proto::Checkpoint> ReadCheckpoint(const std::filesystem::path& path) {
  const Result<BlobFile> file = ReadStoredFile(path, kSmallStoredBytes);
  if (!file.ok()) return file.status();
  try {
    Result<proto::Checkpoint> checkpoint = ParseCheckpoint(file.value().blob.Get<std::uint8_t>("checkpoint"));
    if (checkpoint.ok()) return checkpoint;
    return Status(Code::kCorrupt, path.string() + ": " + checkpoint.status().message());
  } catch (const InputError& error) {
    return Status(Code::kCorrupt, path.string() + ": " + error.what());
  }
}

}  // namespace cairn::coordinator
