// What is published of a stage: its result, with a group `provenance/` that says how it came to be.
#pragma once

#include <cstdint>
#include <string>

#include "schema/blob.h"
#include "schema/checkpoint.pb.h"

namespace cairn::coordinator {

// Its entries are those of schema/FORMAT.md.
Blob WithProvenance(const Blob& result, const proto::Checkpoint& checkpoint, std::uint32_t stage,
                    const std::string& finished_utc);

// Now, as above.
std::string UtcNow();

}  // namespace cairn::coordinator
