// A checkpoint as a Cairn file of kind `checkpoint`: the message as bytes, and the job as YAML for people.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "schema/checkpoint.pb.h"
#include "schema/error.h"

namespace cairn::coordinator {

// Whole or not at all; see WriteBlobFile.
Status WriteCheckpoint(const std::filesystem::path& path, const proto::Checkpoint& checkpoint);
// kCorrupt, with the file's name: a wrong checksum, bytes that are no checkpoint, or a checkpoint whose parts
// do not fit together.
Result<proto::Checkpoint> ReadCheckpoint(const std::filesystem::path& path);
// What such a file holds; kCorrupt says what is wrong with it, not where.
Result<proto::Checkpoint> ParseCheckpoint(std::span<const std::uint8_t> bytes);

}  // namespace cairn::coordinator
