// A blob as the bytes of an HDF5 file, made in memory: a full disk then never meets HDF5's cache. Of a blob
// that is larger than the memory HDF5 writes the file, for which the disk has given the room before.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "schema/blob.h"

namespace cairn::store {

// Memory from malloc, as HDF5 resizes it.
struct FileImage {
  struct Free {
    void operator()(void* memory) const { std::free(memory); }
  };
  std::unique_ptr<std::byte, Free> data;
  std::size_t size = 0;
  std::span<const std::byte> bytes() const { return {data.get(), size}; }
};

// With its checksum trailer. The message of a failed Status names the dataset, not the file.
Result<FileImage> EncodeBlob(const std::string& kind, const Blob& blob);

// The same bytes into the file `temporary`, which is there and empty; of arrays over files a piece at a time
// is in memory. Fails also as SystemFailure (atomic_file.h) says; messages name `path`.
Status EncodeBlobInto(const std::filesystem::path& temporary, const std::filesystem::path& path,
                      const std::string& kind, const Blob& blob);

// The end of the file as its superblock states it, or 0 where that cannot be said from these bytes: fewer
// than kHeadBytes may be too few.
inline constexpr std::size_t kHeadBytes = 52;
std::uint64_t StatedEnd(std::span<const std::byte> head);
bool HasHdf5Signature(std::span<const std::byte> head);

}  // namespace cairn::store
