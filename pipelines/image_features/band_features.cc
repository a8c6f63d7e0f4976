#include "pipelines/image_features/band_features.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "schema/error.h"

namespace cairn::image_features {
namespace {

constexpr int kChannels = 3;

// Pixels [row, end_row) x [column, end_column).
struct Box {
  int row, end_row, column, end_column;
};

// Band `i` of `bands`: the rows' bands first, then the columns'. Where they do not divide the image they
// differ by one.
Box Band(int i, int bands, int rows, int columns) {
  const auto edge = [&](int band, int length) { return band * length / bands; };
  // [Thr98] section 5.1.3: rows and columns of equal size
  if (i < bands) return {edge(i, rows), edge(i + 1, rows), 0, columns};
  return {0, rows, edge(i - bands, columns), edge(i - bands + 1, columns)};
}

std::uint8_t Value(const Image& image, int row, int column, int channel) {
  return image.rgb[(static_cast<std::size_t>(row) * static_cast<std::size_t>(image.columns) +
                    static_cast<std::size_t>(column)) *
                       kChannels +
                   static_cast<std::size_t>(channel)];
}

// An image that owns its values.
struct SmallImage {
  int rows, columns;
  std::vector<std::uint8_t> rgb;
  Image view() const { return {rows, columns, rgb}; }
};

SmallImage Subsampled(const Image& image, int most_rows, int most_columns) {
  SmallImage small{std::min(image.rows, most_rows), std::min(image.columns, most_columns), {}};
  for (int row = 0; row < small.rows; ++row) {
    for (int column = 0; column < small.columns; ++column) {
      // The pixel in the middle of those that it stands for.
      const int from_row = (2 * row + 1) * image.rows / (2 * small.rows);
      const int from_column = (2 * column + 1) * image.columns / (2 * small.columns);
      for (int c = 0; c < kChannels; ++c) small.rgb.push_back(Value(image, from_row, from_column, c));
    }
  }
  return small;
}

// Sums of whole numbers are exact: the order of adding does not matter.
double Mean(const Image& image, const Box& box, int channel) {
  std::int64_t sum = 0;
  for (int row = box.row; row < box.end_row; ++row) {
    for (int column = box.column; column < box.end_column; ++column)
      sum += Value(image, row, column, channel);
  }
  return static_cast<double>(sum) / ((box.end_row - box.row) * (box.end_column - box.column));
}

double Texture(const Image& image, const Box& box, int channel) {
  std::int64_t sum = 0, pairs = 0;
  const auto add = [&](int row, int column, int other_row, int other_column) {
    if (other_row == box.end_row || other_column == box.end_column) return;
    sum += std::abs(Value(image, row, column, channel) - Value(image, other_row, other_column, channel));
    ++pairs;
  };
  for (int row = box.row; row < box.end_row; ++row) {
    for (int column = box.column; column < box.end_column; ++column) {
      add(row, column, row, column + 1);
      add(row, column, row + 1, column);
    }
  }
  return pairs == 0 ? 0 : static_cast<double>(sum) / static_cast<double>(pairs);
}

}  // namespace

std::vector<std::string> BandFeatureNames(const Options& options) {
  std::vector<std::string> names;
  for (const char* side : {"row ", "column "}) {
    for (std::int64_t band = 0; band < options.bands; ++band) {
      for (const char* what :
           {"brightness", "red", "green", "blue", "red texture", "green texture", "blue texture"})
        names.push_back(side + std::to_string(band) + " " + what);
    }
  }
  return names;
}

std::vector<float> BandFeatures(const Options& options, const Image& image) {
  const SmallImage subsampled =
      Subsampled(image, static_cast<int>(options.texture_rows), static_cast<int>(options.texture_columns));
  const Image small = subsampled.view();
  const auto bands = static_cast<int>(options.bands);
  CAIRN_DEMAND(std::min(small.rows, small.columns) >= bands, "an image of too few pixels");
  std::int64_t sum = 0, squares = 0;
  for (const std::uint8_t value : image.rgb) {
    sum += value;
    squares += value * value;
  }
  const auto count = static_cast<double>(image.rgb.size());
  const double mean = static_cast<double>(sum) / count;
  const double variance = static_cast<double>(squares) / count - mean * mean;
  // Values are whole numbers: one that differs at all makes more variance than rounding does.
  const bool flat = std::ranges::all_of(image.rgb, [&](std::uint8_t v) { return v == image.rgb.front(); });
  // [Thr98] section 5.1.3: mean and variance are normalised in each image.
  const double scale = flat ? 0 : 1 / std::sqrt(variance);
  std::vector<float> features;
  for (int i = 0; i < 2 * bands; ++i) {
    const Box box = Band(i, bands, image.rows, image.columns),
              small_box = Band(i, bands, small.rows, small.columns);
    std::array<double, kChannels> color{};
    for (int c = 0; c < kChannels; ++c)
      color[static_cast<std::size_t>(c)] = scale * (Mean(image, box, c) - mean);
    // [Thr98] section 5.1.3: brightness, colour, texture
    features.push_back(static_cast<float>((color[0] + color[1] + color[2]) / kChannels));
    for (const double value : color) features.push_back(static_cast<float>(value));
    for (int c = 0; c < kChannels; ++c)
      features.push_back(static_cast<float>(scale * Texture(small, small_box, c)));
  }
  return features;
}

}  // namespace cairn::image_features
