// The pages as a reader meets them: what is written in their HTML, read by nothing of the code that wrote it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <regex>
#include <vector>

#include "datasets/evaluate/testing/grid.h"
#include "datasets/evaluate/testing/perfect_result.h"
#include "datasets/kinds/job_report.h"
#include "datasets/report/drawing/palette.h"
#include "datasets/report/pages/parts.h"
#include "datasets/report/pictures.h"
#include "datasets/simulate/loop.h"
#include "datasets/testing.h"
#include "datasets/verdicts/landmark_map_verdict.h"

namespace cairn::datasets::report {
namespace {

// All first groups of the matches, in order.
std::vector<std::string> Found(const std::string& text, const std::string& pattern) {
  std::vector<std::string> found;
  const std::regex regex(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it)
    found.push_back((*it)[1]);
  return found;
}

std::size_t CountOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size()))
    ++count;
  return count;
}

// What lies between `open` and the next `close`, of each `open`.
std::vector<std::string> Between(const std::string& text, const std::string& open, const std::string& close) {
  std::vector<std::string> parts;
  for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at + 1)) {
    const std::size_t end = text.find(close, at);
    parts.push_back(text.substr(at + open.size(), end - at - open.size()));
  }
  return parts;
}

double WidthOf(const std::string& svg) {
  return std::strtod(Found(svg, "viewBox=\"0 0 ([0-9.]+) ")[0].c_str(), nullptr);
}

struct PixelPoint {
  double x, y;
};
std::vector<PixelPoint> PointsOf(const std::string& list) {
  std::vector<PixelPoint> points;
  const std::regex pair("(-?[0-9.]+),(-?[0-9.]+)");
  for (std::sregex_iterator it(list.begin(), list.end(), pair), end; it != end; ++it)
    points.push_back({std::stod((*it)[1]), std::stod((*it)[2])});
  return points;
}

// The longest stroke of all polylines of the class.
double LongestStroke(const std::string& svg, const std::string& style_class) {
  double longest = 0;
  for (const std::string& line : Between(svg, "<polyline class=\"" + style_class, "/>")) {
    const auto points = PointsOf(Between(line, "points=\"", "\"").at(0));
    for (std::size_t i = 1; i < points.size(); ++i)
      longest = std::max(longest, std::hypot(points[i].x - points[i - 1].x, points[i].y - points[i - 1].y));
  }
  return longest;
}

// A perfect map of a loop, with what a real one has besides.
Blob MapOf(const Blob& log) {
  Blob map = PerfectLandmarkMap(log);
  const std::int64_t landmarks = map.at("map/landmark_x_m").size();
  map.Put("map/landmark_covariance_m2",
          Array::Of<double>({landmarks, 2, 2}, std::vector<double>(4 * landmarks, 0.0)));
  map.PutVector("history/log_likelihood", std::vector<double>{0, -1010, -1002, -1000});
  map.PutVector("history/prefix", std::vector<double>{1, 1, 1, 1});
  map.PutVector("history/robots", std::vector<std::int64_t>{1, 1, 1, 1});
  map.PutScalar<std::int32_t>("search/support", 6);
  map.PutScalar<std::int32_t>("search/starts", 12);
  map.PutScalar("search/lead_nats", 57.2);
  map.Put("provenance/stage", Array::Text("landmarks"));
  map.Put(
      "provenance/job_yaml",
      Array::Text(
          "name: \"night <run>\"\nseed: 7\ninputs:\n  log: \"/data/logs/victoria-park.h5\"  # content 00\n"
          "stages:\n  - name: \"landmarks\"\n    pipeline: \"landmark_map\"\n    log: \"log\"\n"));
  return map;
}

class Page : public ::testing::Test {
 protected:
  std::string HtmlOf(const Blob& map) const {
    const Evaluation evaluation = Evaluate(map, log_);
    return JobReportHtml({{.name = "landmarks", .result = &map, .source = &log_, .evaluated = evaluation}});
  }

  Blob log_ = SimulateLoop({.difficulty = "paper", .robots = 1, .seed = 4});
  const Blob map_ = MapOf(log_);
  const std::string html_ = HtmlOf(map_);
};

TEST_F(Page, AMapMarksWhatMovedAndHasOdometryForWhoAsksForIt) {
  Blob map = map_;
  std::vector<std::int32_t> identity(static_cast<std::size_t>(map.at("map/landmark_x_m").size()), -1);
  identity[1] = 0;
  map.PutVector("map/landmark_identity", identity);
  map.Put("landmarks", Array::Texts({"door"}));
  map.PutVector<std::int32_t>("moved/landmark", {0});
  map.PutVector<double>("moved/until_s", {298.5});
  map.PutVector<double>("moved/from_s", {310});
  const Picture with_odometry = MapPicture(MakeScene(map, &log_, nullptr), 1000);
  const std::string svg = with_odometry.Svg();
  EXPECT_EQ(Between(svg, "<circle class=\"moved\"", ", was moved between 298.5 s and 310 s</title>").size(),
            1U)
      << svg.substr(0, 3000);
  EXPECT_NE(svg.find("<g class=\"off\" data-layer=\"odometry alone\">"), std::string::npos);
  EXPECT_EQ(with_odometry.Png(1), MapPicture(MakeScene(map, nullptr, nullptr), 1000).Png(1))
      << "what nobody has asked for is in no file";
}

// Of the style rules that set the size of text in drawings.
double SmallestLetters(const std::string& html) {
  const std::string style = Between(html, "<style>", "</style>").at(0);
  double smallest = 100;
  for (const char* rule : {"svg text", "\\.tick", "\\.heading", "\\.name"}) {
    const auto sizes = Found(style, std::string(rule) + " \\{[^}]*font-size:([0-9.]+)px");
    EXPECT_FALSE(sizes.empty()) << rule;
    for (const std::string& size : sizes) smallest = std::min(smallest, std::stod(size));
  }
  return smallest;
}

TEST_F(Page, LettersAreLargeEnoughOnAPhoneAndOnADesk) {
  ExpectContains(html_, "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">");
  const std::string style = Between(html_, "<style>", "</style>").at(0);
  const auto limits =
      Found(style, "@media screen and \\(max-width:([0-9]+)px\\) \\{ main \\{ padding:[0-9]+px 12px");
  ASSERT_EQ(limits.size(), 1U);
  const double limit = std::stod(limits[0]);
  EXPECT_EQ(
      Found(style,
            "(max-width:[0-9]+px\\)[^@]*\\.wide \\{ display:none; \\} \\.narrow \\{ display:block; \\})")
          .size(),
      1U);
  const double letters = SmallestLetters(html_);
  const auto wide = Between(html_, "<div class=\"wide\">", "</div>"),
             narrow = Between(html_, "<div class=\"narrow\">", "</div>");
  ASSERT_GE(wide.size(), 3U);
  ASSERT_EQ(wide.size(), narrow.size()) << "each figure is drawn for both";
  for (std::size_t i = 0; i < wide.size(); ++i) {
    EXPECT_GE(letters * (380 - 2 * 12) / WidthOf(narrow[i]), 9.0) << "at 380 pixels";
    EXPECT_GE(letters * std::min(1040.0, limit + 1 - 2 * 32) / WidthOf(wide[i]), 8.5)
        << "just above the limit";
  }
  // No drawing stands outside of the two, but for the marks of legends.
  for (const std::string& svg : Found(html_, "(<svg viewBox=\"0 0 [^\"]*\" role=\"img\"[^>]*>)"))
    EXPECT_TRUE(WidthOf(svg) == kWidePicture || WidthOf(svg) == kNarrowPicture) << svg;
}

TEST_F(Page, ANumberInATableStaysOnOneLineWithItsUnit) {
  ExpectContains(Between(html_, "<style>", "</style>").at(0), "td { white-space:nowrap; }");
  EXPECT_GE(CountOf(html_, "<table>"), 2);
  EXPECT_EQ(CountOf(html_, "<table>"), CountOf(html_, "<div class=\"scroll\"><table>"))
      << "what is then too wide can be scrolled";
}

TEST_F(Page, IsCalledByItsLogAndItsJob) {
  ExpectContains(html_, "<title>victoria-park: night &lt;run&gt;</title>");
  ExpectContains(html_, "<h1>victoria-park: night &lt;run&gt;</h1>");
  const Blob unknown = map_.Without("provenance/");
  ExpectContains(HtmlOf(unknown), "<title>landmarks</title>");
}

// `7` may be a name; a landmark without one is called by what is none.
TEST_F(Page, ALandmarkWithoutANameBearsNoOthersName) {
  Blob map = map_;
  std::vector<std::int32_t> identity(static_cast<std::size_t>(map.at("map/landmark_x_m").size()), -1);
  identity[0] = 0;
  map.Put("landmarks", Array::Texts({"1"}));
  map.PutVector("map/landmark_identity", identity);
  const std::string html = HtmlOf(map);
  const auto count = [&](const char* name) {
    return Found(html, std::string("landmark (") + name + ") at [(]").size();
  };
  EXPECT_GT(count("1"), 0U);
  EXPECT_EQ(count("#1"), count("1"));
}

TEST_F(Page, SaysHowSureTheMapIsInTheWordsOfTheSummary) {
  const auto said = Between(html_, "<p class=\"verdict\">", "</p>");
  ASSERT_EQ(said.size(), 1U);
  ExpectContains(said[0], "</b>: " + LandmarkMapVerdict(map_).why);
  EXPECT_EQ(html_.find("corrected"), std::string::npos)
      << "nothing says that the map is better than odometry";
}

// The first iteration had no map; its 0 is no likelihood that the others' compare with.
TEST_F(Page, TheFirstIterationDoesNotCrushTheCurve) {
  const std::string svg =
      Between(Between(html_, "<h2>Convergence</h2>", "</section>").at(0), "<svg", "</svg>").at(0);
  std::vector<double> heights;
  for (const std::string& y : Found(svg, "<circle class=\"point[^>]*cy=\"([0-9.]+)\""))
    heights.push_back(std::stod(y));
  ASSERT_EQ(heights.size(), 3U);
  EXPECT_GT(*std::ranges::max_element(heights) - *std::ranges::min_element(heights), 150);
  EXPECT_EQ(svg.find("iteration 0:"), std::string::npos);
}

// Half a minute in which the receiver saw nothing is no straight drive.
TEST_F(Page, ATruePathIsNotDrawnWhereItIsNotKnown) {
  const std::string whole = Between(html_, "<h2>Map</h2>", "</section>").at(0);
  const double usual = LongestStroke(whole, "truth-path");
  ASSERT_GT(usual, 0);
  const std::string prefix = "truth/robot/0/poses/";
  const auto time = log_.Get<double>(prefix + "time_s");
  const double from = time[time.size() / 3], until = time[time.size() / 2];
  for (const char* column : {"x_m", "y_m", "heading_rad", "time_s"}) {
    const auto values = log_.Get<double>(prefix + column);
    std::vector<double> kept;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (time[i] <= from || time[i] >= until) kept.push_back(values[i]);
    }
    log_.PutVector(prefix + column, kept);
  }
  const std::string cut = Between(HtmlOf(map_), "<h2>Map</h2>", "</section>").at(0);
  EXPECT_LE(LongestStroke(cut, "truth-path"), usual + 0.2);
  EXPECT_EQ(CountOf(cut, "<polyline class=\"truth-path"), CountOf(whole, "<polyline class=\"truth-path") + 2)
      << "one more stretch on each drawing";
  ExpectContains(cut, "true path, where it is known");
  EXPECT_EQ(whole.find("where it is known"), std::string::npos);
}

TEST(Breaks, AreWherePosesAreFartherApartThanUsual) {
  EXPECT_TRUE(BreaksOf({}).empty());
  EXPECT_TRUE(BreaksOf(std::vector<double>{0, 10, 20, 31, 40}).empty()) << "one every ten seconds";
  EXPECT_EQ(BreaksOf(std::vector<double>{0, 0.2, 0.4, 1.3, 1.5, 9, 9.2}), (std::vector<std::size_t>{5}));
  const Path path{.robot = "", .index = 0, .points = {{0, 0}, {1, 0}, {2, 0}, {9, 0}}, .breaks = {2, 3}};
  const auto pieces = Pieces(path);
  ASSERT_EQ(pieces.size(), 3U);
  EXPECT_EQ(pieces[0].points.size(), 2U);
  EXPECT_EQ(pieces[2].points.front().x_m, 9);
}

// `count` landmarks, eight of a row at a distance; with names they are identities.
Scene Crowd(int count, double apart_m, bool identified) {
  Scene scene;
  for (int k = 0; k < count; ++k) {
    MapLandmark landmark;
    const int row = k / 8;
    landmark.at = {apart_m * (k % 8), apart_m * row};
    landmark.count = k;
    landmark.name = (identified ? "tree " : "") + std::to_string(k);
    landmark.identified = identified;
    scene.landmarks.push_back(landmark);
  }
  scene.landmarks.push_back(scene.landmarks.front());
  scene.landmarks.back().at = {100, 60};
  return scene;
}

struct Rectangle {
  double left, right, top, bottom;
  bool Meets(const Rectangle& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
};

// As a browser sets them: 11.5 pixels, a letter some 6.4 wide and 8.5 high.
std::vector<Rectangle> NamesOn(const std::string& svg) {
  std::vector<Rectangle> names;
  const std::regex name("<text class=\"name\" x=\"([0-9.]+)\" y=\"([0-9.]+)\">([^<]*)<");
  for (std::sregex_iterator it(svg.begin(), svg.end(), name), end; it != end; ++it) {
    const double x = std::stod((*it)[1]), y = std::stod((*it)[2]);
    names.push_back({x, x + 6.4 * static_cast<double>((*it)[3].length()), y - 8.5, y});
  }
  return names;
}

TEST(Names, CoverNeitherEachOtherNorALandmark) {
  for (const double width : {1040.0, 400.0}) {
    for (const double apart_m : {1.0, 3.0, 8.0}) {
      const std::string svg = MapPicture(Crowd(48, apart_m, true), width).Svg();
      const std::vector<Rectangle> names = NamesOn(svg);
      ASSERT_FALSE(names.empty());
      std::vector<Rectangle> dots;
      const std::regex dot("<circle class=\"landmark\" cx=\"([0-9.]+)\" cy=\"([0-9.]+)\"");
      for (std::sregex_iterator it(svg.begin(), svg.end(), dot), end; it != end; ++it) {
        const double x = std::stod((*it)[1]), y = std::stod((*it)[2]);
        dots.push_back({x - 3, x + 3, y - 3, y + 3});
      }
      ASSERT_EQ(dots.size(), 49U);
      for (std::size_t i = 0; i < names.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(names[i].Meets(names[k])) << i << " and " << k;
        for (const Rectangle& at : dots) EXPECT_FALSE(names[i].Meets(at)) << i;
        EXPECT_LE(names[i].right, width);
      }
    }
  }
}

TEST(Names, WhereThereIsRoomAllAreThere) {
  EXPECT_EQ(NamesOn(MapPicture(Crowd(8, 12, true), 1040).Svg()).size(), 9U);
}

TEST(Names, OfHundredsThatAreMereNumbersNoneIs) {
  EXPECT_TRUE(NamesOn(MapPicture(Crowd(475, 3, false), 1040).Svg()).empty());
  EXPECT_FALSE(NamesOn(MapPicture(Crowd(40, 3, false), 1040).Svg()).empty());
  EXPECT_FALSE(NamesOn(MapPicture(Crowd(475, 3, true), 1040).Svg()).empty()) << "identities are worth naming";
}

// Relative luminance as the eye has it, of sRGB channels taken as they are.
double Lightness(Rgb colour) { return 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2]; }

TEST(Scale, FallsWithProbabilityAndHasAColourOfItsOwnForTheUnknown) {
  double before = 256, five_before = 256;
  for (int percent = 0; percent <= 100; ++percent) {
    const Rgb colour = OfProbability(percent / 100.0);
    EXPECT_LE(Lightness(colour), before) << percent;
    before = Lightness(colour);
    if (percent % 5 == 0) {
      EXPECT_LT(before, five_before) << percent;
      five_before = before;
    }
    if (percent <= 50) {
      EXPECT_GT(Lightness(colour), Lightness(kUnknown)) << percent << "% is darker than what is unknown";
    }
    int apart = 0;
    for (std::size_t c = 0; c < 3; ++c) apart = std::max(apart, std::abs(colour[c] - kUnknown[c]));
    EXPECT_GE(apart, 15) << percent << "% looks as the unknown does";
  }
  EXPECT_EQ(OfProbability(0), kPaper);
  EXPECT_EQ(OfProbability(1), kBlack);
  EXPECT_EQ(OfProbability(NAN), kUnknown);
}

Blob GridOf(const char* stage) {
  Blob map = DrawnMap({"#. ", ".. "}, 0.5);
  map.Put("provenance/stage", Array::Text(stage));
  map.PutVector<double>("history/log_likelihood", {-9, -5, -4});
  return map;
}

TEST_F(Page, OfAChainShowsEveryStage) {
  const Blob raw = GridOf("raw"), forward = GridOf("forward");
  const std::string html = JobReportHtml({{.name = "landmarks", .result = &map_},
                                          {.name = "raw <1>", .result = &raw},
                                          {.name = "forward", .result = &forward}});
  const auto links = Found(html, "<a href=\"#([a-z0-9-]+)\">");
  ASSERT_EQ(links.size(), 3U);
  for (const std::string& link : links) EXPECT_EQ(CountOf(html, "id=\"" + link + "\""), 1U) << link;
  const auto stages = Between(html, "<article", "</article>");
  ASSERT_EQ(stages.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) ExpectContains(stages[i], "<h2>Map</h2>");
  ExpectContains(stages[1], "raw &lt;1&gt; <small>grid_map</small>");
  ExpectContains(stages[0], "class=\"verdict\"");
  // Each clip path is of a rectangle: one that is named twice is the same twice.
  const std::regex clip("<clipPath id=\"([^\"]+)\">(<rect[^>]*>)");
  std::map<std::string, std::string> rectangles;
  for (std::sregex_iterator it(html.begin(), html.end(), clip), end; it != end; ++it) {
    const auto [known, fresh] = rectangles.emplace((*it)[1], (*it)[2]);
    EXPECT_EQ(known->second, (*it)[2]);
  }
  EXPECT_GT(rectangles.size(), 2U);
}

// The empty map's likelihood, with which a search begins, would make a line of all that comes after it.
TEST(GridPage, TheEmptyMapDoesNotCrushTheCurve) {
  Blob map = GridOf("forward");
  map.PutVector<double>("history/log_likelihood", {-1083597, 99175, 112282, 112416, 115255});
  map.PutVector<std::int64_t>("history/occupied", {0, 10, 12, 12, 12});
  const std::string html = JobReportHtml({{.name = "forward", .result = &map}});
  const std::string section = Between(html, "<h2>Convergence</h2>", "</section>").at(0);
  const std::string line = Found(section, "<polyline class=\"path r0\" points=\"([^\"]*)\"").at(0);
  std::vector<double> heights;
  for (const PixelPoint& point : PointsOf(line)) heights.push_back(point.y);
  ASSERT_EQ(heights.size(), 4U);
  EXPECT_GT(heights[0] - heights[1], 100) << "from the first map to the second";
  ExpectContains(section, "−1,083,597");
}

TEST(GridPage, OfAWorldThatStandsStillSaysSo) {
  Blob map = GridOf("forward");
  map.Put("map/grid/dynamic", Array::Of<std::uint8_t>({2, 3}, std::vector<std::uint8_t>(6, 0)));
  const auto html = [&] { return JobReportHtml({{.name = "forward", .result = &map}}); };
  const std::string section = "<h2>Readings that the map does not explain</h2>";
  const std::string still = Between(html(), section, "</section>").at(0);
  EXPECT_EQ(still.find("<image"), std::string::npos);
  ExpectContains(still, "Nothing");
  map.Put("map/grid/dynamic", Array::Of<std::uint8_t>({2, 3}, std::vector<std::uint8_t>{1, 1, 0, 2, 0, 0}));
  const std::string some = Between(html(), section, "</section>").at(0);
  ExpectContains(some, "1 cell<");
  ExpectContains(some, "2 cells<");
  EXPECT_EQ(html().find("What moved"), std::string::npos) << "a reading that is wrong is nothing that moved";
}

TEST(StagePicture, IsThereForEveryKindThatHasAPage) {
  const Blob grid = GridOf("raw");
  EXPECT_EQ(StagePicturePng({.name = "raw", .result = &grid}, 600).substr(1, 3), "PNG");
  Blob samples;
  samples.Put("runs", Array::Texts({"monday"}));
  samples.Put("input_name", Array::Texts({"left", "right"}));
  samples.PutVector<double>("run/0/x_m", {0, 1, 2});
  samples.PutVector<double>("run/0/y_m", {0, 0, 1});
  samples.Put("run/0/input", Array::Of<float>({3, 2}, std::vector<float>{0, 1, 2, 3, 4, NAN}));
  EXPECT_EQ(StagePicturePng({.name = "made", .result = &samples}, 600).substr(1, 3), "PNG");
  ExpectContains(JobReportHtml({{.name = "made", .result = &samples}}), "3 samples in 1 run, of 2 inputs");
  Blob other;
  other.PutScalar("number", 1.0);
  ExpectContains(InputErrorOf([&] { StagePicturePng({.name = "odd", .result = &other}); }),
                 "neither page nor picture of a result");
  ExpectContains(InputErrorOf([&] { JobReportHtml({{.name = "odd", .result = &other}}); }),
                 "neither page nor picture of a result");
}

}  // namespace
}  // namespace cairn::datasets::report
