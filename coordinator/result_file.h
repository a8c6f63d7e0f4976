// What is published of a stage: its result, with a group `provenance/` that says how it came to be.
#pragma once

#include <cstdint>
#include <string>

#include "schema/blob.h"
#include "schema/checkpoint.pb.h"

namespace cairn::coordinator {

// provenance/job            [] text  the resolved job as JSON
// provenance/kind           [] text  the pipeline, as in the file's cairn_kind
// provenance/version, compiler, flags, libc  [] text  of the workers' build
// provenance/hosts          [H] text where it was computed
// provenance/workers        [] i64   most that were connected when an answer came
// provenance/wall_s         [] f64   of the stage
// provenance/compute_s      [] f64   summed over the answers that counted
// provenance/round_s        [R] f64  of each round, START's first
// provenance/tasks, retries [] i64   answers that counted; attempts that failed
// provenance/finished_utc   [] text  YYYY-MM-DDThh:mm:ssZ
Blob WithProvenance(const Blob& result, const proto::Checkpoint& checkpoint, std::uint32_t stage,
                    const std::string& finished_utc);

// Now, as above.
std::string UtcNow();

}  // namespace cairn::coordinator
