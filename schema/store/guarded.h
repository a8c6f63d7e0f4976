// Files of strangers, read in a child process. HDF5 1.10's parser crashes on some damaged files and comes to
// no end on others; then the child dies, and the caller gets a Status.
#pragma once

#include <sys/resource.h>
#include <sys/types.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "schema/store/blob_file.h"

namespace cairn::store {

// What a file holds: all of it, or, of an array that was not asked for, what it is.
struct FileContents {
  std::string kind;
  std::int64_t format = 0;
  std::vector<DatasetInfo> datasets;
  Blob blob;
  bool changed = false;  // BlobFile's
  // Of what only the child has seen (blob_stream.h).
  std::string hash = {};                  // binary; of the content
  std::vector<std::string> remarks = {};  // for people
};

// Who reads, for people, and how much there is to read: a second of the processor's time for each 4 MB.
struct ChildReader {
  std::string name = "HDF5";
  std::uint64_t bytes = 0;         // 0: the file's
  std::uint64_t memory_bytes = 0;  // that the child may take beside what its parent has; 0: no limit
  std::string more_memory = {};    // for people: how to give it more, as a sentence's end
};

// What this process may have while one lives, in a child: what it has and so many bytes more. Elsewhere, and
// with sanitizers, it limits nothing.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t more_bytes);
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;
  ~MemoryLimit() { Lift(); }
  // Ends it. Whether it was this that kept memory back: so much could have been had.
  bool Lift();

 private:
  std::uint64_t more_bytes_;
  rlim_t before_ = 0;
  bool is_set_ = false;
};

// Runs `read` in a child, and brings back what it gives. kCorrupt names the file where the reader crashes,
// kRefused where it computes for longer than a file of this size may take, or wants more memory; kIo where
// somebody ends it, as the system does for want of memory.
Result<FileContents> InChild(const std::filesystem::path& path,
                             const std::function<Result<FileContents>()>& read,
                             const ChildReader& reader = {});

// The same of bytes that a child writes while its parent takes them: neither holds more than a part of them.
class ChildStream {
 public:
  // `write` runs in the child; false: it could not write all.
  static Result<ChildStream> Start(const std::filesystem::path& path,
                                   const std::function<bool(FILE*)>& write);
  ChildStream(ChildStream&& other) noexcept;
  ChildStream& operator=(ChildStream&&) = delete;
  ~ChildStream();  // ends the child
  // Fills `bytes`. Fails as InChild does where the child broke off.
  Status Read(std::span<std::byte> bytes);

 private:
  ChildStream(std::filesystem::path path, FILE* in, pid_t child)
      : path_(std::move(path)), in_(in), child_(child) {}
  std::filesystem::path path_;
  FILE* in_;
  pid_t child_;
};

}  // namespace cairn::store
