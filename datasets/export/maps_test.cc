// Grid maps that go out, read back by code that shares nothing with the writers.
#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "datasets/export/export.h"
#include "datasets/testing.h"
#include "datasets/testing_result.h"

namespace cairn::datasets {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// 4 by 3 cells of 0.1 m; row 0 is the lowest y.
Blob SmallGrid() {
  Blob map;
  map.Put("map/grid/probability",
          Array::Of<double>({3, 4}, {0, 0.1, 0.3, kNan, 0.5, 0.64, 0.66, 1, 0.9, kNan, 0.196, 0.25}));
  map.PutScalar("map/grid/origin_x_m", -0.2);
  map.PutScalar("map/grid/origin_y_m", 0.3);
  map.PutScalar("map/grid/cell_m", 0.1);
  return map;
}

// What map_server of nav2 makes of a pixel, as its map_io reads it: transparency comes first, and a shade is
// rounded.
int ServedByNav2(int grey, int alpha, const std::string& mode, double occupied, double free) {
  if (mode == "raw") return grey <= 100 ? grey : -1;
  const double occupancy = 1 - grey / 255.0;
  if (mode == "scale" && alpha < 255) return -1;
  if (occupied < occupancy) return 100;
  if (occupancy < free) return 0;
  if (mode == "trinary") return -1;
  return static_cast<int>(std::rint((occupancy - free) / (occupied - free) * 100));
}

// What map_server of ROS makes of a pixel, as its documentation says: -1 unknown, 0 to 100.
int Served(int grey, int alpha, const std::string& mode, double occupied, double free) {
  if (mode == "raw") return grey <= 100 ? grey : -1;
  const double occupancy = (255 - grey) / 255.0;
  if (occupancy > occupied) return 100;
  if (occupancy < free) return 0;
  if (mode == "trinary" || alpha < 255) return -1;
  return static_cast<int>(1 + 98 * (occupancy - free) / (occupied - free));
}

// The map as map_server serves it, from the lowest row on.
std::vector<int> Serve(const std::string& folder) {
  std::istringstream yaml(FileText(folder + "/map.yaml"));
  std::map<std::string, std::string> entries;
  for (std::string line; std::getline(yaml, line);)
    entries[line.substr(0, line.find(": "))] = line.substr(line.find(": ") + 2);
  EXPECT_EQ(entries.at("negate"), "0");
  EXPECT_EQ(entries.at("resolution"), "0.1");
  EXPECT_EQ(entries.at("origin"), "[-0.2, 0.3, 0]");
  const cv::Mat image = cv::imread(folder + "/" + entries.at("image"), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(image.cols, 4);
  EXPECT_EQ(image.rows, 3);
  std::vector<int> served;
  for (int row = image.rows - 1; row >= 0; --row) {
    for (int column = 0; column < image.cols; ++column) {
      const bool alpha = image.channels() == 4;
      const int grey = alpha ? image.at<cv::Vec4b>(row, column)[0] : image.at<std::uint8_t>(row, column);
      const int opaque = alpha ? image.at<cv::Vec4b>(row, column)[3] : 255;
      const double occupied = std::stod(entries.at("occupied_thresh")),
                   free = std::stod(entries.at("free_thresh"));
      served.push_back(Served(grey, opaque, entries.at("mode"), occupied, free));
      // The two servers agree, but for shades: up to 2, for one has them from 1 to 99, the other from 0 to
      // 100.
      const bool is_shade = entries.at("mode") == "scale" && served.back() > 0 && served.back() < 100;
      EXPECT_NEAR(ServedByNav2(grey, opaque, entries.at("mode"), occupied, free), served.back(),
                  is_shade ? 2 : 0);
    }
  }
  return served;
}

TEST(ExportRosModes, TrinarySaysOccupiedFreeOrUnknown) {
  const TestFolder folder;
  ASSERT_TRUE(ExportRos(SmallGrid(), folder / "").ok());
  EXPECT_EQ(Serve(folder / ""), (std::vector<int>{0, 0, -1, -1, -1, -1, 100, 100, 100, -1, -1, -1}));
}

TEST(ExportRosModes, ScaleKeepsShadesAndWhatIsUnknown) {
  const TestFolder folder;
  EXPECT_EQ(ExportRos(SmallGrid(), folder / "", true, RosMode::kScale).value().size(), 3U);
  const std::vector<int> served = Serve(folder / "");
  const std::vector<double> p{0, 0.1, 0.3, kNan, 0.5, 0.64, 0.66, 1, 0.9, kNan, 0.196, 0.25};
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double share = (p[i] - 0.196) / (0.65 - 0.196);
    const int expected = std::isnan(p[i]) ? -1
                         : share < 0      ? 0
                         : share > 1      ? 100
                                          : static_cast<int>(1 + 98 * share);
    EXPECT_NEAR(served[i], expected, 1) << i;
  }
  EXPECT_EQ(served[3], -1);
  EXPECT_EQ(static_cast<std::uint8_t>(FileText(folder / "map.pgm").back()), 205)
      << "unknown, where nothing is transparent";
}

TEST(ExportRosModes, RawIsPercent) {
  const TestFolder folder;
  ASSERT_TRUE(ExportRos(SmallGrid(), folder / "", true, RosMode::kRaw).ok());
  EXPECT_EQ(Serve(folder / ""), (std::vector<int>{0, 10, 30, -1, 50, 64, 66, 100, 90, -1, 20, 25}));
}

// On the same cells two layers; landmarks in cells 2 and 4, the second of which is spread over several, and
// one beyond the grid.
Blob SmallLandmarkMap() {
  Blob map = SmallGrid();
  std::vector<double> layers(24, 0.0);
  layers[2] = 0.9;
  layers[4] = 0.3;
  layers[5] = 0.2;
  layers[7] = 0.45;   // together with the other layer's 0.4: 0.67
  layers[11] = 0.45;  // with its 0.2: 0.56
  layers[12 + 7] = 0.4;
  layers[12 + 11] = 0.2;
  layers[12 + 4] = 0.05;
  map.Put("map/grid/probability", Array::Of<double>({2, 3, 4}, layers));
  map.PutVector("map/landmark_x_m", std::vector<double>{0.05, -0.15, 7.0});
  map.PutVector("map/landmark_y_m", std::vector<double>{0.35, 0.45, 0.4});
  return map;
}

TEST(ExportRosModes, ALandmarkMapSaysNothingOfFreeSpace) {
  const TestFolder folder;
  for (const auto& [mode, likely] :
       {std::pair(RosMode::kTrinary, -1), std::pair(RosMode::kScale, 79), std::pair(RosMode::kRaw, 56)}) {
    ASSERT_TRUE(ExportRos(SmallLandmarkMap(), folder / "", true, mode).ok());
    const int surely = mode == RosMode::kRaw ? 67 : 100;
    EXPECT_EQ(Serve(folder / ""),
              (std::vector<int>{-1, -1, 100, -1, 100, -1, -1, surely, -1, -1, -1, likely}));
  }
}

// A low prior is no reading: where the data say nothing nothing is known, whatever its probability.
TEST(ExportRosModes, ACellOfWhichTheDataSayNothingIsUnknown) {
  const TestFolder folder;
  Blob map = SmallGrid();
  const std::vector<double> p(12, 0.05);
  std::vector<double> difference(12, 0.0);
  difference[3] = -3;
  map.Put("map/grid/probability", Array::Of<double>({3, 4}, p));
  map.Put("map/grid/log_odds_difference", Array::Of<double>({3, 4}, difference));
  ASSERT_TRUE(ExportRos(map, folder / "").ok());
  std::vector<int> expected(12, -1);
  expected[3] = 0;
  EXPECT_EQ(Serve(folder / ""), expected);
}

TEST(ExportPngOfGridMaps, APixelACell) {
  const TestFolder folder;
  Blob map = SmallGrid();
  EXPECT_EQ(ExportPng(map, folder / "").value().size(), 1U);
  const cv::Mat image = cv::imread(folder / "map.png");
  ASSERT_EQ(image.size(), cv::Size(4, 3));
  EXPECT_EQ(image.at<cv::Vec3b>(2, 0), cv::Vec3b(255, 255, 255)) << "free, at the lower left";
  EXPECT_EQ(image.at<cv::Vec3b>(1, 3), cv::Vec3b(0, 0, 0)) << "occupied";
  map.Put("map/grid/occupied", Array::Of<std::uint8_t>({3, 4}, std::vector<std::uint8_t>(12, 1)));
  EXPECT_EQ(ExportPng(map, folder / "").value().size(), 2U);
}

// A decoder of .bt that walks the bytes with a stack of its own: the centres of the leaves it finds.
struct Leaf {
  double x_m, y_m, z_m;
  bool occupied;
};
std::vector<Leaf> DecodeBt(const std::string& file, std::size_t* nodes) {
  const std::string text = FileText(file);
  EXPECT_TRUE(text.starts_with("# Octomap OcTree binary file\nid OcTree\nsize "));
  const std::size_t data = text.find("\ndata\n") + 6;
  std::istringstream header(text.substr(text.find("\nsize ") + 6));
  std::string word;
  double edge_m = 0;
  header >> *nodes >> word >> edge_m;
  struct Open {
    std::int64_t x, y, z, edge;
  };
  std::vector<Open> stack{{-32768, -32768, -32768, 65536}};
  std::vector<Leaf> leaves;
  std::size_t at = data, seen = 1;
  while (!stack.empty()) {
    const Open node = stack.back();
    stack.pop_back();
    const unsigned bits =
        static_cast<std::uint8_t>(text.at(at)) | (static_cast<std::uint8_t>(text.at(at + 1)) << 8U);
    at += 2;
    const std::int64_t half = node.edge / 2;
    std::vector<Open> inner;
    for (unsigned c = 0; c < 8; ++c) {
      const unsigned kind = (bits >> (2 * c)) & 3U;
      const Open child{node.x + (c % 2) * half, node.y + (c / 2 % 2) * half, node.z + (c / 4) * half, half};
      seen += kind != 0;
      if (kind == 3) inner.push_back(child);
      const double middle = 0.5 * static_cast<double>(half);
      if (kind == 1 || kind == 2)
        leaves.push_back({(static_cast<double>(child.x) + middle) * edge_m,
                          (static_cast<double>(child.y) + middle) * edge_m,
                          (static_cast<double>(child.z) + middle) * edge_m, kind == 2});
    }
    stack.insert(stack.end(), inner.rbegin(), inner.rend());
  }
  EXPECT_EQ(at, text.size()) << "nothing is left over";
  EXPECT_EQ(seen, *nodes);
  return leaves;
}

// Cells of 1 to 12 with their middles.
std::vector<Leaf> KnownCells(const Blob& map) {
  const auto p = map.Get<double>("map/grid/probability");
  const double cell = map.Scalar<double>("map/grid/cell_m"), x = map.Scalar<double>("map/grid/origin_x_m"),
               y = map.Scalar<double>("map/grid/origin_y_m");
  const std::int64_t columns = map.at("map/grid/probability").shape()[1];
  std::vector<Leaf> cells;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!(p[i] < 0.5 || p[i] > 0.5)) continue;
    const std::int64_t cell_number = static_cast<std::int64_t>(i), row_number = cell_number / columns;
    const auto column = static_cast<double>(cell_number % columns), row = static_cast<double>(row_number);
    cells.push_back({x + (column + 0.5) * cell, y + (row + 0.5) * cell, cell / 2, p[i] > 0.5});
  }
  return cells;
}

bool Holds(const std::vector<Leaf>& leaves, const Leaf& cell) {
  return std::ranges::any_of(leaves, [&](const Leaf& leaf) {
    return std::abs(leaf.x_m - cell.x_m) < 1e-6 && std::abs(leaf.y_m - cell.y_m) < 1e-6 &&
           std::abs(leaf.z_m - cell.z_m) < 1e-6 && leaf.occupied == cell.occupied;
  });
}

TEST(ExportOctomap, EachKnownCellIsAVoxelAndNothingElse) {
  const TestFolder folder;
  const std::string file = ExportOctomap(SmallGrid(), folder / "").value().at(0);
  std::size_t nodes = 0;
  const std::vector<Leaf> leaves = DecodeBt(file, &nodes), cells = KnownCells(SmallGrid());
  EXPECT_EQ(leaves.size(), 9U);
  ASSERT_EQ(leaves.size(), cells.size());
  for (const Leaf& cell : cells) EXPECT_TRUE(Holds(leaves, cell)) << cell.x_m << " " << cell.y_m;
}

TEST(ExportOctomap, OfALandmarkMapThereIsNoFreeVoxel) {
  const TestFolder folder;
  std::size_t nodes = 0;
  const std::vector<Leaf> leaves =
      DecodeBt(ExportOctomap(SmallLandmarkMap(), folder / "").value().at(0), &nodes);
  EXPECT_EQ(leaves.size(), 4U);
  for (const Leaf& leaf : leaves) EXPECT_TRUE(leaf.occupied) << leaf.x_m << " " << leaf.y_m;
}

TEST(ExportOctomap, WhatLiesBeyondATreeOrNowhereIsRefused) {
  const TestFolder folder;
  Blob map = SmallGrid();
  map.PutScalar("map/grid/origin_x_m", 3276.7);
  ExpectContains(InputErrorOf([&] { (void)ExportOctomap(map, folder / ""); }), "the map lies beyond");
  ExpectContains(InputErrorOf([&] { (void)ExportOctomap(SmallLog(), folder / ""); }), "there is no grid map");
  map = SmallGrid();
  map.Put("map/grid/probability", Array::Of<double>({1, 2}, {kNan, 0.5}));
  EXPECT_TRUE(FileText(ExportOctomap(map, folder / "").value().at(0)).ends_with("size 0\nres 0.1\ndata\n"));
}

}  // namespace
}  // namespace cairn::datasets
