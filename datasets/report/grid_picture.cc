#include "datasets/report/grid_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "datasets/common/png.h"

namespace cairn::datasets::report {
namespace {

constexpr std::int64_t kMaxPixels = 1500;
constexpr std::array<double, 3> kWeak = {0x6a, 0xa8, 0xe8};    // light blue
constexpr std::array<double, 3> kStrong = {0xc2, 0x26, 0x5c};  // crimson

// Colour and opacity of a share in [0, 1].
void AppendPixel(double share, std::vector<std::uint8_t>& pixels) {
  for (std::size_t c = 0; c < 3; ++c) {
    pixels.push_back(static_cast<std::uint8_t>(std::lround(kWeak[c] + share * (kStrong[c] - kWeak[c]))));
  }
  pixels.push_back(static_cast<std::uint8_t>(std::lround(255 * std::min(1.0, 1.15 * share))));
}

double LargestIn(const Grid& grid, std::int64_t first_row, std::int64_t first_column, std::int64_t block) {
  double largest = 0;
  for (std::int64_t y = first_row; y < std::min(grid.rows, first_row + block); ++y) {
    for (std::int64_t x = first_column; x < std::min(grid.columns, first_column + block); ++x) {
      largest = std::max(largest, grid.probability[static_cast<std::size_t>(y * grid.columns + x)]);
    }
  }
  return largest;
}

}  // namespace

double HighestProbability(const Grid& grid) {
  double highest = 0;
  for (const double p : grid.probability) highest = std::max(highest, p);
  return highest;
}

std::string GridPng(const Grid& grid, double highest) {
  const std::int64_t block = (std::max(grid.columns, grid.rows) + kMaxPixels - 1) / kMaxPixels;
  const std::int64_t width = (grid.columns + block - 1) / block, height = (grid.rows + block - 1) / block;
  std::vector<std::uint8_t> pixels;
  for (std::int64_t row = height - 1; row >= 0; --row) {
    for (std::int64_t column = 0; column < width; ++column) {
      const double largest = LargestIn(grid, row * block, column * block, block);
      AppendPixel(highest > 0 ? std::sqrt(largest / highest) : 0, pixels);
    }
  }
  return EncodePng(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), pixels,
                   PngColour::kRgba);
}

std::string KeyPng(int height) {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < height; ++y) AppendPixel(1 - (y + 0.5) / height, pixels);
  return EncodePng(1, static_cast<std::uint32_t>(height), pixels, PngColour::kRgba);
}

}  // namespace cairn::datasets::report
