// What a network sees of an image: S. Thrun, Bayesian Landmark Learning for Mobile Robot Localization,
// Machine Learning 33, 1998, section 5.1.3 ([T98] here).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cairn::datasets {

inline constexpr int kImageBands = 10;    // rows, and columns, of which an image is made
inline constexpr int kValuesOfABand = 7;  // brightness, three colours, three textures
inline constexpr int kImageFeatures = 2 * kImageBands * kValuesOfABand;

struct RgbImage {
  int rows = 0, columns = 0;
  std::vector<std::uint8_t> rgb;  // [rows][columns][3]
};

// "row 0 brightness", "row 0 red", …, "column 9 blue texture".
std::vector<std::string> ImageFeatureNames();

// [kImageFeatures], of the image with its values' mean made 0 and their variance 1 (where all are the same:
// all features are 0). For each of ten rows, then of ten columns: mean of all values; mean of each channel;
// mean absolute difference of each channel between neighbours in the band, sideways and up and down, of every
// so-many-th pixel, 60 rows by 64 columns at most. The image has 10 rows and columns or more.
std::vector<float> ImageFeatures(const RgbImage& image);

}  // namespace cairn::datasets
