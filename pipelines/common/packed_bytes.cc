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
  CAIRN_DEMAND(size > 0, "bytes that cannot be packed");
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

std::vector<std::uint8_t> PackNumbers(std::span<const std::int32_t> numbers) {
  std::vector<std::uint8_t> planes(numbers.size() * sizeof(std::int32_t));
  for (std::size_t byte = 0; byte < sizeof(std::int32_t); ++byte)
    for (std::size_t k = 0; k < numbers.size(); ++k)
      planes[byte * numbers.size() + k] =
          static_cast<std::uint8_t>(static_cast<std::uint32_t>(numbers[k]) >> 8 * byte);
  return PackBytes(planes);
}

std::vector<std::int32_t> UnpackNumbers(std::span<const std::uint8_t> packed, std::size_t size) {
  const std::vector<std::uint8_t> planes = UnpackBytes(packed, size * sizeof(std::int32_t));
  std::vector<std::int32_t> numbers(size);
  for (std::size_t k = 0; k < size; ++k) {
    std::uint32_t number = 0;
    for (std::size_t byte = 0; byte < sizeof number; ++byte)
      number |= std::uint32_t{planes[byte * size + k]} << 8 * byte;
    numbers[k] = static_cast<std::int32_t>(number);
  }
  return numbers;
}

}  // namespace cairn
