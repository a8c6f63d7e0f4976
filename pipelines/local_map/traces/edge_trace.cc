#include "pipelines/local_map/traces/edge_trace.h"

#include <algorithm>
#include <utility>

namespace cairn::local_map {

EdgeTrace::EdgeTrace(double cell_m, int first_z, std::size_t capacity)
    : cell_m_(cell_m), first_z_(first_z), capacity_(capacity) {
  features_.reserve(capacity);
}

Feature* EdgeTrace::Touch(int z) {
  const int first = std::min(z, first_z_), end = std::max(z + 1, end_z());
  if (static_cast<std::size_t>(end - first) > capacity_) return nullptr;
  features_.insert(features_.begin(), static_cast<std::size_t>(first_z_ - first), Feature());
  first_z_ = first;
  features_.resize(static_cast<std::size_t>(end - first));
  return &features_[static_cast<std::size_t>(z - first_z_)];
}

void EdgeTrace::Restart(double cell_m, int first_z) {
  cell_m_ = cell_m;
  first_z_ = first_z;
  features_.clear();
}

EdgeTrace Reversed(const EdgeTrace& trace) {
  EdgeTrace back(trace.cell_m(), 1 - trace.end_z(), trace.features().size());
  for (int z = back.first_z(); z < 1 - trace.first_z(); ++z) {
    const Feature& seen = *trace.Find(-z);
    Feature& feature = *back.Touch(z);
    feature = {seen.right, seen.left};
    feature.left.cross_m = -feature.left.cross_m;
    feature.right.cross_m = -feature.right.cross_m;
  }
  return back;
}

EdgeTrace Part(const EdgeTrace& trace, int first_z, int end_z) {
  first_z = std::max(first_z, trace.first_z());
  end_z = std::max(first_z, std::min(end_z, trace.end_z()));
  EdgeTrace part(trace.cell_m(), first_z, static_cast<std::size_t>(end_z - first_z));
  for (int z = first_z; z < end_z; ++z) *part.Touch(z) = *trace.Find(z);
  return part;
}

}  // namespace cairn::local_map
