#include <gtest/gtest.h>

#include <cmath>

#include "datasets/kinds/job_report.h"
#include "datasets/report/pages/pages.h"
#include "datasets/testing.h"

namespace cairn::datasets::report {
namespace {

// Two networks, four samples of two runs, three steps; the second step looked at the held-out run.
Blob Learned() {
  Blob result;
  result.Put("networks/hidden_weight", Array::Of<double>({2, 3, 3}, std::vector<double>(18, 0.0)));
  result.Put("networks/hidden_bias", Array::Of<double>({2, 3}, std::vector<double>(6, 0.0)));
  result.PutVector<double>("networks/output_bias", {0, 0});
  result.PutVector<double>("networks/input_mean", {0, 0, 0});
  result.PutVector<double>("map/x_m", {0, 1, 0, 1});
  result.PutVector<double>("map/along_m", {0, 1, 0, 1});
  result.PutVector<std::int32_t>("map/run", {0, 0, 1, 1});
  result.Put("map/output", Array::Of<float>({4, 2}, std::vector<float>{0, 1, 1, 0, 0, 1, 1, 0}));
  result.PutVector<double>("history/training_error_m", {1.0, 0.8, 0.5});
  result.PutVector<double>("history/validation_error_m", {NAN, 0.9, NAN});
  result.PutVector<double>("history/gradient_norm", {0.3, 0.1, 0.0});
  result.PutScalar("prior_error_m", 1.0);
  result.PutScalar("validation_prior_error_m", 1.2);
  result.PutScalar("window_m", 2.0);
  return result;
}

std::string PageOf(const Blob& result, const std::string& title) {
  return JobReportHtml({{.name = "learned", .result = &result}}, title);
}

TEST(NetworksPage, ShowsHowTrainingWentAndWhatTheNetworksSee) {
  const std::string html = PageOf(Learned(), "a <b>");
  ExpectContains(html, "<title>a &lt;b&gt;</title>");
  ExpectContains(html, "<b>50%</b><span>error reduction, runs trained on");
  ExpectContains(html, "<b>25%</b><span>the best on the held-out run");
  ExpectContains(html, "<b>3</b><span>hidden units of each");
  ExpectContains(html, "4 samples of 3 inputs");
  for (const char* part : {"Error reduction", "Posterior error", "Gradient", "Network 0", "Network 1"})
    ExpectContains(html, std::string(">") + part + "<");
  EXPECT_EQ(html.find(">Gradient<"), html.rfind(">Gradient<")) << "a chart is titled once";
  EXPECT_EQ(html.find("<h2>Warnings"), std::string::npos);
  EXPECT_EQ(html.find("<h2>Before this run"), std::string::npos);
  EXPECT_EQ(html.find("nan"), std::string::npos);
  EXPECT_EQ(html, PageOf(Learned(), "a <b>"));
}

TEST(NetworksPage, CountsTheUnitsOfBothHiddenLayers) {
  Blob result = Learned();
  result.Put("networks/hidden_2_bias", Array::Of<double>({2, 5}, std::vector<double>(10, 0.0)));
  ExpectContains(NetworksHtml(result), "<b>3 + 5</b><span>hidden units of each");
}

TEST(NetworksPage, SaysWhichStartWentOn) {
  Blob result = Learned();
  result.PutVector<double>("starts/error_m", {0.9, 0.8, 0.95});
  result.PutScalar<std::int64_t>("starts/chosen", 1);
  ExpectContains(NetworksHtml(result), "<b>1 of 3</b><span>start");
}

TEST(NetworksPage, NamesWarningsAndTheRunsBefore) {
  Blob result = Learned();
  result.Put("warnings", Array::Texts({"step 3: network 1 is saturated"}));
  result.Put("ancestry/hash", Array::Texts({"0123456789abcdef0123456789abcdef"}));
  result.Put("ancestry/options", Array::Texts({"rate=0.5"}));
  result.PutVector<std::int64_t>("ancestry/steps", {77});
  result.PutVector<double>("ancestry/training_error_m", {0.25});
  result.PutVector<double>("ancestry/prior_error_m", {1.0});
  const std::string html = NetworksHtml(result);
  ExpectContains(html, "<li>step 3: network 1 is saturated</li>");
  ExpectContains(html, "<td>01234567</td><td>77</td><td>75%</td><td>rate=0.5</td>");
}

TEST(NetworksPage, SaysWhatIsMissing) {
  ExpectContains(InputErrorOf([&] { NetworksHtml(Learned().Without("window_m")); }), "window_m");
}

}  // namespace
}  // namespace cairn::datasets::report
