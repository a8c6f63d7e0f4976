#include "pipelines/image_features/band_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace cairn::image_features {
namespace {

// Of an image whose value at row, column, channel is `value(row, column, channel)`.
template <class Function>
std::vector<float> FeaturesOf(int rows, int columns, Function value, const Options& options = {}) {
  std::vector<std::uint8_t> rgb;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      for (int c = 0; c < 3; ++c) rgb.push_back(static_cast<std::uint8_t>(value(row, column, c)));
    }
  }
  return BandFeatures(options, {rows, columns, rgb});
}

float Feature(const std::vector<float>& features, const std::string& name) {
  const std::vector<std::string> names = BandFeatureNames({});
  const auto at = std::ranges::find(names, name);
  EXPECT_NE(at, names.end()) << name;
  return features[static_cast<std::size_t>(at - names.begin())];
}

TEST(BandFeatures, HaveNamesOfTheirOwn) {
  std::vector<std::string> names = BandFeatureNames({});
  EXPECT_EQ(names.size(), 140U);
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
}

// Worked by hand: the upper half is (200, 0, 0), the lower one black. Mean 100/3, mean square 20000/3,
// variance 50000/9, so that 200 becomes sqrt(5) and 0 becomes -1/sqrt(5).
TEST(BandFeatures, OfAnImageByHand) {
  const auto features = FeaturesOf(20, 30, [](int row, int, int c) { return row < 10 && c == 0 ? 200 : 0; });
  ASSERT_EQ(features.size(), 140U);
  const double bright = std::sqrt(5), dark = -1 / std::sqrt(5);
  EXPECT_NEAR(Feature(features, "row 0 red"), bright, 1e-6);
  EXPECT_NEAR(Feature(features, "row 0 blue"), dark, 1e-6);
  EXPECT_NEAR(Feature(features, "row 0 brightness"), (bright + 2 * dark) / 3, 1e-6);
  EXPECT_NEAR(Feature(features, "row 9 red"), dark, 1e-6);
  EXPECT_NEAR(Feature(features, "column 4 red"), (bright + dark) / 2, 1e-6);
  EXPECT_EQ(Feature(features, "row 4 red texture"), 0);
  EXPECT_EQ(Feature(features, "column 4 green texture"), 0);
  // A column's band is 20 by 3: 20 * 2 pairs sideways, 19 * 3 up and down, of which 3 cross the edge.
  EXPECT_NEAR(Feature(features, "column 4 red texture"), (bright - dark) * 3 / 97, 1e-6);
}

TEST(BandFeatures, ForgetBrightnessAndContrast) {
  const auto scene = [](int row, int column, int c) { return (row * 7 + column * 3 + c * 11) % 50; };
  const auto a = FeaturesOf(25, 120, scene);
  const auto b = FeaturesOf(25, 120, [&](int r, int k, int c) { return 40 + 3 * scene(r, k, c); });
  ASSERT_EQ(a.size(), 140U);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-5) << BandFeatureNames({})[i];
  EXPECT_GT(Feature(a, "row 3 red texture"), 0.1);
}

// Texture is of every other pixel of 120 by 128: stripes of one pixel vanish, stripes of two do not.
TEST(BandFeatures, TextureIsOfTheSmallerImage) {
  const auto thin = FeaturesOf(120, 128, [](int, int column, int) { return column % 2 * 100; });
  const auto wide = FeaturesOf(120, 128, [](int, int column, int) { return column / 2 % 2 * 100; });
  EXPECT_EQ(Feature(thin, "row 5 green texture"), 0);
  // 6 * 63 pairs sideways differ by 2, 5 * 64 up and down by nothing.
  EXPECT_NEAR(Feature(wide, "row 5 green texture"), 2.0 * 378 / (378 + 320), 1e-6);
}

TEST(BandFeatures, OfAFlatImageAreZero) {
  const std::vector<float> features = FeaturesOf(10, 10, [](int, int, int) { return 77; });
  ASSERT_EQ(features.size(), 140U);
  for (const float value : features) EXPECT_EQ(value, 0);
}

TEST(BandFeatures, BandsCoverAnImageThatTenDoesNotDivide) {
  for (int row = 0; row < 25; ++row) {
    const auto features = FeaturesOf(25, 17, [&](int r, int, int) { return r == row ? 255 : 0; });
    int bright = 0;
    for (int band = 0; band < 10; ++band)
      bright += Feature(features, "row " + std::to_string(band) + " brightness") > 0 ? 1 : 0;
    EXPECT_EQ(bright, 1) << "row " << row;
  }
}

// Of one band, rows and columns say the same, and all colours' means are 0 in sum.
TEST(BandFeatures, AreOfAsManyBandsAsAreAskedFor) {
  const Options one{.bands = 1, .texture_rows = 2, .texture_columns = 2};
  const auto features = FeaturesOf(3, 4, [](int row, int k, int c) { return 9 * row + k + 30 * c; }, one);
  ASSERT_EQ(features.size(), 14U);
  EXPECT_EQ(BandFeatureNames(one).back(), "column 0 blue texture");
  EXPECT_EQ(std::vector<float>(features.begin(), features.begin() + 7),
            std::vector<float>(features.begin() + 7, features.end()));
  EXPECT_NEAR(features[1] + features[2] + features[3], 0, 1e-6);
  EXPECT_LT(features[1], features[2]);
}

}  // namespace
}  // namespace cairn::image_features
