// Bytes of a partial that lie in runs or repeat, made small for the wire.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace cairn {

std::vector<std::uint8_t> PackBytes(std::span<const std::uint8_t> bytes);

// As many as `size`, else it throws InputError: what is packed comes from another process.
std::vector<std::uint8_t> UnpackBytes(std::span<const std::uint8_t> packed, std::size_t size);

}  // namespace cairn
