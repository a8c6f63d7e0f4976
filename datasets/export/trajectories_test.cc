// Text formats, read back by what knows the formats alone.
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "datasets/export/export.h"
#include "datasets/testing.h"
#include "datasets/testing_result.h"

namespace cairn::datasets {
namespace {

// The numbers of each line that is no comment.
std::vector<std::vector<double>> Rows(const std::string& path) {
  std::istringstream stream(FileText(path));
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    rows.emplace_back();
    for (std::string word; std::getline(words, word, line.find(',') == std::string::npos ? ' ' : ',');)
      rows.back().push_back(std::stod(word));
  }
  return rows;
}

void ExpectRow(const std::vector<double>& row, const std::vector<double>& expected) {
  ASSERT_EQ(row.size(), expected.size());
  for (std::size_t i = 0; i < row.size(); ++i) EXPECT_NEAR(row[i], expected[i], 1e-12) << i;
}

TEST(ExportKitti, ARowIsThePosesMatrixAndTimesLieBeside) {
  const TestFolder folder;
  const auto files = ExportKitti(SmallResult(), folder / "").value();
  EXPECT_EQ(files, (std::vector<std::string>{folder / "Rosa.kitti", folder / "Rosa.times",
                                             folder / "a_b.kitti", folder / "a_b.times"}));
  const auto rows = Rows(files[0]);
  ASSERT_EQ(rows.size(), 3U);
  ExpectRow(rows[0], {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
  ExpectRow(rows[1], {0, -1, 0, 1, 1, 0, 0, 0, 0, 0, 1, 0});  // at (1, 0), heading to the left
  ExpectRow(rows[2], {std::cos(3), -std::sin(3), 0, 1, std::sin(3), std::cos(3), 0, 2, 0, 0, 1, 0});
  EXPECT_EQ(FileText(files[1]), "1\n2\n3\n");
}

TEST(ExportEuroc, ARowHasNanosecondsAndTheQuaternionsRealPartFirst) {
  const TestFolder folder;
  Blob result = SmallResult();
  result.PutVector<double>("robot/0/poses/time_s", {-0.25, 2, 1403636579.75});
  const std::string file = ExportEuroc(result, folder / "").value().at(0);
  EXPECT_EQ(file, folder / "Rosa.csv");
  const std::string text = FileText(file);
  EXPECT_TRUE(text.starts_with("#timestamp, p_RS_R_x [m], "));
  ExpectContains(text, "\n-250000000,0,0,0,1,0,0,0,nan");
  ExpectContains(text, "\n1403636579750000000,1,2,0,");
  const auto rows = Rows(file);
  ASSERT_EQ(rows.size(), 3U);
  for (const std::vector<double>& row : rows) ASSERT_EQ(row.size(), 17U);
  ExpectRow({rows[1].begin(), rows[1].begin() + 8}, {2e9, 1, 0, 0, std::sqrt(0.5), 0, 0, std::sqrt(0.5)});
  for (std::size_t i = 8; i < 17; ++i) EXPECT_TRUE(std::isnan(rows[1][i])) << "nobody knows it";
  result.PutVector<double>("robot/0/poses/time_s", {0, 1, 1e10});
  ExpectContains(InputErrorOf([&] { (void)ExportEuroc(result, folder / ""); }), "counted to 9.2e9 s");
}

// A reader of ASCII PLY: the rows of each element, and the names of their numbers.
struct Element {
  std::vector<std::string> properties;
  std::vector<std::vector<double>> rows;
};
std::map<std::string, Element> ReadPly(const std::string& path) {
  std::istringstream stream(FileText(path));
  std::string line, word, name;
  std::getline(stream, line);
  EXPECT_EQ(line, "ply");
  std::getline(stream, line);
  EXPECT_EQ(line, "format ascii 1.0");
  std::map<std::string, Element> elements;
  std::vector<std::pair<std::string, std::size_t>> order;
  while (std::getline(stream, line) && line != "end_header") {
    std::istringstream words(line);
    words >> word;
    if (word == "element") {
      std::size_t count = 0;
      words >> name >> count;
      order.emplace_back(name, count);
    } else {
      EXPECT_EQ(word, "property");
      words >> word >> word;
      elements[order.back().first].properties.push_back(word);
    }
  }
  for (const auto& [element, count] : order) {
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_TRUE(std::getline(stream, line));
      std::istringstream words(line);
      elements[element].rows.emplace_back();
      for (double value = 0; words >> value;) elements[element].rows.back().push_back(value);
      EXPECT_EQ(elements[element].rows.back().size(), elements[element].properties.size());
    }
  }
  EXPECT_FALSE(std::getline(stream, line)) << "nothing is left over";
  return elements;
}

TEST(ExportPly, PathsHaveLinesAndLandmarksTheirCovariances) {
  const TestFolder folder;
  const auto files = ExportPly(SmallResult(), folder / "").value();
  EXPECT_EQ(files, (std::vector<std::string>{folder / "landmarks.ply", folder / "path_Rosa.ply",
                                             folder / "path_a_b.ply"}));
  auto landmarks = ReadPly(files[0]);
  EXPECT_EQ(landmarks.size(), 1U);
  EXPECT_EQ(landmarks["vertex"].properties,
            (std::vector<std::string>{"x", "y", "z", "var_xx_m2", "var_xy_m2", "var_yy_m2"}));
  ASSERT_EQ(landmarks["vertex"].rows.size(), 2U);
  ExpectRow(landmarks["vertex"].rows[0], {2, 0, 0, 0.04, 0, 0.01});
  auto path = ReadPly(files[1]);
  ASSERT_EQ(path["vertex"].rows.size(), 3U);
  ExpectRow(path["vertex"].rows[2], {1, 2, 0, 3, 3});
  EXPECT_EQ(path["edge"].rows, (std::vector<std::vector<double>>{{0, 1}, {1, 2}}));
}

TEST(ExportPly, OfALocalMapTheEdgesThatAreOccupied) {
  const TestFolder folder;
  const auto files = ExportPly(SmallLocalMap(), folder / "").value();
  ASSERT_EQ(files.size(), 3U);
  EXPECT_TRUE(files[2].ends_with("edges_a_b.ply")) << files[2];
  const auto rows = ReadPly(files[2])["vertex"].rows;
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_NEAR(rows[0][0], 7.5, 1e-12);
  EXPECT_NEAR(rows[1][0], 14, 1e-12);
  EXPECT_NEAR(rows[1][1], 21.5, 1e-12);
}

TEST(ExportPly, OfAGridMapCellsThatAreRatherOccupied) {
  const TestFolder folder;
  Blob map;
  map.Put("map/grid/probability", Array::Of<double>({2, 2}, {0.5, 0.75, std::nan(""), 1}));
  map.PutScalar("map/grid/origin_x_m", -1.0);
  map.PutScalar("map/grid/origin_y_m", 3.0);
  map.PutScalar("map/grid/cell_m", 0.5);
  map.Put("robots", Array::Texts({"Rosa"}));
  const auto files = ExportPly(map, folder / "").value();
  ASSERT_EQ(files, (std::vector<std::string>{folder / "map.ply"}));
  EXPECT_EQ(ReadPly(files[0])["vertex"].rows,
            (std::vector<std::vector<double>>{{-0.25, 3.25, 0, 0.75}, {-0.25, 3.75, 0, 1}}));
}

nlohmann::json Exported(const Blob& blob, const GeoOrigin& origin) {
  const TestFolder folder;
  return nlohmann::json::parse(FileText(ExportGeojson(blob, origin, folder / "").value().at(0)));
}

TEST(ExportGeojson, HasAFeatureForEachLandmarkAndPath) {
  const auto json = Exported(SmallResult(), {});
  EXPECT_EQ(json["type"], "FeatureCollection");
  ASSERT_EQ(json["features"].size(), 4U);
  EXPECT_EQ(json["features"][0]["geometry"]["type"], "Point");
  EXPECT_EQ(json["features"][0]["properties"]["landmark"], "door");
  EXPECT_EQ(json["features"][1]["properties"]["landmark"], "#1");
  EXPECT_EQ(json["features"][3]["geometry"]["type"], "LineString");
  EXPECT_EQ(json["features"][3]["geometry"]["coordinates"].size(), 3U);
  EXPECT_EQ(json["features"][3]["properties"]["robot"], "a/b");
  EXPECT_EQ(json["features"][3]["properties"]["time_s"], (std::vector<double>{1, 2, 3}));
}

// A place on the ellipsoid, as metres from its middle: the textbook's formula.
std::array<double, 3> Geocentric(double latitude_deg, double longitude_deg) {
  const double f = latitude_deg * M_PI / 180, l = longitude_deg * M_PI / 180;
  const double a = 6378137, b = 6356752.314245;
  const double n = a * a / std::hypot(a * std::cos(f), b * std::sin(f));
  return {n * std::cos(f) * std::cos(l), n * std::cos(f) * std::sin(l), b * b / (a * a) * n * std::sin(f)};
}

// The metres between two exported places are those of the map, and lie as the x-axis is said to.
TEST(ExportGeojson, LiesOnTheEarthWhereItIsSaidTo) {
  Blob result = SmallResult();
  result.PutVector<double>("map/landmark_x_m", {0, 300});
  result.PutVector<double>("map/landmark_y_m", {0, 400});
  for (const GeoOrigin& origin : {GeoOrigin{48.137, 11.575, 0}, GeoOrigin{-33.9, -179.9999, 120},
                                  GeoOrigin{0, 180, -45}, GeoOrigin{71, 25.8, 30}}) {
    const auto json = Exported(result, origin);
    const auto at = [&](int i) {
      return json["features"][i]["geometry"]["coordinates"].get<std::vector<double>>();
    };
    EXPECT_NEAR(std::remainder(at(0)[0] - origin.longitude_deg, 360), 0, 1e-12);
    EXPECT_NEAR(at(0)[1], origin.latitude_deg, 1e-12);
    EXPECT_LE(std::abs(at(1)[0]), 180);
    const auto from = Geocentric(at(0)[1], at(0)[0]), to = Geocentric(at(1)[1], at(1)[0]);
    EXPECT_NEAR(std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]), 500, 0.03);
    // North by the meridian's radius of curvature, east by the other one, to a part in ten thousand or so.
    const double s = std::sin(origin.latitude_deg * M_PI / 180), w = 1 - 6.69437999014e-3 * s * s;
    const double north =
        (at(1)[1] - at(0)[1]) * M_PI / 180 * 6378137 * (1 - 6.69437999014e-3) / std::pow(w, 1.5);
    const double east = std::remainder(at(1)[0] - at(0)[0], 360) * M_PI / 180 * 6378137 / std::sqrt(w) *
                        std::cos(origin.latitude_deg * M_PI / 180);
    const double turn = origin.x_axis_deg * M_PI / 180;
    EXPECT_NEAR(east, 300 * std::cos(turn) - 400 * std::sin(turn), 0.15);
    EXPECT_NEAR(north, 300 * std::sin(turn) + 400 * std::cos(turn), 0.15);
  }
}

}  // namespace
}  // namespace cairn::datasets
