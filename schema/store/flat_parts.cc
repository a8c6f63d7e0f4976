#include "schema/store/flat_parts.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "schema/array_form.h"
#include "schema/flat_blob.h"
#include "schema/store/atomic_file.h"

namespace cairn {
namespace {

constexpr std::uint64_t kChunkBytes = 1 << 16;
constexpr std::size_t kMostKnown = 256;

Hash HashOfChunk(std::span<const std::byte> bytes) {
  Hasher hasher;
  hasher.Add(bytes);
  return hasher.Finish();
}

Status About(const std::filesystem::path& path, const Status& status) {
  return status.ok() ? status : Status(status.code(), path.string() + ": " + status.message());
}

}  // namespace

void ChunkHashes::Add(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    if (!hasher_) hasher_ = std::make_unique<Hasher>(), left_ = kChunkBytes;
    const auto some = bytes.first(std::min<std::uint64_t>(left_, bytes.size()));
    hasher_->Add(some);
    bytes = bytes.subspan(some.size());
    left_ -= some.size();
    if (left_ > 0) continue;
    hashes_.push_back(hasher_->Finish());
    hasher_.reset();
  }
}

std::vector<Hash> ChunkHashes::Finish() && {
  if (hasher_) hashes_.push_back(hasher_->Finish());
  return std::move(hashes_);
}

FlatParts::FlatParts(std::filesystem::path path, const FlatCheck& check, std::uint64_t size,
                     ChunkHashes chunks)
    : path_(std::move(path)), size_(size), meta_(*check.meta()), chunks_(std::move(chunks).Finish()) {
  std::uint64_t at = check.head_bytes();
  for (const wire::ArrayMeta& array : meta_.arrays()) {
    begins_.push_back(at);
    at += BytesOfArray(static_cast<DType>(array.type()), array.item_bytes(),
                       Shape(array.shape().begin(), array.shape().end()))
              .value();
  }
}

Result<FlatParts> FlatParts::Open(const std::filesystem::path& path, const Hash& hash) {
  Result<RegularFile> file = RegularFile::Open(path);
  if (!file.ok()) return file.status();
  const std::uint64_t size = file.value().size();
  FlatCheck check(hash);
  ChunkHashes chunks;
  std::vector<std::byte> chunk(kChunkBytes);
  for (std::uint64_t at = 0; at < size; at += kChunkBytes) {
    const auto bytes = std::span(chunk).first(std::min(kChunkBytes, size - at));
    if (const int error = file.value().ReadAt(bytes, at)) return SystemFailure(path, "cannot read", error);
    if (Status good = check.Add(bytes); !good.ok()) return About(path, good);
    chunks.Add(bytes);
  }
  if (Status good = check.Finish(); !good.ok()) return About(path, good);
  return FlatParts(path, check, size, std::move(chunks));
}

Status FlatParts::Damaged() const {
  return {Code::kCorrupt, path_.string() + ": it is damaged, and was whole before"};
}

// The chunks that it lies in, each held against its hash.
Result<Array> FlatParts::ReadArray(const RegularFile& file, const wire::ArrayMeta& array,
                                   const CutArray& cut) const {
  const auto type = static_cast<DType>(array.type());
  if (cut.form_alone) return Array::FormAlone(type, array.item_bytes(), cut.shape);
  const std::uint64_t from = begins_[static_cast<std::size_t>(cut.index)] + cut.from, end = from + cut.bytes;
  const std::shared_ptr<std::byte> bytes = AlignedBytes(cut.bytes);
  std::vector<std::byte> chunk(kChunkBytes);
  for (std::uint64_t k = from / kChunkBytes; k * kChunkBytes < end; ++k) {
    const std::uint64_t at = k * kChunkBytes;
    const auto whole = std::span(chunk).first(std::min(kChunkBytes, size_ - at));
    if (const int error = file.ReadAt(whole, at)) return SystemFailure(path_, "cannot read", error);
    if (HashOfChunk(whole) != chunks_[k]) return Damaged();
    const std::uint64_t first = std::max(from, at), last = std::min(end, at + whole.size());
    std::ranges::copy(whole.subspan(first - at, last - first), bytes.get() + (first - from));
  }
  return Array::Over(type, array.item_bytes(), cut.shape, {bytes.get(), cut.bytes}, bytes);
}

Result<BlobPtr> FlatParts::Read(const proto::BlobPart& part) const {
  const Result<std::vector<CutArray>> cuts = CutsOf(meta_, part);
  if (!cuts.ok()) return cuts.status();
  const Result<RegularFile> file = RegularFile::Open(path_);
  if (!file.ok()) return file.status();
  if (file.value().size() != size_) return Damaged();
  Blob::Fields fields;
  for (const CutArray& cut : cuts.value()) {
    const wire::ArrayMeta& array = meta_.arrays(cut.index);
    Result<Array> read = ReadArray(file.value(), array, cut);
    if (!read.ok()) return read.status();
    fields.emplace(array.name(), std::move(read).value());
  }
  return std::make_shared<const Blob>(std::move(fields));
}

Result<BlobPtr> FlatPartsCache::Read(const std::filesystem::path& path, const Hash& hash,
                                     const proto::BlobPart& part) {
  const auto known = std::ranges::find(known_, hash, [](const auto& of) { return of.first; });
  if (known != known_.end()) {
    known_.splice(known_.end(), known_, known);
  } else {
    Result<FlatParts> parts = FlatParts::Open(path, hash);
    if (!parts.ok()) return parts.status();
    Put(hash, std::move(parts).value());
  }
  return known_.back().second.Read(part);
}

void FlatPartsCache::Put(const Hash& hash, FlatParts parts) {
  Forget(hash);
  if (known_.size() == kMostKnown) known_.pop_front();
  known_.emplace_back(hash, std::move(parts));
}

void FlatPartsCache::Forget(const Hash& hash) {
  std::erase_if(known_, [&hash](const auto& of) { return of.first == hash; });
}

}  // namespace cairn
