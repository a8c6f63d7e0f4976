// Traces as arrays, for tasks and results.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/local_map/traces/edge_trace.h"
#include "pipelines/local_map/traces/frame.h"
#include "schema/blob.h"

namespace cairn::local_map {

// A recorded trace: where, by the path of the task that recorded it, and over which of a robot's scans.
struct RecordedTrace {
  std::size_t robot = 0;
  std::size_t first = 0, end = 0;  // scans
  TraceFrame frame;
  EdgeTrace trace;
};

// Eight numbers a side, left before right.
inline constexpr std::size_t kSideNumbers = 8, kFeatureNumbers = 2 * kSideNumbers;
void AppendFeatures(const EdgeTrace& trace, std::vector<float>* numbers);
// Throws InputError where one is larger than a trace holds; NaN is none.
void RequireFeatures(std::span<const float> numbers);
// `numbers`: kFeatureNumbers a feature.
EdgeTrace TraceOf(double cell_m, int first_z, std::span<const float> numbers);

Blob TracesBlob(const std::vector<RecordedTrace>& traces);
// Throws InputError where these do not fit each other, or lie further away than a trace can.
std::vector<RecordedTrace> ReadTraces(const Blob& blob, double cell_m);

}  // namespace cairn::local_map
