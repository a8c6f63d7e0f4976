#include "coordinator/store/blob_files.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <span>
#include <string>
#include <utility>

#include "coordinator/store/blob_pack.h"
#include "coordinator/store/cleaner.h"
#include "schema/store/blob_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSmallBytes = 64 << 10;  // of a blob that may go into a pack
constexpr std::size_t kFewest = 8;             // that are worth one
constexpr std::size_t kMost = 4096;            // in one, which is read whole …
constexpr std::size_t kPackBytes = 16 << 20;   // … and has no more bytes than about this
constexpr std::size_t kOpenPacks = 4;

Result<BlobPtr> ReadAlone(const fs::path& path, const Hash& hash) {
  Result<BlobFile> file = ReadStoredFile(path);
  if (!file.ok()) return file.status();
  auto blob = std::make_shared<const Blob>(std::move(file).value().blob);
  if (blob->ContentHash() != hash)
    return Status(Code::kCorrupt, path.string() + ": its content is another than its name says");
  return BlobPtr(std::move(blob));
}

Result<std::vector<wire::NamedBlob>> ReadPack(const fs::path& path) {
  Result<BlobFile> file = ReadStoredFile(path, kSmallStoredBytes);
  if (!file.ok()) return file.status();
  Result<std::vector<wire::NamedBlob>> blobs = UnpackBlobs(file.value().blob);
  if (!blobs.ok()) return Status(blobs.status().code(), path.string() + ": " + blobs.status().message());
  return blobs;
}

// Of what cannot be looked at now (a right is missing, the disk fails) nobody knows that.
bool IsGone(const fs::path& path) {
  std::error_code unknown;
  return fs::status(path, unknown).type() == fs::file_type::not_found;
}

}  // namespace

Status CheckBlobAlone(const StoreFolder& folder, const Hash& hash) {
  std::error_code unknown;
  if (fs::exists(folder.FlatFile(hash), unknown)) return CheckFlatFile(folder.FlatFile(hash), hash);
  return ReadAlone(folder.BlobFile(hash), hash).status();
}

BlobFiles::BlobFiles(const StoreFolder& folder) : folder_(folder) {
  for (const fs::path& pack : folder.PackFiles()) {
    const Result<std::vector<wire::NamedBlob>> blobs = ReadPack(pack);
    if (blobs.ok())
      Index(pack, blobs.value());
    else if (SaysNothing(blobs.status()))
      throw UnreadableStore(blobs.status());
    else if (blobs.status().code() == Code::kCorrupt)
      cairn::coordinator::Quarantine(pack);
  }
}

void BlobFiles::Index(const fs::path& pack, const std::vector<wire::NamedBlob>& blobs) {
  const std::lock_guard lock(mutex_);
  for (const wire::NamedBlob& named : blobs)
    if (pack_of_.emplace(named.hash, pack).second) packs_[pack].insert(named.hash);
}

fs::path BlobFiles::FileOf(const Hash& hash) const {
  const std::lock_guard lock(mutex_);
  const auto packed = pack_of_.find(hash);
  if (packed != pack_of_.end()) return packed->second;
  std::error_code unknown;
  const bool flat = fs::exists(folder_.FlatFile(hash), unknown);
  return flat ? folder_.FlatFile(hash) : folder_.BlobFile(hash);
}

bool BlobFiles::Has(const Hash& hash) const { return !IsGone(FileOf(hash)); }

Result<BlobPtr> BlobFiles::Read(const Hash& hash) {
  return IsPacked(hash) ? ReadPacked(FileOf(hash), hash) : ReadOwnFile(hash);
}

Result<BlobPtr> BlobFiles::ReadOwnFile(const Hash& hash) const {
  return IsFlat(hash) ? ReadFlatFile(folder_.FlatFile(hash), hash) : ReadAlone(folder_.BlobFile(hash), hash);
}

bool BlobFiles::IsPacked(const Hash& hash) const {
  const std::lock_guard lock(mutex_);
  return pack_of_.contains(hash);
}

Result<BlobPtr> BlobFiles::ReadPart(const Hash& hash, const proto::BlobPart& part) {
  const fs::path path = FileOf(hash);
  if (path != folder_.FlatFile(hash)) return Status(Code::kNotFound, "no flat blob");
  std::vector<std::pair<Hash, FlatParts>> uploaded;
  {
    const std::lock_guard lock(mutex_);
    uploaded.swap(uploaded_);
  }
  for (auto& [blob, parts] : uploaded) parts_.Put(blob, std::move(parts));
  return parts_.Read(path, hash, part);
}

void BlobFiles::ForgetParts(const Hash& hash) {
  parts_.Forget(hash);
  const std::lock_guard lock(mutex_);
  std::erase_if(uploaded_, [&hash](const auto& of) { return of.first == hash; });
}

void BlobFiles::KnowParts(const Hash& hash, FlatParts parts) {
  const std::lock_guard lock(mutex_);
  uploaded_.emplace_back(hash, std::move(parts));
}

Status BlobFiles::Check(const Hash& hash) const {
  const fs::path path = FileOf(hash);
  const bool alone = path == folder_.FlatFile(hash) || path == folder_.BlobFile(hash);
  return alone ? CheckBlobAlone(folder_, hash) : Status::Ok();
}

// Blobs of a pack are asked for one after the other.
Result<BlobPtr> BlobFiles::ReadPacked(const fs::path& path, const Hash& hash) {
  const auto is_open = [&](const OpenPack& pack) { return pack.path == path; };
  auto open = std::find_if(open_packs_.begin(), open_packs_.end(), is_open);
  if (open == open_packs_.end()) {
    Result<std::vector<wire::NamedBlob>> blobs = ReadPack(path);
    if (!blobs.ok()) return blobs.status();
    if (open_packs_.size() == kOpenPacks) open_packs_.pop_back();
    open = open_packs_.insert(open_packs_.begin(), OpenPack{path, {}});
    for (wire::NamedBlob& named : blobs.value()) open->blobs.emplace(named.hash, std::move(named.blob));
  }
  const auto blob = open->blobs.find(hash);
  if (blob != open->blobs.end()) return blob->second;
  return Status(Code::kCorrupt, path.string() + ": its content is another than when it was written");
}

Status BlobFiles::Write(const std::vector<wire::NamedBlob>& blobs, std::vector<Hash>& written) {
  const auto is_large = [](const wire::NamedBlob& named) { return named.blob->ByteCount() > kSmallBytes; };
  std::vector<wire::NamedBlob> ordered;
  std::ranges::copy_if(blobs, std::back_inserter(ordered), is_large);
  const auto large = static_cast<std::ptrdiff_t>(ordered.size());
  std::ranges::copy_if(blobs, std::back_inserter(ordered), std::not_fn(is_large));
  const auto small = ordered.begin() + large;
  const bool pack = static_cast<std::size_t>(ordered.end() - small) >= kFewest;
  for (auto it = ordered.begin(); it != (pack ? small : ordered.end()); ++it) {
    if (Status status = WriteBlobFile(folder_.BlobFile(it->hash), "blob", *it->blob); !status.ok())
      return status;
    written.push_back(it->hash);
  }
  for (auto it = small; pack && it != ordered.end();) {
    std::vector<wire::NamedBlob> some;
    for (std::size_t bytes = 0; it != ordered.end() && some.size() < kMost && bytes < kPackBytes; ++it) {
      bytes += it->blob->ByteCount();
      some.push_back(*it);
    }
    if (Status status = WritePack(some, written); !status.ok()) return status;
  }
  return Status::Ok();
}

Status BlobFiles::WritePack(const std::vector<wire::NamedBlob>& blobs, std::vector<Hash>& written) {
  const Blob pack = PackBlobs(blobs);
  const fs::path path = folder_.PackFile(pack.ContentHash());
  if (Status status = WriteBlobFile(path, "pack", pack); !status.ok()) return status;
  Index(path, blobs);
  for (const wire::NamedBlob& named : blobs) written.push_back(named.hash);
  return Status::Ok();
}

void BlobFiles::Remove(const std::vector<Hash>& hashes) {
  std::vector<fs::path> garbage;
  {
    const std::lock_guard lock(mutex_);
    for (const Hash& hash : hashes) {
      garbage.push_back(folder_.BlobFile(hash));  // a blob may lie there as well as in a pack
      garbage.push_back(folder_.FlatFile(hash));
      const auto packed = pack_of_.find(hash);
      if (packed == pack_of_.end()) continue;
      const auto pack = packs_.find(packed->second);
      pack->second.erase(hash);
      if (pack->second.empty()) {
        garbage.push_back(pack->first);
        packs_.erase(pack);
      }
      pack_of_.erase(packed);
    }
  }
  std::error_code ignored;
  for (const fs::path& path : garbage) {
    if (!folder_.IsStillThere().ok()) return;  // another machine's, by now, which may need them
    fs::remove(path, ignored);
  }
}

void BlobFiles::Quarantine(const Hash& hash) {
  const fs::path path = FileOf(hash);
  cairn::coordinator::Quarantine(path);
  const std::lock_guard lock(mutex_);
  const auto pack = packs_.find(path);
  if (pack == packs_.end()) return;
  for (const Hash& lost : pack->second) pack_of_.erase(lost);
  packs_.erase(pack);
}

void BlobFiles::RemoveAllBut(const std::set<Hash>& named) {
  std::vector<Hash> unnamed;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [hash, pack] : pack_of_)
      if (!named.contains(hash)) unnamed.push_back(hash);
  }
  for (const Hash& hash : folder_.BlobsAlone())
    if (!named.contains(hash)) unnamed.push_back(hash);
  Remove(unnamed);
}

std::optional<std::vector<Hash>> BlobFiles::InPack(const fs::path& pack) const {
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = packs_.find(pack); known != packs_.end())
      return std::vector<Hash>(known->second.begin(), known->second.end());
  }
  return HashesInPack(pack);
}

void BlobFiles::ForgetGonePacks() {
  const std::lock_guard lock(mutex_);
  std::erase_if(pack_of_, [](const auto& packed) { return IsGone(packed.second); });
  std::erase_if(packs_, [](const auto& pack) { return IsGone(pack.first); });
}

Status UploadFiles::Do(const OpenUpload& open) {
  File& file = files_[open.id];
  file.status = folder_.IsStillThere();
  if (file.status.ok()) file.status = use_.Reserve(open.bytes);
  if (!file.status.ok()) return file.status;
  Result<FlatFileWriter> writer =
      FlatFileWriter::Create(folder_.Uploads() / (std::to_string(open.id) + ".part"), open.hash);
  if (writer.ok())
    file.writer.emplace(std::move(writer).value());
  else
    file.status = writer.status();
  return file.status;
}

Status UploadFiles::Do(const WritePiece& piece) {
  File& file = files_.at(piece.id);
  if (!file.writer) return file.status;
  file.status = file.writer->Write(std::as_bytes(std::span(piece.data)));
  if (!file.status.ok()) file.writer.reset();
  return file.status;
}

Status UploadFiles::Do(const CloseUpload& close) {
  File file = std::move(files_.extract(close.id).mapped());
  if (!close.whole || !file.writer) return file.status;
  if (const Status there = folder_.IsStillThere(); !there.ok()) return there;
  const fs::path path = folder_.FlatFile(close.hash);
  if (Status published = file.writer->Publish(path); !published.ok()) return published;
  blobs_.KnowParts(close.hash, file.writer->TakeParts(path));
  return Status::Ok();
}

}  // namespace cairn::coordinator
