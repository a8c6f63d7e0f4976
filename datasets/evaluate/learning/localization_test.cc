#include "datasets/evaluate/learning/localization.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "datasets/evaluate/testing/localization.h"
#include "datasets/testing.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

TEST(EvaluateLocalization, TakesTheMeanErrorOverTraversesByHand) {
  const LocalizationScore score = EvaluateLocalization(LocalizationFile(), LocalizedSamples());
  EXPECT_EQ(score.traverses, 2);
  EXPECT_FALSE(score.against_truth);
  EXPECT_EQ(score.runs, (std::vector<std::string>{"there"}));
  ASSERT_EQ(score.rows.size(), 3U);
  // Nothing sensed: even over 0, 1, 2, 3 m; the true positions are 0 and 1 m.
  EXPECT_NEAR(score.rows[0].believed.mean_m, (1.5 + 1.0) / 2, 1e-6);
  EXPECT_NEAR(score.rows[0].mean.mean_m, (1.5 + 0.5) / 2, 1e-6);
  // One sensed: half at 1, half at 2 m, truth 1 m; sure of 2 m, which is true.
  EXPECT_EQ(score.rows[1].traverses, 2);
  EXPECT_NEAR(score.rows[1].believed.mean_m, 0.25, 1e-6);
  EXPECT_NEAR(score.rows[1].travelled_m, 1.0, 1e-6);
  EXPECT_FALSE(score.rows[0].mode) << "of positions that are all as likely none is the most likely";
  ASSERT_TRUE(score.rows[1].mode);
  EXPECT_NEAR(score.rows[1].mode->mean_m, 0.0, 1e-6);
  EXPECT_NEAR(score.rows[1].within_1m, 1.0, 1e-6);
  // t of one degree of freedom is 12.706; the standard error of 0.5 and 0 is 0.25.
  ASSERT_TRUE(score.rows[1].believed.interval_95);
  EXPECT_NEAR(score.rows[1].believed.interval_95->high, 0.25 + 12.7062 * 0.25, 1e-3);
  EXPECT_EQ(score.rows[2].traverses, 1);
  EXPECT_FALSE(score.rows[2].believed.interval_95);
  ASSERT_TRUE(score.under_1m_after_m);
  EXPECT_NEAR(*score.under_1m_after_m, 1.0, 1e-6);
}

TEST(EvaluateLocalization, HoldsAgainstTruthWhereThereIsAny) {
  Blob samples = LocalizedSamples();
  samples.PutVector<double>("truth/run/0/x_m", {10, 11, 12, 13});
  samples.PutVector<double>("truth/run/0/y_m", {0, 0, 0, 0});
  const LocalizationScore score = EvaluateLocalization(LocalizationFile(), samples);
  EXPECT_TRUE(score.against_truth);
  EXPECT_NEAR(score.rows[1].believed.mean_m, 9.75, 1e-6);
  EXPECT_FALSE(score.under_1m_after_m);
}

TEST(EvaluateLocalization, SaysHowMuchIsBelievedOfFacingAsItDoes) {
  Blob samples = LocalizedSamples(), result = LocalizationFile();
  samples.PutVector<double>("run/0/heading_rad", {0, 0, 0, 3});
  result.Put("samples_hash", Array::Text(samples.ContentHash().Hex()));
  EXPECT_EQ(EvaluateLocalization(result, samples).heading, "");
  result.PutVector<double>("position/heading_rad", {0, 3.1, -0.1, 3.1});
  result.Put("heading", Array::Text("unknown"));
  const LocalizationScore score = EvaluateLocalization(result, samples);
  EXPECT_NEAR(score.rows[0].facing, 0.5, 1e-6);
  EXPECT_NEAR(score.rows[1].facing, (0.5 + 1) / 2, 1e-6);
  ExpectContains(MakeScores(score).ToText(), "nothing known at the start\n");
  ExpectContains(MakeScores(score).ToText(), "heading                         unknown to the robot\n");
  EXPECT_NEAR(nlohmann::json::parse(MakeScores(score).ToJson())["rows"][1]["facing"].get<double>(), 0.75,
              1e-6);
}

TEST(EvaluateLocalization, PrintsForPeopleAndPrograms) {
  const LocalizationScore score = EvaluateLocalization(LocalizationFile(), LocalizedSamples());
  const auto json = nlohmann::json::parse(MakeScores(score).ToJson());
  EXPECT_NEAR(json["rows"][1]["error"]["mean_m"].get<double>(), 0.25, 1e-6);
  EXPECT_TRUE(json["window_m"].is_null());
  EXPECT_EQ(json["rows"][2]["error"]["mean_m_95"], nullptr);
  EXPECT_TRUE(json["rows"][0]["error_of_mode"]["mean_m"].is_null());
  EXPECT_NEAR(json["rows"][1]["error_of_mode"]["mean_m"].get<double>(), 0.0, 1e-6);
  ExpectContains(MakeScores(score).ToText(), "under_1m_after_m                1.000 m\n");
}

// As those that image_features made lie beside its other results.
TEST(EvaluateLocalization, SamplesThatSayHowTheyCameAboutAreTheSame) {
  Blob published = LocalizedSamples();
  published.Put("provenance/stage", Array::Text("features"));
  EXPECT_NO_THROW(EvaluateLocalization(LocalizationFile(), published));
}

TEST(EvaluateLocalization, RefusesWhatDoesNotFit) {
  const auto complaint = [](const Blob& result, const Blob& samples) -> std::string {
    try {
      EvaluateLocalization(result, samples);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  Blob other = LocalizedSamples();
  other.PutVector<double>("run/0/x_m", {0, 1, 2, 4});
  ExpectContains(complaint(LocalizationFile(), other), "made from other samples");
  Blob far = LocalizationFile();
  far.PutVector<std::int32_t>("step/sample", {0, 1, 2, 1, 9});
  ExpectContains(complaint(far, LocalizedSamples()), "'step/sample' names a sample");
  // Beliefs that are none.
  Blob unsure_of_some = LocalizationFile();
  unsure_of_some.PutVector<std::int64_t>("step/entries", {12, 0, 0, 0, 0});
  ExpectContains(complaint(unsure_of_some, LocalizedSamples()), "does not sum to 1");
  for (const float p : {0.0F, 1.0F, 0.01F}) {
    Blob unsure = LocalizationFile();
    unsure.PutVector("belief/probability", std::vector<float>(12, p));
    ExpectContains(complaint(unsure, LocalizedSamples()), "does not sum to 1");
  }
  EXPECT_EQ(complaint(LocalizedSamples(), LocalizedSamples()),
            "not a localization: 'step/traverse' is missing");
}

}  // namespace
}  // namespace cairn::datasets
