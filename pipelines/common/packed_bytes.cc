#include "pipelines/common/packed_bytes.h"

#include <lz4.h>

#include "schema/error.h"

namespace cairn {

std::vector<std::uint8_t> PackBytes(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return {};
  std::vector<std::uint8_t> packed(
      static_cast<std::size_t>(LZ4_compressBound(static_cast<int>(bytes.size()))));
  const int size = LZ4_compress_default(reinterpret_cast<const char*>(bytes.data()),
                                        reinterpret_cast<char*>(packed.data()),
                                        static_cast<int>(bytes.size()), static_cast<int>(packed.size()));
  packed.resize(static_cast<std::size_t>(size));
  return packed;
}

std::vector<std::uint8_t> UnpackBytes(std::span<const std::uint8_t> packed, std::size_t size) {
  std::vector<std::uint8_t> bytes(size);
  if (size == 0 && packed.empty()) return bytes;
  const int got =
      LZ4_decompress_safe(reinterpret_cast<const char*>(packed.data()), reinterpret_cast<char*>(bytes.data()),
                          static_cast<int>(packed.size()), static_cast<int>(size));
  if (got < 0 || static_cast<std::size_t>(got) != size)
    throw InputError("bytes are not packed as they should be");
  return bytes;
}

}  // namespace cairn
