#include "datasets/simulate/corridor/detectors.h"

#include <algorithm>

namespace cairn::datasets::corridor {
namespace {

struct Colour {
  double r = 0, g = 0, b = 0;
};

// The mean over rows [from, to) of a column.
Colour MeanOf(const RgbImage& image, int from, int to, int column) {
  Colour sum;
  for (int row = from; row < to; ++row) {
    const auto at = static_cast<std::size_t>(3 * (row * image.columns + column));
    sum.r += image.rgb[at];
    sum.g += image.rgb[at + 1];
    sum.b += image.rgb[at + 2];
  }
  const double count = to - from;
  return {sum.r / count, sum.g / count, sum.b / count};
}

struct Columns {
  int door = 0, room = 0;
};

// Walls are light brown or orange. Doors are greyish blue, or of dark wood; rooms behind them are grey, as is
// the elevator's door. Colours as ratios, so that light does not matter.
bool IsDoor(const Colour& colour) {
  const double red = colour.r / (colour.g + 1), blue = colour.b / (colour.g + 1);
  const bool paint = red < 1.02 && blue > 1.1;
  const bool wood = red > 1.3 && blue > 0.48 && blue < 0.8;
  return paint || wood;
}

bool IsWall(const Colour& colour) {
  const double red = colour.r / (colour.g + 1), blue = colour.b / (colour.g + 1);
  const bool brown = red > 1.07 && red < 1.29 && blue > 0.66 && blue < 0.9;
  return brown || (red > 1.6 && blue < 0.48);
}

// Doors are taller than what the camera sees: unlike posters and boards they fill a column from top to
// bottom.
Columns CountColumns(const RgbImage& image) {
  constexpr int kParts = 3;
  Columns columns;
  for (int column = 0; column < image.columns; ++column) {
    int door = 0, room = 0;
    for (int part = 0; part < kParts; ++part) {
      const Colour colour =
          MeanOf(image, part * image.rows / kParts, (part + 1) * image.rows / kParts, column);
      door += IsDoor(colour) ? 1 : 0;
      room += IsWall(colour) ? 0 : 1;
    }
    columns.door += door == kParts ? 1 : 0;
    columns.room += room == kParts ? 1 : 0;
  }
  return columns;
}

}  // namespace

bool DetectDoor(const RgbImage& image, std::span<const float> side_ranges_m) {
  constexpr int kColumns = 3;
  // Beyond the wall, yet not as deep as the hallway; where there is no echo a sonar says more still.
  constexpr float kRoomFromM = 2.2F, kRoomToM = 4.8F;
  const Columns columns = CountColumns(image);
  const bool is_deep =
      std::ranges::any_of(side_ranges_m, [](float r) { return r > kRoomFromM && r < kRoomToM; });
  return columns.door >= kColumns || (columns.room >= kColumns && is_deep);
}

bool DetectLight(const RgbImage& image) {
  constexpr int kGlare = 245;
  constexpr std::size_t kPixels = 12;
  std::size_t glaring = 0;
  for (std::size_t at = 0; at < image.rgb.size(); at += 3)
    glaring += std::min({image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]}) >= kGlare ? 1 : 0;
  return glaring >= kPixels;
}

}  // namespace cairn::datasets::corridor
