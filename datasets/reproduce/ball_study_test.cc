#include "datasets/reproduce/ball_study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/reproduce/over_seeds.h"
#include "datasets/reproduce/paper_figure.h"

namespace cairn::datasets {
namespace {

Blob ThreeRuns() {
  Blob samples;
  for (int r = 0; r < 3; ++r) {
    const std::string run = "run/" + std::to_string(r) + "/";
    samples.PutVector<double>(run + "x_m", {1.0 * r, 10.0 + r});
    samples.PutVector<double>("truth/" + run + "x_m", {0.0, 0.0});
  }
  samples.Put("runs", Array::Texts({"a", "b", "c"}));
  samples.Put("input_name", Array::Texts({"i"}));
  return samples;
}

TEST(BallStudy, TrainsOnTheOtherRunsAndOnNoTruth) {
  const Blob rest = WithoutRun(ThreeRuns(), "b");
  EXPECT_EQ(rest.Texts("runs"), (std::vector<std::string>{"a", "c"}));
  EXPECT_EQ(rest.Get<double>("run/1/x_m")[1], 12.0);
  EXPECT_FALSE(rest.Has("run/2/x_m"));
  EXPECT_TRUE(rest.Sub("truth/").fields().empty());
  EXPECT_EQ(rest.Texts("input_name").size(), 1U);
}

TEST(OverSeeds, AreAMeanAndStudentsInterval) {
  const OverSeeds over = MeanOverSeeds({0.30, 0.36, 0.42});
  EXPECT_NEAR(over.mean, 0.36, 1e-12);
  ASSERT_TRUE(over.half);
  EXPECT_NEAR(*over.half, 4.30265 * 0.06 / std::sqrt(3.0), 1e-9);
  EXPECT_EQ(PercentText(over), "36.0 +- 14.9");
  EXPECT_FALSE(MeanOverSeeds({0.3}).half);
  EXPECT_TRUE(std::isnan(MeanOverSeeds({}).mean));
}

TEST(PaperPage, ShowsTablesAndPicturesWhereThereAreAny) {
  const PaperFigure table{.file = {},
                          .title = "Table",
                          .claim = "a < b",
                          .measured = "m",
                          .png = {},
                          .table = {{"", "D-1"}, {{"n = 1", "14.9"}, {"longer", "5"}}}};
  const PaperFigure picture{.file = "p.png", .title = "Picture", .claim = "c", .measured = "m", .png = "x"};
  const std::string html = PaperPageHtml("title", "lead", {table, picture});
  EXPECT_NE(html.find("<td>14.9</td>"), std::string::npos);
  EXPECT_NE(html.find("a &lt; b"), std::string::npos);
  EXPECT_EQ(html.find("<img"), html.rfind("<img"));
  EXPECT_NE(html.find("src=\"p.png\""), std::string::npos);
  EXPECT_EQ(PaperTableText(table.table), "             D-1\n    n = 1   14.9\n    longer     5\n");
  EXPECT_EQ(PaperTableText({}), "");
}

}  // namespace
}  // namespace cairn::datasets
