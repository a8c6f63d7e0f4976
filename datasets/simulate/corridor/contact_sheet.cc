#include "datasets/simulate/corridor/contact_sheet.h"

#include <algorithm>

#include "datasets/common/png.h"

namespace cairn::datasets::corridor {
namespace {

constexpr int kScale = 3, kGap = 6;  // pixels

}  // namespace

std::string ContactSheetPng(const std::vector<RgbImage>& images, int per_row) {
  const int columns = std::min(per_row, static_cast<int>(images.size()));
  const int rows = (static_cast<int>(images.size()) + per_row - 1) / per_row;
  const int cell_width = images.front().columns * kScale + kGap,
            cell_height = images.front().rows * kScale + kGap;
  const int width = columns * cell_width, height = rows * cell_height;
  std::vector<std::uint8_t> page(
      std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 255);
  for (std::size_t i = 0; i < images.size(); ++i) {
    const int left = static_cast<int>(i) % per_row * cell_width,
              top = static_cast<int>(i) / per_row * cell_height;
    for (int y = 0; y < images[i].rows * kScale; ++y) {
      for (int x = 0; x < images[i].columns * kScale; ++x) {
        const auto from = static_cast<std::size_t>(3 * (y / kScale * images[i].columns + x / kScale));
        const auto to = static_cast<std::size_t>(3 * ((top + y) * width + left + x));
        std::copy_n(images[i].rgb.begin() + static_cast<std::ptrdiff_t>(from), 3,
                    page.begin() + static_cast<std::ptrdiff_t>(to));
      }
    }
  }
  return EncodePng(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), page);
}

}  // namespace cairn::datasets::corridor
