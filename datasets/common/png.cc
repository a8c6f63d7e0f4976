#include "datasets/common/png.h"

#include <zlib.h>

#include <vector>

#include "schema/error.h"

namespace cairn::datasets {
namespace {

std::string BigEndian(std::uint32_t value) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 0xFF);
  return text;
}

const Bytef* Pointer(const std::string& text) { return reinterpret_cast<const Bytef*>(text.data()); }

// Length, type, data, CRC-32 of type and data: ISO/IEC 15948, 5.3.
std::string Chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const uLong crc = crc32(0, Pointer(body), static_cast<uInt>(body.size()));
  return BigEndian(static_cast<std::uint32_t>(data.size())) + body +
         BigEndian(static_cast<std::uint32_t>(crc));
}

std::string Deflated(const std::string& data) {
  std::vector<Bytef> out(compressBound(data.size()));
  uLongf size = out.size();
  CAIRN_DEMAND(compress2(out.data(), &size, Pointer(data), data.size(), 6) == Z_OK,
               "zlib cannot deflate in memory");
  return {reinterpret_cast<const char*>(out.data()), size};
}

}  // namespace

std::string EncodePng(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> pixels,
                      PngColour colour) {
  const std::size_t row = static_cast<std::size_t>(colour) * width;
  CAIRN_DEMAND(width > 0 && height > 0 && pixels.size() == row * height, "pixels do not fill the picture");
  std::string lines;
  lines.reserve((row + 1) * height);
  for (std::size_t y = 0; y < height; ++y) {
    lines += '\0';  // filter type: none
    lines.append(reinterpret_cast<const char*>(pixels.data()) + y * row, row);
  }
  // 8 bits, RGB or RGBA, the only compression and filter methods, not interlaced.
  const char type = colour == PngColour::kRgb ? '\x02' : '\x06';
  const std::string header = BigEndian(width) + BigEndian(height) + '\x08' + type + std::string(3, '\0');
  return "\x89PNG\r\n\x1a\n" + Chunk("IHDR", header) + Chunk("IDAT", Deflated(lines)) + Chunk("IEND", "");
}

}  // namespace cairn::datasets
