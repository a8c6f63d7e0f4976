#include "datasets/reproduce/ball/study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/evaluate/testing/localization.h"
#include "datasets/reproduce/ball/active.h"
#include "datasets/reproduce/ball/adapt.h"
#include "datasets/reproduce/ball/variants.h"
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

// One run with two inputs, `first` the value of the first of them; true positions as given.
Blob OneRun(const std::vector<double>& true_x_m, float first) {
  Blob samples;
  std::vector<float> input;
  for (std::size_t k = 0; k < true_x_m.size(); ++k) {
    input.push_back(first + static_cast<float>(k));
    input.push_back(-1);
  }
  samples.PutVector("truth/run/0/x_m", true_x_m);
  samples.PutVector("run/0/x_m", std::vector<double>(true_x_m.size(), 0.0));
  samples.Put("run/0/input", Array::Of<float>({static_cast<std::int64_t>(true_x_m.size()), 2}, input));
  samples.Put("runs", Array::Texts({"a"}));
  samples.Put("input_name", Array::Texts({"row 0 red", "sonar 0"}));
  return samples;
}

TEST(BallStudy, LeavesOutASensor) {
  const Blob rest =
      WithInputs(OneRun({0, 1, 2}, 5), [](const std::string& input) { return input.starts_with("row"); });
  EXPECT_EQ(rest.Texts("input_name"), (std::vector<std::string>{"row 0 red"}));
  EXPECT_EQ(rest.at("run/0/input").shape(), (Shape{3, 1}));
  EXPECT_EQ(rest.Get<float>("run/0/input")[2], 7.0F);
  for (const BallVariant& variant : SensorVariants()) {
    if (!variant.keeps) continue;
    EXPECT_EQ(variant.keeps("sonar 0"), variant.stage != "no_sonar") << variant.stage;
    EXPECT_EQ(variant.keeps("row 0 red texture"),
              variant.stage != "no_rows" && variant.stage != "no_texture" && variant.stage != "no_camera");
    EXPECT_EQ(variant.keeps("column 3 red"),
              variant.stage != "no_columns" && variant.stage != "no_colour" && variant.stage != "no_camera");
  }
}

TEST(BallStudy, JoinsWhatIsSensedNearestInEachDirection) {
  const Blob joined =
      ThreeDirections({OneRun({0, 1, 2}, 0), OneRun({1.9, 0.2, 1.2}, 10), OneRun({-3, 9}, 20)});
  EXPECT_EQ(joined.Texts("input_name")[2], "d2 row 0 red");
  EXPECT_EQ(joined.at("run/0/input").shape(), (Shape{3, 6}));
  const auto input = joined.Get<float>("run/0/input");
  const std::vector<float> second = {1, 12, 20}, third = {2, 10, 20};  // of d1, d2, d3
  for (std::size_t set = 0; set < 3; ++set) {
    EXPECT_EQ(input[6 + 2 * set], second[set]) << set;
    EXPECT_EQ(input[12 + 2 * set], third[set]) << set;
  }
}

// What is sensed at a stop is labelled by the belief's mean; where a robot set out it sensed nothing.
TEST(BallStudy, LabelsWhatARobotSensedByItsOwnEstimates) {
  Blob samples = LocalizedSamples();
  samples.PutVector<double>("truth/run/0/x_m", {0, 1, 2, 3});
  samples.PutVector<double>("truth/run/0/y_m", {0, 0, 0, 0});
  samples.Put("run/0/input", Array::Of<float>({4, 1}, std::vector<float>{5, 6, 7, 8}));
  const Blob labelled = SelfLabelled(samples, LocalizationFile());
  const auto x = labelled.Get<double>("run/0/x_m"), true_x = labelled.Get<double>("truth/run/0/x_m");
  EXPECT_EQ(std::vector(x.begin(), x.end()), (std::vector<double>{1.5, 2, 2}));
  EXPECT_EQ(std::vector(true_x.begin(), true_x.end()), (std::vector<double>{1, 2, 2}));
  EXPECT_EQ(labelled.Get<float>("run/0/input")[1], 7.0F);
  EXPECT_EQ(labelled.Get<double>("run/0/time_s")[0], 1.0);
}

TEST(VariantFigure, ShowsWhatAVariantLosesInTheSameCorridor) {
  const std::vector<BallVariant> variants = {{"a", "A", {}, {}}, {"b", "B", {}, {}}};
  const std::vector<VariantScores> scores = {{"d1", {{"a", 0.5}, {"b", 0.4}}, {{"a", 1}, {"b", 2}}},
                                             {"d1", {{"a", 0.3}, {"b", 0.2}}, {{"a", 1}, {"b", 4}}}};
  const PaperFigure figure = VariantFigure({}, variants, scores, true);
  EXPECT_EQ(figure.table.head,
            (std::vector<std::string>{"error reduction, percent", "D-1", "less", "computing s"}));
  EXPECT_EQ(figure.table.rows[1][2], "10.0 +- 0.0");
  EXPECT_EQ(figure.table.rows[1][3], "3.0");
  EXPECT_EQ(figure.table.rows[0][2], "");
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
