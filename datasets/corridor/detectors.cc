#include "datasets/corridor/detectors.h"

#include <algorithm>
#include <vector>

namespace cairn::datasets::corridor {
namespace {

struct Pixel {
  double r, g, b;
  double light() const { return (r + g + b) / 3; }
};

Pixel At(const RgbImage& image, int row, int column) {
  const auto at = static_cast<std::size_t>(3 * (row * image.columns + column));
  return {static_cast<double>(image.rgb[at]), static_cast<double>(image.rgb[at + 1]),
          static_cast<double>(image.rgb[at + 2])};
}

double MedianLight(const RgbImage& image) {
  std::vector<double> light;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) light.push_back(At(image, row, column).light());
  }
  const auto middle = light.begin() + static_cast<std::ptrdiff_t>(light.size() / 2);
  std::ranges::nth_element(light, middle);
  return *middle;
}

// Doors are painted in a greyish blue, or of dark wood; colours as ratios, so that light does not matter.
bool LooksLikeADoor(const Pixel& p, double median_light) {
  const double g = p.g + 1, red = p.r / g, blue = p.b / g;
  const bool paint = red > 0.6 && red < 1.0 && blue > 1.1 && blue < 1.7;
  const bool wood = red > 1.3 && blue > 0.4 && blue < 0.8 && p.light() < 0.6 * median_light;
  return paint || wood;
}

// Doors are taller than what a camera sees: most of a column is of it.
bool IsDoorColumn(const RgbImage& image, int column, double median_light) {
  int alike = 0;
  for (int row = 0; row < image.rows; ++row)
    alike += LooksLikeADoor(At(image, row, column), median_light) ? 1 : 0;
  return alike > 0.65 * image.rows;
}

}  // namespace

bool DetectDoor(const RgbImage& image, double side_range_m) {
  constexpr int kColumns = 8;           // an eighth of the image
  constexpr double kBeyondWallM = 2.3;  // an open door
  const double median_light = MedianLight(image);
  int columns = 0;
  for (int column = 0; column < image.columns; ++column)
    columns += IsDoorColumn(image, column, median_light) ? 1 : 0;
  return columns >= kColumns || side_range_m > kBeyondWallM;
}

bool DetectLight(const RgbImage& image) {
  constexpr double kGlare = 245, kShare = 0.08;
  int glaring = 0;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const Pixel p = At(image, row, column);
      glaring += std::min({p.r, p.g, p.b}) > kGlare * 0.9 && p.light() > kGlare ? 1 : 0;
    }
  }
  return glaring > kShare * image.rows * image.columns;
}

}  // namespace cairn::datasets::corridor
