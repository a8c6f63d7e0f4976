// What is published of a stage: its result, with a group `provenance/` that says how it came to be.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "schema/blob.h"
#include "schema/checkpoint.pb.h"

namespace cairn::coordinator {

// Its entries are those of schema/FORMAT.md.
Blob WithProvenance(const Blob& result, const proto::Checkpoint& checkpoint, std::uint32_t stage,
                    const std::string& finished_utc);

// Now, as above.
std::string UtcNow();

// What a published result says of the job that it is of.
struct PublishedResult {
  proto::Job job;
  std::string stage;
  double seconds = 0;  // that the stage took
  Hash hash;           // of the result, without its provenance
};
// kCorrupt also where it says nothing of that, as results of versions before 0.2 do.
Result<PublishedResult> ReadPublished(const std::filesystem::path& path);

}  // namespace cairn::coordinator
