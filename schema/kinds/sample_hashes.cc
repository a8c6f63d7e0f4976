#include "schema/kinds/sample_hashes.h"

#include <algorithm>
#include <array>
#include <bit>

#include "schema/hash.h"

namespace cairn {

std::vector<std::int64_t> SampleHashes(const kinds::Samples::Run& run, std::size_t inputs) {
  std::vector<std::int64_t> hashes;
  for (std::size_t k = 0; k < run.x_m.size(); ++k) {
    Hasher hasher;
    hasher.Add(std::as_bytes(run.x_m.values().subspan(k, 1)));
    hasher.Add(std::as_bytes(run.y_m.values().subspan(k, 1)));
    hasher.Add(std::as_bytes(run.input.values().subspan(k * inputs, inputs)));
    std::array<std::uint8_t, 8> first{};
    std::ranges::copy_n(hasher.Finish().bytes.begin(), 8, first.begin());
    hashes.push_back(std::bit_cast<std::int64_t>(first));
  }
  return hashes;
}

SamplesInCommon InCommon(std::span<const std::int64_t> samples, const std::set<std::int64_t>& known) {
  const std::set<std::int64_t> different(samples.begin(), samples.end());
  const auto is_known = [&](std::int64_t hash) { return known.contains(hash); };
  return {static_cast<std::size_t>(std::ranges::count_if(different, is_known)), different.size()};
}

std::set<std::int64_t> SamplesKnownTo(const kinds::Networks& networks) {
  std::set<std::int64_t> known;
  for (const auto& hashes : {networks.map.sample_hash.OrNone(), networks.ancestry.sample_hash.OrNone()})
    known.insert(hashes.begin(), hashes.end());
  return known;
}

}  // namespace cairn
