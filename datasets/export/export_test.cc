#include "datasets/export/export.h"

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "datasets/common/png.h"
#include "datasets/export/parts.h"
#include "datasets/testing.h"
#include "datasets/testing_result.h"
#include "schema/kinds/kind.h"
#include "schema/store/blob_file.h"

namespace cairn::datasets {
namespace {

std::vector<std::string> LinesOf(const std::string& path) {
  std::istringstream stream(FileText(path));
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<double> Numbers(const std::string& line, const std::string& tag) {
  EXPECT_TRUE(line.starts_with(tag)) << line;
  std::istringstream stream(line.substr(tag.size()));
  std::vector<double> numbers;
  for (double number = 0; stream >> number;) numbers.push_back(number);
  return numbers;
}

void ExpectNear(const std::vector<double>& actual, const std::vector<double>& expected,
                double tolerance = 1e-6) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) EXPECT_NEAR(actual[i], expected[i], tolerance) << i;
}

TEST(ExportTum, WritesTheMostLikelyPosesOfEachRobot) {
  const TestFolder folder;
  const auto files = ExportTum(SmallResult(), folder / "new/tum").value();
  EXPECT_EQ(files, (std::vector<std::string>{folder / "new/tum/Rosa.tum", folder / "new/tum/a_b.tum"}));
  const auto lines = LinesOf(files[0]);
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0], "# time x y z qx qy qz qw");
  EXPECT_EQ(lines[1], "1 0 0 0 0 0 0 1");
  ExpectNear(Numbers(lines[2], ""), {2, 1, 0, 0, 0, 0, std::sqrt(0.5), std::sqrt(0.5)}, 1e-12);
}

TEST(ExportTum, EachRobotHasAFileOfItsOwnWhateverItsName) {
  const TestFolder folder;
  Blob result = SmallResult();
  result.Put("robots", Array::Texts({"a_b_1", "A b"}));
  EXPECT_EQ(ExportTum(result, folder / "case").value(),
            (std::vector<std::string>{folder / "case/a_b_1.tum", folder / "case/A_b.tum"}));
  result.Put("robots", Array::Texts({"a_b", "A b"}));
  EXPECT_EQ(ExportTum(result, folder / "alike").value(),
            (std::vector<std::string>{folder / "alike/a_b.tum", folder / "alike/A_b_1.tum"}));
  Blob three = result;
  for (const auto& [name, array] : result.fields())
    if (name.starts_with("robot/1/")) three.Put("robot/2/" + name.substr(8), array);
  three.Put("robots", Array::Texts({"a_b_2", "a b", "a.b"}));
  EXPECT_EQ(ExportTum(three, folder / "three").value(),
            (std::vector<std::string>{folder / "three/a_b_2.tum", folder / "three/a_b.tum",
                                      folder / "three/a_b_2_2.tum"}));
}

TEST(ExportTum, ALongNameIsCutToWhatAFileMayBeCalled) {
  const TestFolder folder;
  Blob result = SmallResult();
  result.Put("robots", Array::Texts({std::string(256, 'a'), std::string(255, 'a')}));
  const std::vector<std::string> files = ExportTum(result, folder / "long").value();
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(files[0], folder / ("long/" + std::string(200, 'a') + ".tum"));
  EXPECT_EQ(files[1], folder / ("long/" + std::string(200, 'a') + "_1.tum"));
}

TEST(Export, LeavesFilesAloneThatAreThereUnlessToldToReplaceThem) {
  const TestFolder folder;
  const std::string file = ExportCsv(SmallLog(), folder / "csv").value().at(0);
  const auto before = LinesOf(file);
  const auto rest = LinesOf(folder / "csv/observations.csv");
  std::filesystem::remove(folder / "csv/observations.csv");
  // As one that was cut off leaves it: it is gone on with.
  EXPECT_EQ(ExportCsv(SmallLog(), folder / "csv", false).value().size(), 2U);
  EXPECT_EQ(LinesOf(folder / "csv/observations.csv"), rest);
  std::filesystem::remove(folder / "csv/observations.csv");
  std::ofstream(file, std::ios::app) << "x";
  ExpectContains(InputErrorOf([&] { (void)ExportCsv(SmallLog(), folder / "csv", false); }),
                 "odometry.csv' is there already");
  EXPECT_FALSE(std::filesystem::exists(folder / "csv/observations.csv")) << "all or nothing";
  EXPECT_TRUE(ExportCsv(SmallLog(), folder / "csv", true).ok());
  EXPECT_EQ(LinesOf(file), before);
}

// Two of a name stand for one that came to be there after it was looked for.
// It may be what is exported, whatever it is called.
TEST(Export, NotEvenByForceDoesItReplaceAFileOfCairns) {
  const TestFolder folder;
  ASSERT_TRUE(WriteBlobFile(folder / "Rosa.tum", "landmark_map", SmallResult()).ok());
  const std::string before = FileText(folder / "Rosa.tum");
  ExpectContains(InputErrorOf([&] { (void)ExportTum(SmallResult(), folder / "", true); }), "of Cairn's own");
  EXPECT_EQ(FileText(folder / "Rosa.tum"), before);
}

TEST(Export, WhatComesToBeThereMeanwhileStays) {
  const TestFolder folder;
  for (const bool replace : {false, true}) {
    FolderWriter writer(folder / "same", replace);
    writer.Write(replace ? "b" : "a", "one");
    writer.Write(replace ? "b" : "a", "two");
    if (replace)
      EXPECT_TRUE(writer.Finish().ok());
    else
      ExpectContains(InputErrorOf([&] { (void)writer.Finish(); }), "a' is there already");
  }
  EXPECT_EQ(FileText(folder / "same/a"), "one");
  EXPECT_EQ(FileText(folder / "same/b"), "two");
}

// By a failure in their middle, as by a kill.
TEST(Export, FilesOfTwoExportsNeverLieTogether) {
  const TestFolder folder;
  for (const char* text : {"old", "new"}) {
    FolderWriter writer(folder / "map", true);
    for (const char* name : {"image", "picture", "names_them", "same"})
      writer.Write(name, std::string(name) == "same" ? "same" : text);
    if (std::string(text) == "new") {
      std::filesystem::remove(folder / "map/picture");
      std::filesystem::create_directory(folder / "map/picture");  // no file takes its place
      EXPECT_FALSE(writer.Finish().ok());
    } else {
      EXPECT_TRUE(writer.Finish().ok());
    }
  }
  EXPECT_EQ(FileText(folder / "map/image"), "new");
  EXPECT_EQ(FileText(folder / "map/same"), "same");
  EXPECT_FALSE(std::filesystem::exists(folder / "map/names_them"));
}

TEST(Export, WhatOneThatWasKilledLeftGoesWithTheNext) {
  const TestFolder folder;
  const std::string left = folder / "x/.cairn-map.mcap.999999999-0.tmp",
                    others = folder / "x/.cairn-a.999999999-0.tmp";
  std::filesystem::create_directory(folder / "x");
  for (const std::string& path : {left, others}) std::ofstream(path) << "half";
  FolderWriter writer(folder / "x", false);
  writer.Write("map.mcap", "whole");
  EXPECT_TRUE(writer.Finish().ok());
  EXPECT_FALSE(std::filesystem::exists(left));
  EXPECT_TRUE(std::filesystem::exists(others));
}

TEST(ExportTum, SaysWhereThereAreNoPoses) {
  const TestFolder folder;
  ExpectContains(InputErrorOf([&] { (void)ExportTum(SmallLog(), folder / "x"); }),
                 "there are no poses in it");
  EXPECT_FALSE(std::filesystem::exists(folder / "x"));
}

TEST(Export, WhatIsNoNumberIsRefusedByName) {
  for (const char* name : {"robot/0/poses/mode_x_m", "robot/0/poses/covariance", "map/landmark_y_m"}) {
    Blob result = SmallResult();
    const auto values = result.Get<double>(name);
    std::vector<double> bad(values.begin(), values.end());
    bad[1] = std::nan("");
    result.Put(name, Array::Of<double>(result.at(name).shape(), bad));
    ExpectContains(InputErrorOf([&] { CheckKind(result, "landmark_map"); }),
                   std::string("'") + name + "', entry 1: nan");
  }
}

constexpr double kSlip_m = 1e-4;  // what odometry errs by whatever the motion

// In odometry's metre.
Blob ScaledResult() {
  Blob result = SmallResult();
  result.PutScalar<double>("robot/0/distance_scale", 1);
  result.PutScalar<double>("robot/1/distance_scale", 1);
  return result;
}

TEST(ExportG2o, WritesVerticesAndWhatTheLogSaysOfThem) {
  const TestFolder folder;
  const Blob log = SmallLog();
  const auto lines = LinesOf(ExportG2o(ScaledResult(), &log, folder / "").value().at(0));
  ASSERT_EQ(lines.size(), 6U + 2 + 1 + 4 + 2);
  ExpectNear(Numbers(lines[1], "VERTEX_SE2 "), {1, 1, 0, M_PI / 2});
  EXPECT_EQ(lines[6], "VERTEX_XY 6 2 0");
  EXPECT_EQ(lines.back(), "FIX 0") << "GTSAM reads nothing behind it";
  // First the turn of 0.1, then 1 m: whatever the vertices say.
  const auto motion = Numbers(lines[8], "EDGE_SE2 ");
  ExpectNear({motion.begin(), motion.begin() + 5}, {0, 1, std::cos(0.1), std::sin(0.1), 0.1});
  // Along the way it errs by 2% of its metre's root alone, and by what a turn shifts it.
  EXPECT_NEAR(motion[5], 1 / (0.02 * 0.02 + 0.005 * 0.005 * 0.1 + kSlip_m * kSlip_m), 1e-6);
  // Range 2 m (sd 0.1) at 0.5 rad (sd 0.05, so 0.1 m across): a round ellipse. The landmark lies at (2,
  // 0), 9.9 standard deviations off, of which Cauchy's tails make a weight.
  const double squares = 8 * (1 - std::cos(0.5)) / 0.01, information = 100 / (1 + squares / 9);
  ExpectNear(Numbers(lines[12], "EDGE_SE2_XY "),
             {0, 6, 2 * std::cos(0.5), 2 * std::sin(0.5), information, 0, information});
  // A contact detection where the vertex is the landmark's place (sd 0.3).
  ExpectNear(Numbers(lines[13], "EDGE_SE2_XY "), {2, 7, 0, 0, 1 / 0.09, 0, 1 / 0.09});
}

TEST(ExportG2o, WithoutTheLogEdgesAreTheResultsOwnMotions) {
  const TestFolder folder;
  const auto lines = LinesOf(ExportG2o(SmallResult(), nullptr, folder / "").value().at(0));
  ASSERT_EQ(lines.size(), 6U + 2 + 1 + 4);
  // Mean of 0 and 0.04, plus the least variance.
  const double information = 1 / (0.02 + 1e-6);
  ExpectNear(Numbers(lines[8], "EDGE_SE2 "),
             {0, 1, 1, 0, M_PI / 2, information, 0, 0, information, 0, information}, 1e-6);
  // From (1, 0), heading up, to (1, 2): 2 m ahead.
  const auto ahead = Numbers(lines[9], "EDGE_SE2 ");
  ExpectNear({ahead.begin(), ahead.begin() + 5}, {1, 2, 2, 0, 3 - M_PI / 2});
}

TEST(ExportG2o, TakesOffWhatTheResultFoundThatOdometryErrsBy) {
  const TestFolder folder;
  const Blob log = SmallLog();
  Blob result = ScaledResult();
  result.PutScalar<double>("robot/0/heading_drift_rad_per_m", 0.2);
  result.PutScalar<double>("robot/0/distance_scale", 1.5);
  result.PutScalar<double>("robot/0/turn_scale", 3);
  result.PutScalar<double>("robot/0/range_offset_m", 0.5);
  const auto lines = LinesOf(ExportG2o(result, &log, folder / "").value().at(0));
  // It turns by 0.3, less half of the drift, goes 1.5 m, and turns by the other half.
  const auto motion = Numbers(lines[8], "EDGE_SE2 ");
  ExpectNear({motion.begin(), motion.begin() + 5}, {0, 1, 1.5 * std::cos(0.2), 1.5 * std::sin(0.2), 0.1});
  const auto others = Numbers(lines[10], "EDGE_SE2 ");  // nothing was found of the other robot
  ExpectNear({others.begin(), others.begin() + 5}, {3, 4, std::cos(0.1), std::sin(0.1), 0.1});
  const auto seen = Numbers(lines[12], "EDGE_SE2_XY ");
  ExpectNear({seen.begin() + 2, seen.begin() + 4}, {1.5 * std::cos(0.5), 1.5 * std::sin(0.5)});
}

// Of the turn on the spot and the half metre before it, an observation in the middle has the half metre.
TEST(ExportG2o, AnObservationBetweenTwoVerticesIsTakenToTheOneBeforeByOdometry) {
  const TestFolder folder;
  Blob log = SmallLog();
  log.PutVector<double>("robot/0/odometry/time_s", {1, 2, 2, 3});
  log.PutVector<double>("robot/0/odometry/turn_rad", {0, 0, M_PI / 2, 0});
  log.PutVector<double>("robot/0/odometry/forward_m", {0, 1, 0, 2});
  log.PutVector<double>("robot/0/observations/time_s", {1.5, 2.5, 3});
  const auto lines = LinesOf(ExportG2o(ScaledResult(), &log, folder / "").value().at(0));
  const auto seen = Numbers(lines[12], "EDGE_SE2_XY ");
  ExpectNear({seen.begin(), seen.begin() + 4}, {0, 6, 0.5 + 2 * std::cos(0.5), 2 * std::sin(0.5)}, 1e-9);
}

TEST(ExportG2o, ObservationsThatTheMapWasMadeWithoutAreLeftOut) {
  const TestFolder folder;
  const Blob log = SmallLog();
  Blob result = ScaledResult();
  result.PutVector<std::int32_t>("robot/0/observations/map_landmark", {0, 0, 1});
  result.PutVector<double>("robot/0/observations/probability", {0, 0.3, 0.3});
  const auto lines = LinesOf(ExportG2o(result, &log, folder / "").value().at(0));
  // The second one is named, so it counts however likely it is; the third one is rather of nothing.
  ASSERT_EQ(lines.size(), 6U + 2 + 1 + 4 + 1);
  const auto seen = Numbers(lines[12], "EDGE_SE2_XY ");
  EXPECT_EQ(seen[0], 1);
  EXPECT_EQ(seen[1], 6);
}

TEST(ExportG2o, LandmarksAsPosesCountAsMuchAsPointsDo) {
  const TestFolder folder;
  const Blob log = SmallLog();
  const auto points = LinesOf(ExportG2o(ScaledResult(), &log, folder / "").value().at(0)),
             poses = LinesOf(
                 ExportG2o(ScaledResult(), &log, folder / "", true, G2oLandmarks::kPoses).value().at(0));
  ASSERT_EQ(poses.size(), points.size());
  EXPECT_EQ(poses[6], "VERTEX_SE2 6 2 0 0");
  for (const std::size_t row : {12, 13}) {
    const auto point = Numbers(points[row], "EDGE_SE2_XY "), pose = Numbers(poses[row], "EDGE_SE2 ");
    ExpectNear({pose.begin(), pose.begin() + 4}, {point.begin(), point.begin() + 4});
    // Its heading is 0 in the map, and the information is in its frame.
    const double from_rad = Numbers(points[static_cast<std::size_t>(point[0])], "VERTEX_SE2 ")[3];
    EXPECT_NEAR(pose[4], -from_rad, 1e-12);
    const auto in_frame_of = [](const std::vector<double>& upper, double x, double y) {
      return upper[0] * x * x + 2 * upper[1] * x * y + upper[2] * y * y;
    };
    const double c = std::cos(pose[4]), s = std::sin(pose[4]);
    const std::vector<double> of_point{point.begin() + 4, point.end()}, of_pose{pose[5], pose[6], pose[8]};
    for (const auto& [x, y] : {std::pair(1.0, 0.0), {0.0, 1.0}, {0.3, -2.0}})
      EXPECT_NEAR(in_frame_of(of_pose, c * x + s * y, c * y - s * x), in_frame_of(of_point, x, y), 1e-9);
    ExpectNear({pose[7], pose[9]}, {0, 0});
    EXPECT_NEAR(pose[10], 1e-6 * (of_point[0] + of_point[2]), 1e-15);
  }
}

TEST(ExportG2o, ALogOfAnotherRunIsRefused) {
  const TestFolder folder;
  Blob log = SmallLog();
  Blob result = SmallResult();
  result.Put("log_hash", Array::Text(log.ContentHash().Hex()));
  EXPECT_TRUE(ExportG2o(result, &log, folder / "").ok());
  log.PutVector<double>("robot/0/observations/time_s", {1});
  ExpectContains(InputErrorOf([&] { (void)ExportG2o(result, &log, folder / ""); }), "made from another log");
  ExpectContains(InputErrorOf([&] { (void)ExportG2o(SmallResult(), &log, folder / ""); }),
                 "'robot/0/observations/' has 1 rows in the log, 3 in the result");
}

TEST(ExportRos, WritesAMapThatMapServerReads) {
  const TestFolder folder;
  ASSERT_TRUE(ExportRos(SmallResult(), folder / "").ok());
  const std::string image = FileText(folder / "map.pgm");
  const std::string header = "P5\n3 2\n255\n";
  ASSERT_EQ(image.size(), header.size() + 6);
  EXPECT_EQ(image.substr(0, header.size()), header);
  // Joined layers: row 0 is (0, 0.9, 0.5), row 1 (0.7, 0, 0); the picture begins at the top. Extracted
  // landmarks lie in the right cell of row 0 and the middle one of row 1. Nothing is free.
  const std::vector<int> expected{0, 0, 205, 205, 0, 0};
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(static_cast<unsigned char>(image[header.size() + i]), expected[i]) << i;
  EXPECT_EQ(FileText(folder / "map.yaml"),
            "image: map.pgm\nmode: trinary\nresolution: 1.5\norigin: [-1, -0.5, 0]\nnegate: "
            "0\noccupied_thresh: 0.65\n"
            "free_thresh: 0.196\n");
}

TEST(ExportRos, SaysWhereThereIsNoGrid) {
  const TestFolder folder;
  ExpectContains(InputErrorOf([&] { (void)ExportRos(SmallLog(), folder / ""); }),
                 "there is no grid map in it");
}

TEST(Png, OpenCvReadsBackTheSamePixels) {
  std::vector<std::uint8_t> pixels(3 * 5 * 7);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * 37);
  const std::string png = EncodePng(5, 7, pixels);
  const cv::Mat image = cv::imdecode(std::vector<char>(png.begin(), png.end()), cv::IMREAD_COLOR);
  ASSERT_EQ(image.cols, 5);
  ASSERT_EQ(image.rows, 7);
  for (std::size_t y = 0; y < 7; ++y) {
    for (std::size_t x = 0; x < 5; ++x) {
      const auto* rgb = &pixels[3 * (5 * y + x)];
      EXPECT_EQ(image.at<cv::Vec3b>(static_cast<int>(y), static_cast<int>(x)),
                cv::Vec3b(rgb[2], rgb[1], rgb[0]));
    }
  }
}

TEST(ExportPng, DrawsGridPathsAndLandmarks) {
  const TestFolder folder;
  const auto files = ExportPng(SmallResult(), folder / "").value();
  const cv::Mat image = cv::imread(files.at(0));
  EXPECT_EQ(image.cols, 1600);
  const auto count = [&](const cv::Scalar& bgr) {
    cv::Mat mask;
    cv::inRange(image, bgr, bgr, mask);
    return cv::countNonZero(mask);
  };
  EXPECT_GT(count({255, 255, 255}), 100000);  // free
  EXPECT_GT(count({51, 39, 28}), 100);        // landmarks and the bar
  EXPECT_GT(count({60, 120, 217}), 100);      // the second robot's path, over the first one's
  EXPECT_GT(count({232, 184, 143}), 100);     // the likeliest cell
}

TEST(ExportPng, SaysWhereThereIsNothingToDraw) {
  const TestFolder folder;
  ExpectContains(InputErrorOf([&] { (void)ExportPng(Blob(), folder / ""); }),
                 "there is neither a map nor a path");
}

TEST(Export, AFolderThatCannotBeMadeIsTheWorldsFault) {
  const TestFolder folder;
  folder.Put("file", "");
  const Written written = ExportTum(SmallResult(), folder / "file/below");
  ASSERT_FALSE(written.ok());
  ExpectContains(written.status().message(), "file/below: cannot make the folder");
}

}  // namespace
}  // namespace cairn::datasets
