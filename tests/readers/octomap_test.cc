#include <gtest/gtest.h>

#ifdef CAIRN_WITH_OCTOMAP
#include <octomap/octomap.h>

#include <cmath>
#include <vector>

#include "datasets/export/export.h"
#include "datasets/testing.h"
#include "schema/rng.h"

namespace cairn::datasets {
namespace {

constexpr std::int64_t kColumns = 70, kRows = 45;
constexpr double kCell_m = 0.05, kOriginX_m = -1.35, kOriginY_m = -0.85;  // the origin lies within the map

// A third of the cells is unknown, and a patch of them that is larger than a node of the tree.
std::vector<double> Probabilities() {
  Rng rng(11, 0, 0);
  std::vector<double> p;
  for (std::int64_t i = 0; i < kColumns * kRows; ++i) {
    const bool patch = i % kColumns > 30 && i % kColumns < 60 && i / kColumns > 20;
    p.push_back(rng.Uniform() < 0.33 || patch ? NAN : rng.Uniform());
  }
  return p;
}

TEST(Octomap, ReadsEachCellOfAnExportedGrid) {
  const std::vector<double> p = Probabilities();
  Blob map;
  map.Put("map/grid/probability", Array::Of<double>({kRows, kColumns}, p));
  map.PutScalar("map/grid/origin_x_m", kOriginX_m);
  map.PutScalar("map/grid/origin_y_m", kOriginY_m);
  map.PutScalar("map/grid/cell_m", kCell_m);
  const TestFolder folder;
  octomap::OcTree tree(ExportOctomap(map, folder / "").value().at(0));
  EXPECT_EQ(tree.getResolution(), kCell_m);
  std::size_t known = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t column = i % kColumns, row = i / kColumns;
    const double x = kOriginX_m + (static_cast<double>(column) + 0.5) * kCell_m;
    const double y = kOriginY_m + (static_cast<double>(row) + 0.5) * kCell_m;
    const octomap::OcTreeNode* node = tree.search(x, y, kCell_m / 2);
    ASSERT_EQ(node == nullptr, std::isnan(p[i])) << i;
    if (node == nullptr) continue;
    ++known;
    EXPECT_EQ(tree.isNodeOccupied(node), p[i] > 0.5) << i;
  }
  EXPECT_EQ(tree.getNumLeafNodes(), known) << "and nothing else";
  EXPECT_GT(known, 1000U);
}

}  // namespace
}  // namespace cairn::datasets
#else
TEST(Octomap, ReadsEachCellOfAnExportedGrid) {
  GTEST_SKIP() << "built without liboctomap-dev (deploy/install.sh --dev installs it)";
}
#endif
