#include "datasets/report/pages/line_chart.h"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/testing.h"

namespace cairn::datasets::report {
namespace {

std::size_t Occurrences(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(Thinned, KeepsFewPointsAsTheyAreAndManyByTheMeansOfStretches) {
  const std::vector<ChartPoint> few{{1, 5}, {2, 6}};
  EXPECT_EQ(Thinned(few, 2).size(), 2U);
  std::vector<ChartPoint> many;
  for (int i = 0; i < 1000; ++i) many.push_back({static_cast<double>(i), i < 500 ? 1.0 : 3.0});
  const auto thinned = Thinned(many, 4);
  ASSERT_EQ(thinned.size(), 4U);
  EXPECT_DOUBLE_EQ(thinned[0].x, 124.5);
  EXPECT_DOUBLE_EQ(thinned[1].y, 1.0);
  EXPECT_DOUBLE_EQ(thinned[2].y, 3.0);
}

TEST(LineChart, DrawsEachCurveAndLeavesOutWhatIsNotFinite) {
  Svg svg(400, 200, "x");
  const LineChart chart{
      "Title", "step", "error", {{"a", {{1, 1}, {2, NAN}, {3, 2}}, 0}, {"b", {{1, 2}, {3, 1}}, 1}}};
  EXPECT_TRUE(Draw(chart, {80, 20, 300, 140}, &svg));
  const std::string text = svg.Finish();
  EXPECT_EQ(Occurrences(text, "<polyline"), 2U);
  EXPECT_EQ(Occurrences(text, "nan"), 0U);
  EXPECT_EQ(Occurrences(ChartHtml(chart, ""), ">Title<"), 1U);
}

TEST(LineChart, ALogarithmicAxisLeavesOutZerosAndNamesTheValues) {
  Svg svg(400, 200, "x");
  EXPECT_TRUE(
      Draw({"", "", "", {{"", {{1, 0.0}, {2, 0.01}, {3, 100.0}}, 0}}, true}, {80, 20, 300, 140}, &svg));
  const std::string text = svg.Finish();
  EXPECT_EQ(Occurrences(text, "inf"), 0U);
  EXPECT_EQ(Occurrences(text, ">0.01<"), 1U);
  EXPECT_EQ(Occurrences(text, ">1e+02<"), 1U);
}

TEST(LineChart, SaysWhereThereIsNothingToDraw) {
  Svg svg(400, 200, "x");
  const std::string before = svg.Finish();
  EXPECT_FALSE(Draw({"", "", "", {{"", {{1, NAN}}, 0}}, false}, {80, 20, 300, 140}, &svg));
  EXPECT_EQ(svg.Finish(), before);
}

}  // namespace
}  // namespace cairn::datasets::report
