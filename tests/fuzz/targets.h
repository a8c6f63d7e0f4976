// What is fuzzed: bytes go in, and whatever they are, nothing may crash, leak, hang or contradict itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace cairn::fuzz {

enum class Outcome { kRefused, kAccepted };

// The first byte chooses which file of an import (odometry, observations, three of truth) the others are, and
// whether bad lines are skipped; the other files are good ones. An accepted log has columns of equal length,
// finite numbers and times in order. Aborts where it has not.
Outcome FuzzCsv(std::span<const std::uint8_t> bytes);

// The bytes of a Cairn file. An accepted blob is written again and read again, and must be the same. Aborts
// where it is not.
Outcome FuzzBlobFile(std::span<const std::uint8_t> bytes);

// A message as it comes from a socket: frames, each after its length in two bytes, little-endian. An accepted
// one is encoded and decoded again, and must be the same. Aborts where it is not.
Outcome FuzzMessage(std::span<const std::uint8_t> bytes);

}  // namespace cairn::fuzz
