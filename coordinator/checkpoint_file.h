// A checkpoint as a Cairn file of kind `checkpoint`: the message as bytes, and the job as YAML for people.
#pragma once

#include <filesystem>

#include "schema/checkpoint.pb.h"
#include "schema/error.h"

namespace cairn::coordinator {

// Whole or not at all; see WriteBlobFile.
Status WriteCheckpoint(const std::filesystem::path& path, const proto::Checkpoint& checkpoint);
// kCorrupt names the file: a wrong checksum, or bytes that are no checkpoint, or one whose parts do not fit
// together.
Result<proto::Checkpoint> ReadCheckpoint(const std::filesystem::path& path);

}  // namespace cairn::coordinator
