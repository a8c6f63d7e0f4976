// PNG files by zlib alone: OpenCV's imgcodecs would add 140 libraries and 50 ms to every start of `cairn`.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace cairn::datasets {

enum class PngColour : std::uint8_t { kRgb = 3, kRgba = 4 };  // channels of a pixel

// The bytes of a PNG file of 8-bit pixels, row-major from the top, channels together. pixels: channels *
// width * height. `width` and `height` are at least 1.
std::string EncodePng(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> pixels,
                      PngColour colour = PngColour::kRgb);

}  // namespace cairn::datasets
