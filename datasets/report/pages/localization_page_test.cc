#include <gtest/gtest.h>

#include "datasets/evaluate/testing/localization.h"
#include "datasets/kinds/job_report.h"
#include "datasets/report/pages/localized_pictures.h"
#include "datasets/report/pages/pages.h"
#include "datasets/testing.h"

namespace cairn::datasets::report {
namespace {

std::string PageOf(const Blob& result, const Blob* samples, const std::string& title) {
  return JobReportHtml({{.name = "where", .result = &result, .source = samples}}, title);
}

std::size_t OccurrencesOnPage(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(LocalizationPage, ShowsErrorsAndBeliefsWhereTheSamplesAreGiven) {
  const Blob samples = LocalizedSamples();
  const std::string html = PageOf(LocalizationFile(), &samples, "a <b>");
  ExpectContains(html, "<title>a &lt;b&gt;</title>");
  ExpectContains(html,
                 "2 robots in there. Sensed: door. Believed in: 4 positions. At the start nothing is known.");
  ExpectContains(html, "<b>1.25 m ± ");  // the mean of 1.5 and 1.0
  ExpectContains(html, "<b>1.0 m</b><span>travelled until the mean is below 1 m");
  ExpectContains(html, "The robot in the middle, by its error on the way.");
  for (const char* section : {"Error by distance travelled", "How sure", "What a robot believes"})
    ExpectContains(html, std::string("<h2>") + section + "</h2>");
  EXPECT_EQ(OccurrencesOnPage(html, "class=\"area r0\""), 2U) << "on a wide page and on a narrow one";
  EXPECT_EQ(html.find("nan"), std::string::npos);
  EXPECT_EQ(html, PageOf(LocalizationFile(), &samples, "a <b>"));
}

TEST(LocalizationPage, SaysWhichWayRobotsBelieveToFace) {
  Blob samples = LocalizedSamples(), result = LocalizationFile();
  samples.PutVector<double>("run/0/heading_rad", {0, 0, 0, 3});
  result.Put("samples_hash", Array::Text(samples.ContentHash().Hex()));
  result.PutVector<double>("position/heading_rad", {0, 3.1, -0.1, 3.1});
  result.Put("heading", Array::Text("unknown"));
  const std::string html = LocalizationHtml(result, &samples);
  ExpectContains(html, "Which way it faces is unknown to it.");
  ExpectContains(html, "<th>facing right</th>");
  ExpectContains(html, ">Believed of facing as it does<");
}

TEST(LocalizationPage, SaysHowToSeeErrorsWhereItHasNoSamples) {
  const std::string html = LocalizationHtml(LocalizationFile(), nullptr);
  ExpectContains(html, "--log SAMPLES.h5");
  ExpectContains(html, "<b>1.10 m</b><span>as far off as it believes to be, at the start");
  ExpectContains(html, "by how sure it is");
  EXPECT_EQ(html.find("truth-path"), std::string::npos);
  EXPECT_EQ(html.find("<h2>Error"), std::string::npos);
}

TEST(LocalizationPage, RefusesWhatIsNoLocalizationAndOtherSamples) {
  Blob other = LocalizedSamples();
  other.PutVector<double>("run/0/x_m", {0, 1, 2, 4});
  ExpectContains(InputErrorOf([&] { LocalizationHtml(LocalizationFile(), &other); }),
                 "made from other samples");
  ExpectContains(InputErrorOf([&] { LocalizationHtml(other, nullptr); }), "not a localization");
}

TEST(LocalizedPictures, AnExampleIsTheOneInTheMiddleAndTheWorst) {
  const Blob result = LocalizationFile(), samples = LocalizedSamples();
  const LocalizedSteps localized(result);
  const LocalizationScore score = EvaluateLocalization(result, samples);
  // Over the way: (1.5 + 0.5 + 0) / 3 of the first, (1 + 0) / 2 of the second.
  EXPECT_EQ(ExamplesOf(localized, &score).middle, 1U);
  EXPECT_EQ(ExamplesOf(localized, &score).worst, 0U);
}

// On a line way against position; in the plane a map for each of the steps shown.
TEST(LocalizedPictures, PositionsOnALineAreDrawnByWayOthersAsMaps) {
  Blob result = LocalizationFile();
  const Blob samples = LocalizedSamples();
  const LocalizationScore score = EvaluateLocalization(result, samples);
  const std::string line = BeliefPicture(LocalizedSteps(result), &score, 0, 1040).Svg();
  EXPECT_EQ(OccurrencesOnPage(line, "<image"), 1U);
  EXPECT_EQ(OccurrencesOnPage(line, "class=\"truth-path\""), 1U);
  result.PutVector<double>("position/y_m", {0, 2, 0, 1});
  const std::string maps = BeliefPicture(LocalizedSteps(result), &score, 0, 1040).Svg();
  EXPECT_EQ(OccurrencesOnPage(maps, "<image"), 3U);
  ExpectContains(maps, "1 sensed, 1 m: error 0.5 m");
}

}  // namespace
}  // namespace cairn::datasets::report
