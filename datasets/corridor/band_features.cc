#include "datasets/corridor/band_features.h"

#include <array>
#include <cmath>
#include <cstdlib>

#include "schema/error.h"

namespace cairn::datasets::corridor {
namespace {

// Of a band: sums over its pixels, and over pairs of neighbours within it, by channel. Whole numbers: exact.
struct Sums {
  std::array<std::int64_t, 3> value{}, difference{};
  std::int64_t pixels = 0, pairs = 0;
};

class Bands {
 public:
  explicit Bands(const RgbImage& image)
      : image_(image), row_band_(Edges(image.rows)), column_band_(Edges(image.columns)) {
    for (int row = 0; row < image.rows; ++row) {
      for (int column = 0; column < image.columns; ++column) Add(row, column);
    }
  }
  const std::array<Sums, 2 * kBands>& sums() const { return sums_; }

 private:
  // The band of each row (or column): where ten do not divide them, they differ by one.
  static std::vector<std::size_t> Edges(int length) {
    std::vector<std::size_t> band(static_cast<std::size_t>(length));
    for (int b = 0; b < kBands; ++b) {
      for (int i = b * length / kBands; i < (b + 1) * length / kBands; ++i)
        band[static_cast<std::size_t>(i)] = static_cast<std::size_t>(b);
    }
    return band;
  }
  int Value(int row, int column, std::size_t channel) const {
    return image_.rgb[static_cast<std::size_t>(3 * (row * image_.columns + column)) + channel];
  }
  void Add(int row, int column) {
    const std::size_t r = row_band_[static_cast<std::size_t>(row)],
                      c = column_band_[static_cast<std::size_t>(column)];
    for (Sums* sums : {&sums_[r], &sums_[kBands + c]}) {
      ++sums->pixels;
      for (std::size_t channel = 0; channel < 3; ++channel)
        sums->value[channel] += Value(row, column, channel);
    }
    if (row + 1 < image_.rows) {
      if (row_band_[static_cast<std::size_t>(row) + 1] == r) AddPair(row, column, row + 1, column, &sums_[r]);
      AddPair(row, column, row + 1, column, &sums_[kBands + c]);
    }
    if (column + 1 < image_.columns) {
      AddPair(row, column, row, column + 1, &sums_[r]);
      if (column_band_[static_cast<std::size_t>(column) + 1] == c)
        AddPair(row, column, row, column + 1, &sums_[kBands + c]);
    }
  }
  void AddPair(int row, int column, int other_row, int other_column, Sums* sums) const {
    ++sums->pairs;
    for (std::size_t channel = 0; channel < 3; ++channel)
      sums->difference[channel] +=
          std::abs(Value(row, column, channel) - Value(other_row, other_column, channel));
  }

  const RgbImage& image_;
  std::vector<std::size_t> row_band_, column_band_;
  std::array<Sums, 2 * kBands> sums_{};
};

}  // namespace

std::vector<std::string> BandFeatureNames() {
  std::vector<std::string> names;
  for (const char* side : {"row ", "column "}) {
    for (int band = 0; band < kBands; ++band) {
      for (const char* what :
           {"brightness", "red", "green", "blue", "red texture", "green texture", "blue texture"})
        names.push_back(side + std::to_string(band) + " " + what);
    }
  }
  return names;
}

std::vector<float> BandFeatures(const RgbImage& image) {
  std::int64_t sum = 0, squares = 0;
  for (const std::uint8_t value : image.rgb) {
    sum += value;
    squares += value * value;
  }
  const auto count = static_cast<double>(image.rgb.size());
  const double mean = static_cast<double>(sum) / count;
  const double variance = static_cast<double>(squares) / count - mean * mean;
  CAIRN_DEMAND(variance > 0, "an image of one colour");
  const double scale = 1 / std::sqrt(variance);
  std::vector<float> features;
  const Bands bands(image);
  for (const Sums& band : bands.sums()) {
    std::array<double, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c)
      colour[c] = scale * (static_cast<double>(band.value[c]) / static_cast<double>(band.pixels) - mean);
    features.push_back(static_cast<float>((colour[0] + colour[1] + colour[2]) / 3));
    for (const double value : colour) features.push_back(static_cast<float>(value));
    for (const std::int64_t difference : band.difference)
      features.push_back(
          static_cast<float>(scale * static_cast<double>(difference) / static_cast<double>(band.pairs)));
  }
  return features;
}

}  // namespace cairn::datasets::corridor
