// What a network sees of an image: [T98] section 5.1.3. The pipeline image_features makes the same of any
// image; a simulator may not include it, and tests hold the two against each other.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cairn::datasets::corridor {

// 8 bits of red, green, blue.
struct RgbImage {
  int rows = 0, columns = 0;
  std::vector<std::uint8_t> rgb;  // [rows][columns][3]
};

inline constexpr int kBands = 10;                               // of rows, and of columns
inline constexpr int kBandFeatures = 2 * kBands * (1 + 3 + 3);  // brightness, colours, textures of each

// "row 0 brightness", "row 0 red", …, "column 9 blue texture".
std::vector<std::string> BandFeatureNames();

// [kBandFeatures], of the image with its values' mean made 0 and their variance 1. The image has 20 to 60
// rows and 20 to 64 columns, and not all its values are the same.
std::vector<float> BandFeatures(const RgbImage& image);

}  // namespace cairn::datasets::corridor
