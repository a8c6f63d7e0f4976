// A pipeline for tests that uses everything a pipeline may: rows of a shared blob, partials of the same round
// as inputs (a combine tree), state scalars and blobs, several rounds, a reduction that depends on order.
#pragma once

#include <cstdint>
#include <memory>

#include "pipelines/pipeline.h"
#include "pipelines/registry.h"

namespace cairn::testing {

// "toy": reads robot/0/odometry/forward_m of the input `log`; options rounds and slices.
PipelineInfo ToyInfo();
// Throws InputError for another pipeline's name or a bad option.
std::unique_ptr<const Pipeline> MakeToy(const proto::Stage& stage, std::uint64_t seed);

// A log whose odometry has `controls` rows, and a truth that nobody may read.
Blob ToyLog(int controls);

}  // namespace cairn::testing
