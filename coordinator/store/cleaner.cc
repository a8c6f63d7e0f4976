#include "coordinator/store/cleaner.h"

#include <algorithm>

#include "coordinator/store/blob_pack.h"
#include "coordinator/store/checkpoint_file.h"
#include "coordinator/store/recovery.h"
#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

class Cleaner {
 public:
  Cleaner(const StoreFolder& folder, const CleanOptions& options) : folder_(folder), options_(options) {}

  Cleaned Do(const PackLook& look) {
    for (const fs::path& file : Files(folder_.dir()))
      if (options_.damaged && file.extension() == ".damaged") Remove("damaged files", file);
    for (const fs::path& folder : Folders())
      for (const fs::path& file : Leftovers(folder)) Remove("temporary files", file);
    std::set<Hash> needed = options_.needed;
    for (const std::string& job : folder_.JobsWithCheckpoints()) CleanCheckpoints(job, needed);
    GiveUpTheLost();
    if (!cleaned_.note.empty()) return std::move(cleaned_);
    for (const Hash& hash : folder_.BlobsAlone())
      for (const fs::path& file : {folder_.BlobFile(hash), folder_.FlatFile(hash)})
        if (!needed.contains(hash)) Remove("orphaned blobs", file);
    for (const fs::path& pack : folder_.PackFiles()) {
      const std::optional<std::vector<Hash>> hashes = look(pack);
      const auto is_needed = [&needed](const Hash& hash) { return needed.contains(hash); };
      if (hashes && std::ranges::none_of(*hashes, is_needed)) Remove("orphaned packs", pack);
    }
    return std::move(cleaned_);
  }

 private:
  static std::vector<fs::path> Files(const fs::path& dir) {
    std::vector<fs::path> files;
    std::error_code error;
    for (fs::recursive_directory_iterator it(dir, error), end; !error && it != end; it.increment(error))
      if (it->is_regular_file(error)) files.push_back(it->path());
    return files;
  }
  std::vector<fs::path> Folders() const {
    std::vector<fs::path> folders = {folder_.dir()};
    std::error_code error;
    for (fs::recursive_directory_iterator it(folder_.dir(), error), end; !error && it != end;
         it.increment(error))
      if (it->is_directory(error)) folders.push_back(it->path());
    return folders;
  }

  // As the coordinator keeps them: the last two that can be read, of a job that is over its record alone.
  void CleanCheckpoints(const std::string& job, std::set<Hash>& needed) {
    std::vector<std::uint64_t> numbers = folder_.CheckpointNumbers(job);
    std::size_t left = 2;
    for (; !numbers.empty() && left > 0; numbers.pop_back()) {
      const fs::path path = folder_.CheckpointFile(job, numbers.back());
      const Result<proto::Checkpoint> checkpoint = ReadCheckpoint(path);
      if (!checkpoint.ok()) {
        cleaned_.note =
            "no blob was removed, for a checkpoint cannot be read: " + checkpoint.status().message();
        continue;
      }
      for (const std::string& blob : checkpoint.value().blobs())
        needed.insert(Hash::FromBinary(blob).value());
      const proto::JobState state = checkpoint.value().state();
      const bool over = state == proto::JOB_DONE || state == proto::JOB_CANCELLED;
      left = over ? 0 : left - 1;
    }
    for (const std::uint64_t number : numbers) Remove("old checkpoints", folder_.CheckpointFile(job, number));
  }

  void GiveUpTheLost() {
    const Result<std::vector<std::string>> lost = LostJobs(folder_);
    if (!lost.ok()) cleaned_.note = "no blob was removed: " + lost.status().message();
    if (!lost.ok() || lost.value().empty()) return;
    if (!options_.damaged) {
      cleaned_.note =
          "no blob was removed: " + WhyLost(folder_, lost.value().front()) + "; --damaged gives it up";
      return;
    }
    if (!options_.dry_run) {
      Result<JobTable> table = JobTable::Open(folder_.JobTable());
      Status status = table.status();
      for (const std::string& job : lost.value())
        if (status.ok()) status = table.value().NoteRemoval(job);
      if (!status.ok()) cleaned_.note = "no blob was removed: " + status.message();
      if (!status.ok()) return;
    }
    Count("logs of lost jobs", lost.value().size(), 0);
  }

  void Remove(const std::string& what, const fs::path& file) {
    std::error_code error;
    const std::uint64_t bytes = fs::file_size(file, error);
    if (error || (!options_.dry_run && !fs::remove(file, error))) return;
    Count(what, 1, bytes);
  }

  void Count(const std::string& what, std::uint64_t files, std::uint64_t bytes) {
    auto& removed = cleaned_.removed;
    auto kind = std::ranges::find_if(removed, [&](const wire::Cleaned& k) { return k.what() == what; });
    if (kind == removed.end()) {
      kind = removed.emplace(removed.end());
      kind->set_what(what);
    }
    kind->set_files(kind->files() + files);
    kind->set_bytes(kind->bytes() + bytes);
  }

  const StoreFolder& folder_;
  const CleanOptions& options_;
  Cleaned cleaned_;
};

}  // namespace

Cleaned CleanStore(const StoreFolder& folder, const CleanOptions& options, const PackLook& look) {
  return Cleaner(folder, options).Do(look);
}

std::optional<std::vector<Hash>> HashesInPack(const fs::path& pack) {
  const Result<BlobFile> file = ReadStoredFile(pack, kSmallStoredBytes);
  if (!file.ok()) return std::nullopt;
  const Result<std::vector<wire::NamedBlob>> blobs = UnpackBlobs(file.value().blob);
  if (!blobs.ok()) return std::nullopt;
  std::vector<Hash> hashes;
  for (const wire::NamedBlob& named : blobs.value()) hashes.push_back(named.hash);
  return hashes;
}

}  // namespace cairn::coordinator
