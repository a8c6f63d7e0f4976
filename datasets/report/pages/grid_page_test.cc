#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "datasets/evaluate/testing/grid.h"
#include "datasets/kinds/job_report.h"
#include "datasets/report/cell_picture.h"
#include "datasets/report/drawing/palette.h"
#include "datasets/report/pages/pages.h"
#include "datasets/simulate/hall/hall.h"
#include "datasets/testing.h"

namespace cairn::datasets::report {
namespace {

cv::Mat Decoded(const std::string& png) {
  return cv::imdecode(std::vector<std::uint8_t>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

Blob WithAllLayers() {
  Blob map = DrawnMap({"#. ", ".. "}, 0.5);
  map.Put("map/grid/log_odds_difference",
          Array::Of<double>({2, 3}, std::vector<double>{-20, -1, 0, 20, -2, 0}));
  map.Put("map/grid/occupied", Array::Of<std::uint8_t>({2, 3}, std::vector<std::uint8_t>{0, 0, 0, 1, 0, 0}));
  map.PutVector<double>("history/log_likelihood", {-9, -5, -4});
  map.PutVector<double>("robot/0/sonar/x_m", {0.1, 0.4, 0.9});
  map.PutVector<double>("robot/0/sonar/y_m", {0.1, 0.2, 0.3});
  map.PutVector<std::uint8_t>("robot/0/sonar/held_out", {0, 0, 1});
  map.PutScalar("model/p_hit", 0.625);
  map.PutScalar<std::uint8_t>("search/cut_short", 1);
  return map;
}

std::string GridPageOf(const Blob& map, const Blob* log, const GridEvaluation* evaluation,
                       const std::string& title) {
  return JobReportHtml(
      {{.name = "map",
        .result = &map,
        .source = log,
        .evaluated = evaluation != nullptr ? std::optional<Evaluated>(*evaluation) : std::nullopt}},
      title);
}

TEST(CellPicture, IsBlackWhereOccupiedWhiteWhereFreeGreyWhereUnknown) {
  const cv::Mat image = Decoded(CellsRaster(*PictureOf(WithAllLayers(), MapLayer::kMostLikely)).Png());
  ASSERT_EQ(image.size(), cv::Size(3, 2));
  EXPECT_EQ(image.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 0));  // the upper row first
  EXPECT_EQ(image.at<cv::Vec3b>(1, 0), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(image.at<cv::Vec3b>(0, 2), cv::Vec3b(kUnknown[2], kUnknown[1], kUnknown[0]));
  const cv::Mat probability = Decoded(CellsRaster(*PictureOf(WithAllLayers(), MapLayer::kProbability)).Png());
  EXPECT_NEAR(probability.at<cv::Vec3b>(0, 0)[0], 0.2 * 220, 1);              // p = 0.9
  EXPECT_NEAR(probability.at<cv::Vec3b>(1, 0)[0], 0.8 * 255 + 0.2 * 220, 1);  // p = 0.1
}

TEST(GridPage, OtherPicturesOfItsCellsCanBeLaidOverTheMap) {
  const std::string html = GridPageOf(WithAllLayers(), nullptr, nullptr, "a map");
  const std::string map = html.substr(html.find("data-layer=\"cells\""));
  for (const char* layer : {"most likely map", "difference of log-likelihoods"})
    EXPECT_NE(map.find(std::string("class=\"off\" data-layer=\"") + layer + "\""), std::string::npos)
        << layer;
}

TEST(CellPicture, ShowsForWhatTheDataSpeak) {
  const cv::Mat image = Decoded(CellsRaster(*PictureOf(WithAllLayers(), MapLayer::kDifference)).Png());
  const auto& occupied = image.at<cv::Vec3b>(0, 0);  // blue, green, red
  const auto &free = image.at<cv::Vec3b>(1, 0), &doubtful = image.at<cv::Vec3b>(1, 1);
  EXPECT_GT(occupied[2], occupied[0] + 100);
  EXPECT_GT(free[0], free[2] + 100);
  EXPECT_GT(doubtful[2], free[2]);
  EXPECT_EQ(image.at<cv::Vec3b>(0, 2), cv::Vec3b(208, 208, 208)) << "the data do not tell";
}

TEST(CellPicture, ShowsWhatMoved) {
  Blob map = WithAllLayers();
  EXPECT_FALSE(PictureOf(map, MapLayer::kDynamic).has_value());
  map.Put("map/grid/dynamic", Array::Of<std::uint8_t>({2, 3}, std::vector<std::uint8_t>{1, 0, 0, 2, 0, 0}));
  const cv::Mat image = Decoded(CellsRaster(*PictureOf(map, MapLayer::kDynamic)).Png());
  const auto &went = image.at<cv::Vec3b>(0, 0), &passed = image.at<cv::Vec3b>(1, 0);
  EXPECT_GT(went[2], went[0] + 100);
  EXPECT_GT(passed[0], passed[2] + 100);
  EXPECT_GT(image.at<cv::Vec3b>(1, 1)[0], 200);
}

TEST(CellPicture, OfEarlierMapsHasThoseThatDiffer) {
  Blob map = WithAllLayers();
  EXPECT_TRUE(EarlierMaps(map).empty());
  map.PutVector<std::int64_t>("history/changed_iteration", {0, 0, 2});
  map.PutVector<std::int64_t>("history/changed_cell", {0, 3, 0});
  const std::vector<CellPicture> earlier = EarlierMaps(map);
  ASSERT_EQ(earlier.size(), 2U) << "in round 1 nothing changed";
  EXPECT_EQ(earlier[0].At(0, 0), kBlack);
  EXPECT_EQ(earlier[0].At(0, 1), kBlack);
  EXPECT_EQ(earlier[1].At(0, 0), kPaper);
  EXPECT_EQ(earlier[1].At(0, 1), kBlack);
  EXPECT_EQ(earlier[1].At(2, 0), kUnknown) << "as in the end";
  ASSERT_EQ(EarlierMaps(map, 1).size(), 1U);
  EXPECT_EQ(EarlierMaps(map, 1)[0].At(0, 0), kPaper) << "of more than some the last";
  EXPECT_NE(GridPageOf(map, nullptr, nullptr, "x").find("data-rounds=\"iVBOR"), std::string::npos);
  map.PutVector<std::int64_t>("history/changed_cell", {0, 3, 6});
  EXPECT_THROW(EarlierMaps(map), InputError);
}

TEST(CellPicture, OfALargeMapKeepsWhatIsOccupied) {
  std::vector<std::string> rows(1, std::string(7000, '.'));
  rows[0][5001] = '#';
  const cv::Mat image = Decoded(CellsRaster(*PictureOf(DrawnMap(rows), MapLayer::kProbability)).Png());
  EXPECT_LE(image.cols, 3000);
  int dark = 0;
  for (int x = 0; x < image.cols; ++x) dark += image.at<cv::Vec3b>(0, x)[0] < 128 ? 1 : 0;
  EXPECT_EQ(dark, 1);
}

TEST(GridPage, ShowsAllLayersTheHistoryAndTheParameters) {
  const std::string page = GridPageOf(WithAllLayers(), nullptr, nullptr, "corridor");
  for (const char* part : {"<title>corridor", "1.5 by 1 m in cells of 0.5 m, of 2 scans; 1 scan left out",
                           "Most likely map", "What the data say of each cell", "Convergence", "cut short",
                           "<b>3</b><span>iterations</span>", "model/p_hit", "0.625", "class=\"path r0\""})
    ExpectContains(page, part);
  std::size_t pictures = 0;
  for (std::size_t at = page.find("<image"); at != std::string::npos; at = page.find("<image", at + 1))
    ++pictures;
  EXPECT_EQ(pictures, 5U) << "a layer each, for a wide page and a narrow one, and two of them over the first";
}

TEST(GridPage, OfAPlainMapLeavesOutWhatItLacks) {
  const std::string page = GridPageOf(DrawnMap({"#.", ".."}), nullptr, nullptr, "plain");
  ASSERT_NE(page.find("</html>"), std::string::npos);
  for (const char* absent :
       {"Most likely map", "What the data say", "Convergence", "cut short", "Parameters"})
    EXPECT_EQ(page.find(absent), std::string::npos) << absent;
}

TEST(GridPage, ShowsScoresAndTheTrueWalls) {
  const Blob log = SimulateHallway({.door_readings = 1, .closed = false, .seed = 1});
  Blob map = WithAllLayers();
  GridEvaluation evaluation;
  evaluation.map.cells = CellScore{7, 100, 3, 2, 50, 0};
  evaluation.map.doors = {{true, 0.5, true}};
  const std::string page = GridPageOf(map, &log, &evaluation, "scored");
  for (const char* part : {"false obstacles", "3 of 50", "1 of 1", "class=\"wall\"", "true wall</li>"})
    ExpectContains(page, part);
}

}  // namespace
}  // namespace cairn::datasets::report
