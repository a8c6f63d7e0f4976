// Files of strangers, read in a child process. HDF5 1.10's parser crashes on some damaged files and comes to
// no end on others; then the child dies, and the caller gets a Status.
#pragma once

#include <filesystem>
#include <functional>

#include "schema/store/blob_file.h"

namespace cairn::store {

// What a file holds: all of it, or, of an array that was not asked for, what it is.
struct FileContents {
  std::string kind;
  std::int64_t format = 0;
  std::vector<DatasetInfo> datasets;
  Blob blob;
  bool changed = false;  // BlobFile's
};

// Runs `read` in a child, and brings back what it gives. kCorrupt names the file where HDF5 crashes, or
// computes for longer than a file of this size can need; kIo where somebody ends it, as the system does for
// want of memory.
Result<FileContents> InChild(const std::filesystem::path& path,
                             const std::function<Result<FileContents>()>& read);

}  // namespace cairn::store
