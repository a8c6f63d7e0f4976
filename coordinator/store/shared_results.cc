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

Result<SharedResult> SharedResults::Read(const std::filesystem::path& path) {
  const Version version = VersionOf(path);
  const auto known = entries_.find(path);
  BlobPtr blob =
      known != entries_.end() && known->second.version == version ? known->second.blob.lock() : nullptr;
  if (blob == nullptr) {
    Result<BlobFile> file = ReadStoredFile(path);
    if (!file.ok()) return file.status();
    blob = std::make_shared<const Blob>(std::move(file).value().blob);
    if (entries_.size() >= kMostRemembered)
      std::erase_if(entries_, [](const auto& entry) { return entry.second.blob.expired(); });
    entries_[path] = {version, blob, blob->ContentHash(), blob->Without("provenance/").ContentHash(),
                      blob->ByteCount()};
  }
  const Entry& entry = entries_.at(path);
  Result<BlobPtr> held = HeldByItsArrays(blob);
  if (!held.ok()) return held.status();
  return SharedResult{{entry.hash, std::move(held).value()}, entry.result};
}

bool SharedResults::IsAtHand(const std::filesystem::path& path) const {
  const Version version = VersionOf(path);
  const auto known = entries_.find(path);
  return version == Version{} ||
         (known != entries_.end() && known->second.version == version && !known->second.blob.expired());
}

std::uint64_t SharedResults::Bytes(const std::filesystem::path& path) const {
  const Version version = VersionOf(path);
  const auto known = entries_.find(path);
  if (known != entries_.end() && known->second.version == version) return known->second.bytes;
  return static_cast<std::uint64_t>(version[2]);
}

}  // namespace cairn::coordinator
