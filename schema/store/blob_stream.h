// Files of anybody that need not fit into the memory of whoever hands them on: looked at in a child, which
// alone holds their arrays and ends, and then read in parts.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "schema/store/blob_file.h"
#include "schema/store/guarded.h"
#include "schema/wire.pb.h"

namespace cairn {

struct BlobFileFacts {
  std::string kind;
  bool changed = false;  // BlobFile's
  wire::BlobMeta meta;   // of its content, its hash too
  std::vector<std::string> remarks;
};

// What somebody has to say of a file who sees all of it. May throw InputError.
using Look = std::function<std::vector<std::string>(const std::string& kind, const Blob& blob)>;

// Fails as ReadBlobFile does; kRefused with what `look` throws.
Result<BlobFileFacts> LookAtBlobFile(const std::filesystem::path& path, const ReadOptions& options,
                                     const Look& look);
// What a job may see of it.
Result<BlobFileFacts> LookAtBlobFileWithoutTruth(const std::filesystem::path& path, const Look& look);

// The bytes of the arrays that `meta` names, in its order. Whether they are still what they were when it was
// looked at, a content hash tells.
Result<store::ChildStream> StreamArrays(const std::filesystem::path& path, const wire::BlobMeta& meta);

}  // namespace cairn
