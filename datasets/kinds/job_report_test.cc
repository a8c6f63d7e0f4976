#include "datasets/kinds/job_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "datasets/evaluate/testing/perfect_result.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/drawing/picture.h"
#include "datasets/report/pages/pages.h"
#include "datasets/report/pictures.h"
#include "datasets/report/scene.h"
#include "datasets/simulate/loop.h"
#include "datasets/testing.h"
#include "schema/kinds/kind.h"

namespace cairn::datasets::report {
namespace {

std::size_t CountIn(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size()))
    ++count;
  return count;
}

// The first tag that is not closed in order, or empty.
std::string FirstUnbalancedTag(const std::string& html) {
  const std::set<std::string> empty = {"meta", "!doctype", "img"};
  std::vector<std::string> open;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
    const std::size_t end = html.find('>', at);
    if (end == std::string::npos) return html.substr(at, 40);
    const bool closing = html[at + 1] == '/', self = html[end - 1] == '/';
    const std::size_t first = at + (closing ? 2 : 1);
    const std::string name = html.substr(first, html.find_first_of(" >/\n", first) - first);
    if (closing) {
      if (open.empty() || open.back() != name) return "</" + name + ">";
      open.pop_back();
    } else if (name == "script") {
      at = html.find("</script>", at);  // what is in it is no HTML
      if (at == std::string::npos) return "<script>";
    } else if (!self && !empty.contains(name)) {
      open.push_back(name);
    }
  }
  return open.empty() ? "" : "<" + open.back() + ">";
}

// A perfect result with all that a real one has besides.
Blob FullResult(const Blob& log) {
  Blob result = PerfectLandmarkMap(log);
  const std::int64_t landmarks = result.at("map/landmark_x_m").size();
  std::vector<double> covariance;
  for (std::int64_t k = 0; k < landmarks; ++k) covariance.insert(covariance.end(), {0.5, 0.1, 0.1, 0.2});
  result.Put("map/landmark_covariance_m2", Array::Of<double>({landmarks, 2, 2}, covariance));
  std::vector<double> cells(2 * 90 * 100, 0.0);
  cells[45 * 100 + 50] = 0.3;
  cells[90 * 100 + 45 * 100 + 50] = 0.9;
  result.Put("map/grid/probability", Array::Of<double>({2, 90, 100}, cells));
  result.PutScalar("map/grid/origin_x_m", 0.0);
  result.PutScalar("map/grid/origin_y_m", 0.0);
  result.PutScalar("map/grid/cell_m", 1.0);
  result.PutVector("history/log_likelihood", std::vector<double>{0, -300, -200, -150});
  result.PutVector("history/prefix", std::vector<double>{1, 0.5, 1, 1});
  result.PutVector("history/robots", std::vector<std::int64_t>{1, 2, 2, 2});
  result.PutVector("history/landmark_iteration", std::vector<std::int64_t>{0, 0, 2, 2, 2});
  result.PutVector("history/landmark_x_m", std::vector<double>{1, 2, 3, 4, 5});
  result.PutVector("history/landmark_y_m", std::vector<double>{5, 4, 3, 2, 1});
  result.PutScalar("provenance/seconds_s", 83.0);
  result.PutScalar<std::int64_t>("provenance/workers", 3);
  result.Put("provenance/version", Array::Text("1.2.3"));
  result.Put("provenance/job_yaml", Array::Text("name: a <b> & \"c\"\n"));
  result.Put("provenance/round/note", Array::Texts({"start", "iteration 1"}));
  result.PutVector("provenance/round/tasks", std::vector<std::int64_t>{1, 8});
  result.PutVector("provenance/round/seconds_s", std::vector<double>{0.5, 2});
  result.PutVector("provenance/round/compute_s", std::vector<double>{0.5, 5});
  return result;
}

std::string PageOf(const Blob& result, const Blob* log, const Evaluation* evaluation,
                   const std::string& title = "") {
  return JobReportHtml(
      {{.name = "map",
        .result = &result,
        .source = log,
        .evaluated = evaluation != nullptr ? std::optional<Evaluated>(*evaluation) : std::nullopt}},
      title);
}

class ReportOfALoop : public ::testing::Test {
 protected:
  const Blob log_ = SimulateLoop({.difficulty = "paper", .robots = 2, .seed = 4});
  const Blob result_ = FullResult(log_);
  const Evaluation evaluation_ = Evaluate(result_, log_);
};

TEST_F(ReportOfALoop, IsOneBalancedPageThatLoadsNothing) {
  const std::string html = PageOf(result_, &log_, &evaluation_, "Loop <4>");
  EXPECT_EQ(FirstUnbalancedTag(html), "");
  ExpectContains(html, "<title>Loop &lt;4&gt;</title>");
  for (const char* outside : {"http:", "https:", "src=", "@import", "<link", "fetch(", "XMLHttpRequest",
                              "import(", "WebSocket", "EventSource", "sendBeacon", "innerHTML", "eval("}) {
    EXPECT_EQ(CountIn(html, outside), 0U) << outside;
  }
  EXPECT_EQ(CountIn(html, "<script"), 1U);
  EXPECT_EQ(CountIn(html, "url("), CountIn(html, "url(#"));
  EXPECT_EQ(CountIn(html, "nan"), 0U);
  EXPECT_EQ(CountIn(html, "=\"inf"), 0U);
}

TEST_F(ReportOfALoop, ShowsEverySection) {
  const std::string html = PageOf(result_, &log_, &evaluation_);
  for (const char* title : {"Map", "Before and after", "Landmark probability", "Convergence", "Time",
                            "Robots", "Landmarks", "Job"}) {
    ExpectContains(html, std::string("<h2>") + title + "</h2>");
  }
  ExpectContains(html, "landmarks found");
  ExpectContains(html, "<b>right</b>");
  ExpectContains(html, "1 min 23 s");
  ExpectContains(html, "name: a &lt;b&gt; &amp; &quot;c&quot;");
  ExpectContains(html, "Cairn 1.2.3 with 3 workers");
  // On both drawings of the map, and in its legend.
  EXPECT_EQ(CountIn(html, "class=\"truth-landmark\""), 2 * evaluation_.pairs.size() + 1);
}

std::size_t NumbersIn(const std::string& text) {
  return text.empty() ? 0 : 1 + static_cast<std::size_t>(std::ranges::count(text, ' '));
}

// Empty: it has none.
std::string AttributeOf(const std::string& element, const std::string& name) {
  const std::string before = " " + name + "=\"";
  const std::size_t at = element.find(before), begin = at + before.size();
  return at == std::string::npos ? "" : element.substr(begin, element.find('"', begin) - begin);
}

// What map_viewer.js needs of a map: its frame in metres, layers, and of each path a time for each point.
TEST_F(ReportOfALoop, OneCanLookAroundInItsMap) {
  const std::string html = PageOf(result_, &log_, &evaluation_);
  const std::size_t map = html.find("data-panel=\"");
  ASSERT_NE(map, std::string::npos);
  EXPECT_EQ(CountIn(html, "data-panel=\""), 1U);
  const std::string svg = html.substr(map, html.find("</svg>", map) - map);
  for (const char* layer : {"true path", "robot 0", "robot 1", "true landmarks", "landmarks", "starts"})
    EXPECT_EQ(CountIn(svg, std::string("data-layer=\"") + layer + "\""), 1U) << layer;
  std::size_t paths = 0;
  const std::string path = "class=\"path r";
  for (std::size_t at = svg.find(path); at != std::string::npos; at = svg.find(path, at + 1)) {
    const std::string element = svg.substr(at, svg.find('>', at) - at);
    const std::size_t times = NumbersIn(AttributeOf(element, "data-time"));
    if (times == 0) continue;
    EXPECT_GT(times, 10U);
    EXPECT_EQ(NumbersIn(AttributeOf(element, "points")), times);
    ++paths;
  }
  EXPECT_EQ(paths, 2U);
  EXPECT_EQ(CountIn(html, "data-time=\""), CountIn(svg, "data-time=\""));
  EXPECT_EQ(CountIn(svg, "data-name=\""), evaluation_.pairs.size());
  const std::size_t rounds = svg.find("data-rounds=\"") + 13;
  const std::string earlier = svg.substr(rounds, svg.find('"', rounds) - rounds);
  EXPECT_EQ(CountIn(earlier, ";"), 1U) << "of the two iterations that made a map";
  EXPECT_EQ(CountIn(earlier, ","), 5U);
}

TEST_F(ReportOfALoop, HasEachPictureOfCellsOnce) {
  const std::string html = PageOf(result_, &log_, &evaluation_);
  EXPECT_EQ(CountIn(html, "<use href=\"#i"), 2U);  // the cells and their key, on the drawing for a phone
  EXPECT_EQ(CountIn(html, "href=\"data:image/png"), 2U);
}

TEST_F(ReportOfALoop, StandsBesideAnother) {
  Blob moved = result_;
  moved.Put("provenance/version", Array::Text("9.8.7"));
  moved.Put("provenance/job_yaml", Array::Text("name: a <b> & \"c\"\nseed: 2\n"));
  const ReportedStage a{.name = "map", .result = &result_, .source = &log_, .evaluated = evaluation_},
      b{.name = "map", .result = &moved, .source = &log_, .evaluated = evaluation_};
  const std::string html = ComparisonHtml({{a, b}}, "one/<1>", "two");
  EXPECT_EQ(FirstUnbalancedTag(html), "");
  ExpectContains(html, "<th>one/&lt;1&gt;</th><th>two</th>");
  ExpectContains(html, "scores the same.");
  ExpectContains(html, "<td>seed: 2</td>");
  ExpectContains(html, "<td>9.8.7</td>");
  EXPECT_EQ(CountIn(html, "name: a &lt;b&gt;"), 0U) << "what the jobs have in common";
  EXPECT_EQ(CountIn(html, "data-panel=\""), 2U);
  Blob grid;
  grid.Put("kind", Array::Text("grid_map"));
  EXPECT_THROW(ComparisonHtml({{a, {.name = "grid", .result = &grid}}}, "a", "b"), InputError);
}

TEST_F(ReportOfALoop, SaysThatARefinementWasRefused) {
  EXPECT_EQ(CountIn(PageOf(result_, &log_, &evaluation_), "refinement"), 0U);
  Blob refused = result_;
  refused.Put("refinement/reason", Array::Text("refused: the least squares has no solution"));
  ExpectContains(
      PageOf(refused, &log_, &evaluation_),
      "; refinement was refused: the least squares has no solution, the landmarks stand where EM left them.");
}

TEST_F(ReportOfALoop, WithoutLogAndTruthLeavesOutWhatItDoesNotKnow) {
  const std::string html = PageOf(result_, nullptr, nullptr);
  EXPECT_EQ(FirstUnbalancedTag(html), "");
  EXPECT_EQ(CountIn(html, "Before and after"), 0U);
  EXPECT_EQ(CountIn(html, "class=\"truth"), 0U);
  EXPECT_EQ(CountIn(html, "topology"), 0U);
  ExpectContains(html, "<h2>Map</h2>");
  const Blob blind = log_.Without("truth/");
  const std::string with_log = PageOf(result_, &blind, nullptr);
  EXPECT_EQ(CountIn(with_log, "class=\"truth"), 0U);
  ExpectContains(with_log, "Before and after");
}

TEST_F(ReportOfALoop, IsTheSameEachTime) {
  EXPECT_EQ(PageOf(result_, &log_, &evaluation_), PageOf(result_, &log_, &evaluation_));
}

TEST_F(ReportOfALoop, RefusesWhatItCannotShow) {
  ExpectContains(
      InputErrorOf([&] { LandmarkMapHtml(result_.Without("map/landmark_x_m"), nullptr, nullptr); }),
      "map/landmark_x_m");
  const Blob other = SimulateLoop({.difficulty = "paper", .robots = 1, .seed = 4});
  ExpectContains(InputErrorOf([&] { PageOf(result_, &other, nullptr); }), "robots");
}

// Dead reckoning of the scene ends where the log's odometry does, the stated error away from the true end.
TEST_F(ReportOfALoop, SceneShowsTheOdometricError) {
  const Scene scene = MakeScene(result_, &log_, &evaluation_);
  ASSERT_EQ(scene.odometry.size(), 2U);
  for (std::size_t r = 0; r < 2; ++r) {
    EXPECT_NEAR(DistanceM(scene.odometry[r].points.back(), scene.paths[r].points.back()),
                FinalOdometricErrorM(log_, static_cast<int>(r)), 1e-6);
    EXPECT_EQ(scene.odometry_marks[r].points.size(),
              log_.Get<double>("robot/" + std::to_string(r) + "/observations/time_s").size());
  }
}

TEST_F(ReportOfALoop, SceneLaysTruthOverAMovedResult) {
  Blob moved = result_;
  const Similarity motion{1, 1.2, -40, 7};
  const auto move = [&](const std::string& x_name, const std::string& y_name) {
    const auto x = moved.Get<double>(x_name), y = moved.Get<double>(y_name);
    std::vector<double> moved_x, moved_y;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Point at = motion(Point{x[i], y[i]});
      moved_x.push_back(at.x_m);
      moved_y.push_back(at.y_m);
    }
    moved.PutVector(x_name, moved_x);
    moved.PutVector(y_name, moved_y);
  };
  move("map/landmark_x_m", "map/landmark_y_m");
  move("robot/0/poses/mode_x_m", "robot/0/poses/mode_y_m");
  move("robot/1/poses/mode_x_m", "robot/1/poses/mode_y_m");
  const Evaluation evaluation = Evaluate(moved, log_);
  const Scene scene = MakeScene(moved, &log_, &evaluation);
  ASSERT_FALSE(scene.error_lines.empty());
  for (const auto& [ours, theirs] : scene.error_lines) EXPECT_LT(DistanceM(ours, theirs), 1e-6);
  for (std::size_t i = 0; i < scene.paths[1].points.size(); ++i) {
    EXPECT_LT(DistanceM(scene.paths[1].points[i], scene.truth_paths[1].points[i]), 1e-6);
  }
}

TEST_F(ReportOfALoop, SceneTakesTheLargestOverTheTypes) {
  const Scene scene = MakeScene(result_, nullptr, nullptr);
  ASSERT_TRUE(scene.grid);
  EXPECT_EQ(scene.grid->probability[45 * 100 + 50], 0.9);
  EXPECT_EQ(HighestProbability(*scene.grid), 0.9);
}

TEST_F(ReportOfALoop, AGridOfNoProbabilitiesIsRefused) {
  for (const double wrong : {HUGE_VAL, -0.1}) {
    Blob blob = result_;
    const auto all = result_.at("map/grid/probability").As<double>();
    std::vector<double> values(all.begin(), all.end());
    values[7] = wrong;
    blob.Put("map/grid/probability", Array::Of<double>(result_.at("map/grid/probability").shape(), values));
    ExpectContains(InputErrorOf([&] { CheckKind(blob, "landmark_map"); }), "where 0 to 1 is needed");
  }
}

TEST_F(ReportOfALoop, APositionThatIsNoPlaceIsRefused) {
  const auto all = result_.at("map/landmark_x_m").As<double>();
  std::vector<double> values(all.begin(), all.end());
  values[0] = 1e200;
  Blob blob = result_;
  blob.PutVector<double>("map/landmark_x_m", values);
  const Scene scene = MakeScene(blob, nullptr, nullptr);
  ExpectContains(InputErrorOf([&] { BoundsOf(scene, false); }), "no place");
}

TEST(Ellipse, OfADiagonalAndATurnedCovariance) {
  const double root = std::sqrt(5.991464547);
  const EllipseM upright = EllipseOf({1, 2}, {1, 0, 0, 4});
  EXPECT_NEAR(upright.major_m, 2 * root, 1e-6);
  EXPECT_NEAR(upright.minor_m, root, 1e-6);
  EXPECT_NEAR(std::abs(upright.angle_rad), 1.5707963, 1e-6);
  // Variance 4 along 45 degrees, 1 across: (4 + 1) / 2 on the diagonal, (4 - 1) / 2 beside it.
  const EllipseM turned = EllipseOf({0, 0}, {2.5, 1.5, 1.5, 2.5});
  EXPECT_NEAR(turned.major_m, 2 * root, 1e-6);
  EXPECT_NEAR(turned.angle_rad, 0.78539816, 1e-6);
}

TEST(MapFrame, KeepsOneScaleAndCentres) {
  const MapFrame frame(Box{0, 10, 0, 10}, {100, 50, 400, 200});
  EXPECT_DOUBLE_EQ(frame.pixels_per_m(), 20);
  EXPECT_DOUBLE_EQ(frame.X(5), 300);  // the middle of the panel
  EXPECT_DOUBLE_EQ(frame.Y(5), 150);
  EXPECT_DOUBLE_EQ(frame.Y(10), 50);  // north is up
  EXPECT_DOUBLE_EQ(frame.X(6) - frame.X(5), 20);
}

TEST(Ticks, AreRound) {
  EXPECT_EQ(Ticks(-12, 25, 5), (std::vector<double>{-10, 0, 10, 20}));
  EXPECT_EQ(Ticks(0, 1, 5).size(), 6U);
  EXPECT_TRUE(Ticks(1, 1, 5).empty());
  for (const double span : {0.013, 0.7, 3.0, 42.0, 999.0, 12345.0}) {
    const auto ticks = Ticks(-span / 3, span, 6);
    EXPECT_GE(ticks.size(), 3U) << span;
    EXPECT_LE(ticks.size(), 10U) << span;
  }
  EXPECT_DOUBLE_EQ(RoundBelow(17), 10);
  EXPECT_DOUBLE_EQ(RoundBelow(0.5), 0.5);
  EXPECT_DOUBLE_EQ(RoundBelow(49), 20);
}

TEST(Format, ReadsWell) {
  EXPECT_EQ(Short(12.50), "12.5");
  EXPECT_EQ(Short(-0.001), "0");
  EXPECT_EQ(Short(100), "100");
  EXPECT_EQ(Grouped(1006.46, 1), "1,006.5");
  EXPECT_EQ(Grouped(-1234567), "−1,234,567");
  EXPECT_EQ(Grouped(NAN), "–");
  EXPECT_EQ(Duration(0.4249), "0.42 s");
  EXPECT_EQ(Duration(59.96), "1 min 00 s");
  EXPECT_EQ(Duration(7860), "2 h 11 min");
  EXPECT_EQ(Count(1, "landmark"), "1 landmark");
  EXPECT_EQ(Count(2000, "landmark"), "2,000 landmarks");
  EXPECT_EQ(Escape("<a href='x'>&\"</a>"), "&lt;a href=&#39;x&#39;&gt;&amp;&quot;&lt;/a&gt;");
}

// RFC 4648, section 10.
TEST(Base64, GivesTheStandardsAnswers) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
}

TEST(Figures, AreEmptyWhereThereIsNothingToDraw) {
  EXPECT_EQ(LikelihoodPicture({}, 1000).Svg(), "");
  EXPECT_EQ(LikelihoodPicture({{0, 1, 1}}, 1000).Svg(), "") << "there was no map";
  EXPECT_EQ(LikelihoodPicture({{0, 1, 1}, {NAN, 1, 1}}, 1000).Svg(), "");
  EXPECT_EQ(RoundsPicture({}, 1000).Svg(), "");
  EXPECT_EQ(GridPicture({}, 1000).Svg(), "");
  EXPECT_EQ(BeforeAfterPicture({}, 1000).Svg(), "");
  EXPECT_EQ(FirstUnbalancedTag(MapPicture({}, 1000).Svg()), "");
}

// Four iterations: the first had no map, the second half the data; a line joins the last two alone.
TEST(LikelihoodPicture, JoinsOnlyWhatCompares) {
  const std::string svg = LikelihoodPicture({{0, 1, 1}, {-9, 0.5, 1}, {-8, 1, 1}, {-7, 1, 1}}, 1000).Svg();
  EXPECT_EQ(CountIn(svg, "class=\"curve\""), 1U);
  EXPECT_EQ(CountIn(svg, "class=\"point part\""), 1U);
  EXPECT_EQ(CountIn(svg, "class=\"point\""), 2U);
}

}  // namespace
}  // namespace cairn::datasets::report
