#include "datasets/images/image_features.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr int kTextureRows = 60, kTextureColumns = 64;  // [T98] 5.1.3
constexpr int kChannels = 3;

// Pixels [row, end_row) x [column, end_column).
struct Box {
  int row, end_row, column, end_column;
};

// Band `i` of ten: the rows' bands first, then the columns'. Where ten do not divide the image they differ by
// one.
Box Band(int i, int rows, int columns) {
  const auto edge = [](int band, int length) { return band * length / kImageBands; };
  if (i < kImageBands) return {edge(i, rows), edge(i + 1, rows), 0, columns};
  return {0, rows, edge(i - kImageBands, columns), edge(i - kImageBands + 1, columns)};
}

std::uint8_t Value(const RgbImage& image, int row, int column, int channel) {
  return image.rgb[(static_cast<std::size_t>(row) * static_cast<std::size_t>(image.columns) +
                    static_cast<std::size_t>(column)) *
                       kChannels +
                   static_cast<std::size_t>(channel)];
}

RgbImage Subsampled(const RgbImage& image) {
  RgbImage small{std::min(image.rows, kTextureRows), std::min(image.columns, kTextureColumns), {}};
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
double Mean(const RgbImage& image, const Box& box, int channel) {
  std::int64_t sum = 0;
  for (int row = box.row; row < box.end_row; ++row) {
    for (int column = box.column; column < box.end_column; ++column)
      sum += Value(image, row, column, channel);
  }
  return static_cast<double>(sum) / ((box.end_row - box.row) * (box.end_column - box.column));
}

double Texture(const RgbImage& image, const Box& box, int channel) {
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
  return static_cast<double>(sum) / static_cast<double>(pairs);
}

}  // namespace

std::vector<std::string> ImageFeatureNames() {
  std::vector<std::string> names;
  for (int i = 0; i < 2 * kImageBands; ++i) {
    const std::string band = (i < kImageBands ? "row " : "column ") + std::to_string(i % kImageBands) + " ";
    for (const char* what :
         {"brightness", "red", "green", "blue", "red texture", "green texture", "blue texture"})
      names.push_back(band + what);
  }
  return names;
}

std::vector<float> ImageFeatures(const RgbImage& image) {
  CAIRN_DEMAND(image.rows >= kImageBands && image.columns >= kImageBands, "an image of too few pixels");
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
  const double scale = flat ? 0 : 1 / std::sqrt(variance);
  const RgbImage small = Subsampled(image);
  std::vector<float> features;
  for (int i = 0; i < 2 * kImageBands; ++i) {
    const Box box = Band(i, image.rows, image.columns), small_box = Band(i, small.rows, small.columns);
    std::array<double, kChannels> color{};
    for (int c = 0; c < kChannels; ++c)
      color[static_cast<std::size_t>(c)] = scale * (Mean(image, box, c) - mean);
    features.push_back(static_cast<float>((color[0] + color[1] + color[2]) / kChannels));
    for (const double value : color) features.push_back(static_cast<float>(value));
    for (int c = 0; c < kChannels; ++c)
      features.push_back(static_cast<float>(scale * Texture(small, small_box, c)));
  }
  return features;
}

}  // namespace cairn::datasets
