// Flat blobs (schema/flat_blob.h) in files of a store: written while they come, never read before they are
// whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <utility>

#include "schema/flat_blob.h"
#include "schema/store/flat_parts.h"

namespace cairn {

// One that is being written, under a temporary name. What comes is hashed as it is written. Destroyed before
// Publish has succeeded, it leaves nothing behind.
class FlatFileWriter {
 public:
  // kNoSpace, kRefused, kIo. Nothing may lie at `temporary`.
  static Result<FlatFileWriter> Create(const std::filesystem::path& temporary, const Hash& hash);
  FlatFileWriter(FlatFileWriter&& other) noexcept;
  FlatFileWriter& operator=(FlatFileWriter&&) = delete;
  ~FlatFileWriter();

  // The next bytes. As FlatCheck::Add says; kNoSpace, kIo.
  Status Write(std::span<const std::byte> bytes);
  // All has come: checks the content, syncs, renames to `path` in a folder that is there, syncs that folder.
  // On failure there is nothing new at `path`. A whole blob that lies there already stays, and this one goes:
  // kCorrupt where they differ, for then somebody has made one of the same hash.
  Status Publish(const std::filesystem::path& path);
  // Once, after that: for whoever reads parts of it, and need not read it through before.
  FlatParts TakeParts(const std::filesystem::path& path);

 private:
  FlatFileWriter(std::filesystem::path temporary, int fd, const Hash& hash)
      : temporary_(std::move(temporary)), fd_(fd), check_(std::make_unique<FlatCheck>(hash)) {}
  std::filesystem::path temporary_;
  int fd_;
  std::unique_ptr<FlatCheck> check_;
  ChunkHashes chunks_;
  std::uint64_t written_ = 0, started_ = 0;  // bytes; of them, those that are on their way to the disk
};

// kNotFound; kCorrupt: not a whole flat blob of this hash; kVersion; kRefused; kIo.
Result<BlobPtr> ReadFlatFile(const std::filesystem::path& path, const Hash& hash);
// Whether ReadFlatFile would give it, at the cost of no memory.
Status CheckFlatFile(const std::filesystem::path& path, const Hash& hash);

}  // namespace cairn
