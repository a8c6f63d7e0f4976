// PNG files by zlib alone: OpenCV's imgcodecs would add 140 libraries and 50 ms to every start of `cairn`.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace cairn::datasets {

// The bytes of a PNG file of 8-bit RGB pixels, row-major from the top. pixels: 3 * width * height. `width`
// and `height` are at least 1.
std::string EncodePng(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> pixels);

}  // namespace cairn::datasets
