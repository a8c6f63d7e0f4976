// Parts of a flat blob in a file (schema/flat_blob.h), each at the cost of what it has and no more. The file
// was read whole once, and is held against what it was then: nothing that was damaged later is ever given.
#pragma once

#include <cstdint>
#include <filesystem>
#include <list>
#include <utility>
#include <vector>

#include "schema/blob_part.h"
#include "schema/store/regular_file.h"

namespace cairn {

class FlatParts {
 public:
  // Reads and checks all of it, keeping none. As ReadFlatFile says.
  static Result<FlatParts> Open(const std::filesystem::path& path, const Hash& hash);
  FlatParts(FlatParts&&) = default;

  // kRefused: there is no such part of it. kNotFound: nor is the file. kCorrupt: it is not what it was. kIo.
  Result<BlobPtr> Read(const proto::BlobPart& part) const;

 private:
  FlatParts(std::filesystem::path path, std::uint64_t size) : path_(std::move(path)), size_(size) {}
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
  void Forget(const Hash& hash);

 private:
  std::list<std::pair<Hash, FlatParts>> known_;  // most lately read last
};

}  // namespace cairn
