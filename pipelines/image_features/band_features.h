// What a network sees of an image: [Thr98] section 5.1.3.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pipelines/image_features/options.h"

namespace cairn::image_features {

inline constexpr int kValuesOfABand = 7;  // brightness, three colours, three textures

// 8 bits of red, green, blue.
struct Image {
  int rows = 0, columns = 0;
  std::span<const std::uint8_t> rgb;  // [rows][columns][3]
};

// "row 0 brightness", "row 0 red", …, "column 9 blue texture": 2 * bands * kValuesOfABand.
std::vector<std::string> BandFeatureNames(const Options& options);

// As many, of the image with its values' mean made 0 and their variance 1 (where all are the same: all
// features are 0). For each band of rows, then of columns: mean of all values; mean of each channel; mean
// absolute difference of each channel between neighbours in the band, sideways and up and down, of every
// so-many-th pixel, `texture_rows` by `texture_columns` at most (0 where the band has no neighbours). The
// image, and the smaller one, has a row and a column for each band or more.
std::vector<float> BandFeatures(const Options& options, const Image& image);

}  // namespace cairn::image_features
