// MCAP (mcap.dev/spec): what its reader (bag/mcap.cc) and its writer (export/mcap_file.cc) have in common.
#pragma once

#include <cstdint>
#include <string_view>

namespace cairn::datasets {

inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};

// Each record is an opcode, the length of its contents in eight bytes, and those.
enum McapOp : std::uint8_t {
  kMcapHeader = 1,
  kMcapFooter = 2,
  kMcapSchema = 3,
  kMcapChannel = 4,
  kMcapMessage = 5,
  kMcapChunk = 6,
  kMcapMessageIndex = 7,
  kMcapChunkIndex = 8,
  kMcapStatistics = 11,
  kMcapMetadata = 12,
  kMcapMetadataIndex = 13,
  kMcapDataEnd = 15,
};

}  // namespace cairn::datasets
