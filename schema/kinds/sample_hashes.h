// Samples by what was sensed and where, whatever run and file they are in: by these a copy of what networks
// were trained on is known.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "schema/kinds/learning.h"

namespace cairn {

// [K]: of each sample of the run, x_m, y_m and its inputs, of which there are so many.
std::vector<std::int64_t> SampleHashes(const kinds::Samples::Run& run, std::size_t inputs);

// Of samples, how many differ from one another and are among `known`, beside how many differ from one
// another.
struct SamplesInCommon {
  std::size_t known = 0, all = 0;
  bool AreACopy() const { return 2 * known > all; }
};
SamplesInCommon InCommon(std::span<const std::int64_t> samples, const std::set<std::int64_t>& known);

// Those that networks, or any that they went on from, were trained on; in older files they are not named.
std::set<std::int64_t> SamplesKnownTo(const kinds::Networks& networks);

}  // namespace cairn
