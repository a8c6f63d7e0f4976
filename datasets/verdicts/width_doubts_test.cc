#include "datasets/verdicts/width_doubts.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cairn::datasets {
namespace {

// Of ranges that err by so many times 0.1 m.
kinds::LandmarkMap::Fit RangesErr(double times, bool told, std::optional<double> false_ratio = {}) {
  kinds::LandmarkMap::Fit fit;
  fit.kind = std::vector<std::string>{"range"};
  fit.stated = std::vector<double>{0.1};
  fit.found = std::vector<double>{0.1 * times};
  fit.told = std::vector<std::uint8_t>{told};
  if (false_ratio) fit.false_ratio = *false_ratio;
  return fit;
}

TEST(OfWidths, SaysFromHalfMoreOnWhatIsStatedAndFromTwiceOnWhatWasExpected) {
  EXPECT_EQ(OfWidths(RangesErr(1.4, true), false, false).text, "");
  EXPECT_EQ(OfWidths(RangesErr(1.6, true), false, false).text,
            "ranges or bearings err by 1.6 times what is stated: is the sensor less exact?");
  EXPECT_EQ(OfWidths(RangesErr(1.6, true), false, false).at_most, Confidence::kHigh);
  EXPECT_EQ(OfWidths(RangesErr(1.9, false), false, false).text, "");
  const Verdict::Doubt twice = OfWidths(RangesErr(2.2, false), false, false);
  EXPECT_EQ(twice.at_most, Confidence::kFair);
  EXPECT_EQ(twice.text,
            "ranges or bearings err by 2.2 times what was expected, as nothing is stated of them: is the "
            "sensor less exact?");
  EXPECT_EQ(OfWidths(RangesErr(3.5, false), false, false).at_most, Confidence::kLow);
}

TEST(OfWidths, ACoarseSensorIsNoWrongMount) {
  kinds::LandmarkMap::Fit fit = RangesErr(3.5, false);
  const auto doubt = [&](double repeats, bool named) {
    fit.repeats_along = 1.0;
    fit.repeats_across = repeats;
    return OfWidths(fit, named, false);
  };
  const Verdict::Doubt coarse = doubt(1, true);
  EXPECT_EQ(coarse.at_most, Confidence::kFair);
  EXPECT_EQ(coarse.text,
            "ranges or bearings err by 3.5 times what was expected, as nothing is stated of them: is the "
            "sensor so coarse? Then `cairn import csv --range-m=0.35` states it");
  const Verdict::Doubt nameless = doubt(1, false);
  EXPECT_EQ(nameless.at_most, Confidence::kLow);
  EXPECT_NE(nameless.text.find("is the sensor less exact?"), std::string::npos) << nameless.text;
  const Verdict::Doubt goes_on = doubt(4, true);
  EXPECT_EQ(goes_on.at_most, Confidence::kLow);
  EXPECT_NE(goes_on.text.find("is the sensor's mount right?"), std::string::npos) << goes_on.text;
}

TEST(OfWidths, ASmallerErrorThatIsStatedCountsBesideALargerOneThatIsNot) {
  kinds::LandmarkMap::Fit fit = RangesErr(1.6, true);
  fit.kind = std::vector<std::string>{"range", "bearing"};
  fit.stated = std::vector<double>{0.1, 0.02};
  fit.found = std::vector<double>{0.16, 0.036};
  fit.told = std::vector<std::uint8_t>{1, 0};
  EXPECT_NE(OfWidths(fit, false, false).text.find("1.6 times what is stated"), std::string::npos);
}

TEST(OfMuchLeftOut, IsNoDoubtWhereTheLogStatesThatSoManyAreFalse) {
  const auto at_most = [](double explained, std::optional<double> false_ratio) {
    return OfMuchLeftOut(RangesErr(1.6, false, false_ratio), false, explained).at_most;
  };
  EXPECT_EQ(at_most(0.81, {}), Confidence::kHigh) << "a fifth";
  EXPECT_EQ(at_most(0.74, {}), Confidence::kLow);
  EXPECT_EQ(at_most(0.74, 0.26), Confidence::kHigh);
  EXPECT_EQ(at_most(0.74, 0.2), Confidence::kHigh);
  EXPECT_EQ(at_most(0.74, 0.1), Confidence::kLow) << "more than is false";
  EXPECT_EQ(at_most(0.74, 0.33), Confidence::kLow) << "false ones are in the map";
  EXPECT_EQ(OfMuchLeftOut(RangesErr(1.6, true), true, 0.7).at_most, Confidence::kHigh) << "names tell";
  EXPECT_EQ(OfMuchLeftOut(RangesErr(1.2, true), false, 0.7).at_most, Confidence::kHigh);
}

}  // namespace
}  // namespace cairn::datasets
