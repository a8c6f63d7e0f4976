// Many small blobs in one (schema/FORMAT.md, "pack"): their frames, as they would travel, one after the
// other.
#pragma once

#include <vector>

#include "schema/wire/codec.h"

namespace cairn::coordinator {

Blob PackBlobs(const std::vector<wire::NamedBlob>& blobs);

// In the order in which they were packed, each checked against its hash.
// kCorrupt: it is not a pack, or damaged.
Result<std::vector<wire::NamedBlob>> UnpackBlobs(const Blob& pack);

}  // namespace cairn::coordinator
