// Parts of a flat blob in a file (schema/flat_blob.h), each at the cost of what it has and no more. The file
// was read whole once, and is held against what it was then: nothing that was damaged later is ever given.
#pragma once

#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "schema/blob_part.h"
#include "schema/flat_blob.h"
#include "schema/store/regular_file.h"

namespace cairn {

// By which what is read later is held against what was there first: a hash of each 64 KiB.
class ChunkHashes {
 public:
  void Add(std::span<const std::byte> bytes);  // the next, however many
  std::vector<Hash> Finish() &&;

 private:
  std::unique_ptr<Hasher> hasher_;  // of the chunk that is begun
  std::uint64_t left_ = 0;          // of it, bytes
  std::vector<Hash> hashes_;
};

class FlatParts {
 public:
  // Reads and checks all of it, keeping none. As ReadFlatFile says.
  static Result<FlatParts> Open(const std::filesystem::path& path, const Hash& hash);
  // Of one that was just written, whole and to the disk: `check` and `chunks` have seen all of it.
  FlatParts(std::filesystem::path path, const FlatCheck& check, std::uint64_t size, ChunkHashes chunks);
  FlatParts(FlatParts&&) = default;
  FlatParts& operator=(FlatParts&&) = default;

  // kRefused: there is no such part of it. kNotFound: nor is the file. kCorrupt: it is not what it was. kIo.
  Result<BlobPtr> Read(const proto::BlobPart& part) const;

 private:
  Result<Array> ReadArray(const RegularFile& file, const wire::ArrayMeta& array, const CutArray& cut) const;
  Status Damaged() const;

  std::filesystem::path path_;
  std::uint64_t size_;
  wire::BlobMeta meta_;
  std::vector<std::uint64_t> begins_;  // where the bytes of each array lie
  std::vector<Hash> chunks_;           // of each kChunkBytes of the file
};

// Files of which parts were read, the last few hundred of them: none is read through twice while parts of it
// are asked for. None is held open. For one thread.
class FlatPartsCache {
 public:
  // As FlatParts::Open and FlatParts::Read say.
  Result<BlobPtr> Read(const std::filesystem::path& path, const Hash& hash, const proto::BlobPart& part);
  void Put(const Hash& hash, FlatParts parts);  // that need not be read through
  void Forget(const Hash& hash);

 private:
  std::list<std::pair<Hash, FlatParts>> known_;  // most lately read last
};

}  // namespace cairn
