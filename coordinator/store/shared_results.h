// Published results on their way to those who asked for them: however many those are, a file is in memory
// once, for as long as one of them is being sent it, and is read once for all of them, by the thread that
// writes.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>

#include "schema/wire/codec.h"

namespace cairn::coordinator {

// What was read of a file, and what it is without its provenance, which jobs know.
struct SharedResult {
  wire::NamedBlob named;
  Hash result;
};

class SharedResults {
  // Device, inode, size and the times of its last changes: another file, or content, has another.
  using Version = std::array<std::int64_t, 7>;

 public:
  // A file, read, or why it could not be, as ReadStoredFile says.
  struct Loaded {
    std::filesystem::path path;
    Version version{};
    Status status;
    BlobPtr blob;
    Hash hash, result;
  };
  // Takes as long as the disk does, and hashing. On any thread.
  static Loaded Load(const std::filesystem::path& path);

  // For as long as the blob, or one of its arrays, lives; a failure until ForgetFailures.
  void Keep(const Loaded& loaded);
  void ForgetFailures();
  // Reads nothing. kNotFound: nothing is there; kBusy: it is to be loaded first; else as it was loaded.
  Result<SharedResult> Get(const std::filesystem::path& path) const;
  // Whether Get has an answer.
  bool IsAtHand(const std::filesystem::path& path) const;
  // As far as is known: in memory, or, of a file that was never read as it is now, on disk. 0: there is none.
  std::uint64_t Bytes(const std::filesystem::path& path) const;

 private:
  struct Entry {
    Version version{};
    Status status;
    std::weak_ptr<const Blob> blob;
    Hash hash, result;
    std::uint64_t bytes = 0;
  };
  static Version VersionOf(const std::filesystem::path& path);  // zeros: nothing is there

  std::map<std::filesystem::path, Entry> entries_;
};

}  // namespace cairn::coordinator
