// Packed chunks of bags.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/bag/bytes.h"

namespace cairn::datasets::bag {

inline bool IsPlain(std::string_view how) { return how.empty() || how == "none"; }

class Unpacker {
 public:
  // `how`: "" or "none", "lz4" (frames), "zstd", "bz2"; valid until the next call. Memory grows with what
  // comes out, not with what is promised. Throws Damage: another `how`, damaged bytes, other than `size`
  // bytes in them, more than kMostRecordBytes (window_file.h).
  ByteSpan Unpack(const std::string& how, ByteSpan packed, std::uint64_t size);
  // The same of a stream of zstd that does not say how long it is.
  ByteSpan UnpackZstd(ByteSpan packed);

 private:
  std::vector<std::byte> buffer_;
};

}  // namespace cairn::datasets::bag
