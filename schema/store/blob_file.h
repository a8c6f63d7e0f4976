// Cairn's files: one HDF5 file that holds one blob (schema/FORMAT.md). Written whole or not at all; read with
// every checksum looked at. The messages of a failed Status name the file and, where there is one, the
// dataset.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn {

inline constexpr std::int64_t kFormatVersion = 1;  // of schema/FORMAT.md

struct BlobFile {
  std::string kind;  // log, landmark_map, checkpoint, …
  Blob blob;
  bool changed = false;  // another program has changed what Cairn wrote (ReadOptions::changed_too)
};

// Which datasets to read, by the beginnings of their names.
struct ReadOptions {
  std::vector<std::string> only;     // empty: all
  std::vector<std::string> without;  // takes away from `only`
  // Also a file that Cairn wrote and that another program has changed since, through HDF5: its checksum
  // trailer is gone.
  bool changed_too = false;
};

// Replaces `path` atomically; on any failure nothing is left behind. The same blob gives the same bytes in
// the file.
// kNotFound: the folder is not there.
// kNoSpace, kRefused: as WriteFileAtomically says.
// kIo, also for a name that HDF5 cannot hold, such as "a" beside "a/b".
Status WriteBlobFile(const std::filesystem::path& path, const std::string& kind, const Blob& blob);
// The same, but a file that is there already stays (WriteNewFileAtomically).
Status WriteNewBlobFile(const std::filesystem::path& path, const std::string& kind, const Blob& blob);

// A file of anybody: it is read in a child process, as HDF5 can crash on a damaged one. A file of another
// program has no checksum trailer and needs none.
// kNotFound.
// kCorrupt: not a Cairn file, truncated, a wrong checksum or checksum trailer, a checksum trailer that is
// gone, data that would come from another file. kVersion: of a newer format. kBusy: locked by a program that
// writes to it. kRefused: no regular file; arrays that take more than 2 GiB unpacked, and more than a hundred
// times the file. kIo, also where there is not the memory to read it.
Result<BlobFile> ReadBlobFile(const std::filesystem::path& path, const ReadOptions& options = {});

// Of a store's small files: checkpoints, packs.
inline constexpr std::uint64_t kSmallStoredBytes = std::uint64_t{64} << 20;
// Of any: all arrays of a message have no more (schema/wire/limits.h).
inline constexpr std::uint64_t kMostStoredBytes = std::uint64_t{4} << 30;

// A file of a store, which WriteBlobFile wrote: its checksum trailer is checked before HDF5 sees it, in this
// process. Fails as ReadBlobFile does; kCorrupt also where a single byte is another, and where its arrays
// take more unpacked than `usual_bytes`, and than a hundred times the file: the store's next owner must be
// able to begin without it.
Result<BlobFile> ReadStoredFile(const std::filesystem::path& path,
                                std::uint64_t usual_bytes = kMostStoredBytes);

// Without truth/ and provenance/: what a job may see.
Result<BlobFile> ReadBlobFileWithoutTruth(const std::filesystem::path& path, bool changed_too = false);

// What a file holds, without its data, of which no checksum is looked at.
struct DatasetInfo {
  std::string name;
  DType type = DType::kU8;
  std::size_t item_bytes = 1;
  Shape shape;
  std::string unit;
  std::uint64_t stored_bytes = 0;  // in the file, after deflate
};
struct BlobFileInfo {
  std::string kind;
  std::int64_t format = 0;
  std::vector<DatasetInfo> datasets;  // in the order of names
};
Result<BlobFileInfo> ListBlobFile(const std::filesystem::path& path);

// The same in memory and in this process: the bytes of a file. `name` stands for the file in messages.
Result<BlobFile> ReadBlobImage(std::span<const std::byte> image, const std::string& name);

}  // namespace cairn
