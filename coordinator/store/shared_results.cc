#include "coordinator/store/shared_results.h"

#include <sys/stat.h>

#include <utility>

#include "schema/store/blob_file.h"

namespace cairn::coordinator {
namespace {

constexpr std::size_t kMostRemembered = 4096;  // files of which nothing is in memory any more

// Each of its arrays keeps all of it: arrays are sent without their blob.
Result<BlobPtr> HeldByItsArrays(const BlobPtr& blob) {
  Blob::Fields fields;
  for (const auto& [name, array] : blob->fields()) {
    Result<Array> held = Array::Over(array.type(), array.item_bytes(), array.shape(), array.bytes(), blob);
    if (!held.ok()) return held.status();
    fields.emplace(name, std::move(held).value());
  }
  return std::make_shared<const Blob>(std::move(fields));
}

}  // namespace

SharedResults::Version SharedResults::VersionOf(const std::filesystem::path& path) {
  struct stat about{};
  if (::stat(path.c_str(), &about) != 0) return {};
  return {static_cast<std::int64_t>(about.st_dev),
          static_cast<std::int64_t>(about.st_ino),
          about.st_size,
          about.st_mtim.tv_sec,
          about.st_mtim.tv_nsec,
          about.st_ctim.tv_sec,
          about.st_ctim.tv_nsec};
}

SharedResults::Loaded SharedResults::Load(const std::filesystem::path& path) {
  Loaded loaded;
  loaded.path = path;
  loaded.version = VersionOf(path);
  Result<BlobFile> file = ReadStoredFile(path);
  loaded.status = file.status();
  if (!file.ok()) return loaded;
  loaded.blob = std::make_shared<const Blob>(std::move(file).value().blob);
  loaded.hash = loaded.blob->ContentHash();
  loaded.result = loaded.blob->Without("provenance/").ContentHash();
  return loaded;
}

void SharedResults::Keep(const Loaded& loaded) {
  if (entries_.size() >= kMostRemembered)
    std::erase_if(entries_, [](const auto& entry) { return entry.second.blob.expired(); });
  entries_[loaded.path] = {loaded.version, loaded.status, loaded.blob,
                           loaded.hash,    loaded.result, loaded.blob ? loaded.blob->ByteCount() : 0};
}

void SharedResults::ForgetFailures() {
  std::erase_if(entries_, [](const auto& entry) { return !entry.second.status.ok(); });
}

Result<SharedResult> SharedResults::Get(const std::filesystem::path& path) const {
  const Version version = VersionOf(path);
  if (version == Version{}) return Status(Code::kNotFound, path.string() + ": nothing is there");
  const auto known = entries_.find(path);
  if (known == entries_.end() || known->second.version != version)
    return Status(Code::kBusy, path.string() + ": has yet to be read");
  const Entry& entry = known->second;
  if (!entry.status.ok()) return entry.status;
  const BlobPtr blob = entry.blob.lock();
  if (blob == nullptr) return Status(Code::kBusy, path.string() + ": has yet to be read");
  Result<BlobPtr> held = HeldByItsArrays(blob);
  if (!held.ok()) return held.status();
  return SharedResult{{entry.hash, std::move(held).value()}, entry.result};
}

bool SharedResults::IsAtHand(const std::filesystem::path& path) const {
  const Result<SharedResult> got = Get(path);
  return got.ok() || got.status().code() != Code::kBusy;
}

std::uint64_t SharedResults::Bytes(const std::filesystem::path& path) const {
  const Version version = VersionOf(path);
  const auto known = entries_.find(path);
  if (known != entries_.end() && known->second.version == version) return known->second.bytes;
  return static_cast<std::uint64_t>(version[2]);
}

}  // namespace cairn::coordinator
