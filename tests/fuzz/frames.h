// A message's frames as one run of bytes: each after its length in two bytes, little-endian.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "schema/wire/codec.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {

inline std::vector<std::span<const std::byte>> CutIntoFrames(std::span<const std::byte> bytes) {
  std::vector<std::span<const std::byte>> frames;
  while (bytes.size() >= 2) {
    const std::size_t stated =
        std::to_integer<std::size_t>(bytes[0]) + 256 * std::to_integer<std::size_t>(bytes[1]);
    bytes = bytes.subspan(2);
    const std::size_t length = std::min(stated, bytes.size());
    frames.push_back(bytes.first(length));
    bytes = bytes.subspan(length);
  }
  return frames;
}

inline Bytes JoinFrames(const wire::Message& message) {
  Bytes bytes;
  const auto add = [&bytes](std::span<const std::byte> frame) {
    bytes.push_back(static_cast<std::uint8_t>(frame.size()));
    bytes.push_back(static_cast<std::uint8_t>(frame.size() >> 8));
    for (const std::byte b : frame) bytes.push_back(std::to_integer<std::uint8_t>(b));
  };
  const wire::Frames frames = wire::Encode(message);
  add(std::as_bytes(std::span(frames.envelope)));
  for (const Array& array : frames.arrays) add(array.bytes());
  return bytes;
}

}  // namespace cairn::fuzz
