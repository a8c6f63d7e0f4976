#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "datasets/common/array_text.h"
#include "datasets/export/export.h"
#include "datasets/export/parts.h"

namespace cairn::datasets {
namespace {

// Of each child two bits, that of the lower value first.
enum Child : unsigned { kNothing = 0, kFree = 1, kOccupied = 2, kInner = 3 };

constexpr int kLevels = 16;                              // of OctoMap's trees
constexpr std::int64_t kMiddle = std::int64_t{1} << 15;  // the key of the voxel above the origin

// The grid as one layer of voxels, and the tree of it: a node's children lie by x, then y, then z.
class Tree {
 public:
  explicit Tree(const Occupancy& cells) : cells_(cells), box_(cells.box) {
    first_x_ = kMiddle + std::llround(box_.origin_x_m / box_.cell_m);
    first_y_ = kMiddle + std::llround(box_.origin_y_m / box_.cell_m);
    if (first_x_ < 0 || first_y_ < 0 || first_x_ + box_.columns > 2 * kMiddle ||
        first_y_ + box_.rows > 2 * kMiddle)
      throw InputError("a tree of OctoMap reaches 32,768 cells from the origin; the map lies beyond");
    if (AddInner(kLevels, 0, 0, 0)) ++nodes_;
  }
  std::size_t nodes() const { return nodes_; }
  const std::string& bytes() const { return bytes_; }

 private:
  // The cube of 2^level voxels from (x, y, z) on. False, and nothing added, where all of it is unknown.
  bool AddInner(int level, std::int64_t x, std::int64_t y, std::int64_t z) {
    const std::int64_t edge = std::int64_t{1} << level, half = edge / 2;
    const bool apart = x >= first_x_ + box_.columns || x + edge <= first_x_ || y >= first_y_ + box_.rows ||
                       y + edge <= first_y_ || z > kMiddle || z + edge <= kMiddle;
    if (apart) return false;
    const std::size_t at = bytes_.size(), nodes = nodes_;
    bytes_.append(2, '\0');
    unsigned children = 0;
    for (unsigned child = 0; child < 8; ++child) {
      const std::int64_t cx = x + (child & 1U ? half : 0), cy = y + (child & 2U ? half : 0),
                         cz = z + (child & 4U ? half : 0);
      unsigned kind = kNothing;
      if (level == 1)
        kind = Voxel(cx, cy, cz);
      else if (AddInner(level - 1, cx, cy, cz))
        kind = kInner;
      children |= kind << (2 * child);
      nodes_ += kind == kNothing ? 0 : 1;
    }
    if (children == 0) {
      bytes_.resize(at);
      nodes_ = nodes;
      return false;
    }
    bytes_[at] = static_cast<char>(children & 0xFFU);
    bytes_[at + 1] = static_cast<char>(children >> 8U);
    return true;
  }

  unsigned Voxel(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const std::int64_t column = x - first_x_, row = y - first_y_;
    if (z != kMiddle || column < 0 || column >= box_.columns || row < 0 || row >= box_.rows) return kNothing;
    const double p = cells_.probability[box_.Index(column, row)];
    if (p > 0.5) return kOccupied;
    return p < 0.5 ? kFree : kNothing;
  }

  const Occupancy& cells_;
  const GridBox& box_;
  std::int64_t first_x_ = 0, first_y_ = 0;  // keys of cell [0,0]
  std::size_t nodes_ = 0;
  std::string bytes_;
};

}  // namespace

Written ExportOctomap(const Blob& result, const std::string& folder, bool replace) {
  const Occupancy cells = ReadCells(result);
  const Tree tree(cells);
  FolderWriter writer(folder, replace);
  writer.Write("map.bt", "# Octomap OcTree binary file\nid OcTree\nsize " + std::to_string(tree.nodes()) +
                             "\nres " + NumberText(cells.box.cell_m) + "\ndata\n" + tree.bytes());
  return writer.Finish();
}

}  // namespace cairn::datasets
