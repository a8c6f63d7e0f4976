#include "pipelines/landmark_learning/error_sum/tree_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "pipelines/landmark_learning/error_sum/feature_rows.h"

namespace cairn::landmark_learning {
namespace {

constexpr int kFirstLevel = 2;         // from which on boxes can be far
constexpr int kFinestLevel = 10;       // a level's table of boxes has 4^level cells
constexpr double kLeafPositions = 24;  // in a leaf that holds any, on average at most
constexpr int kStripPositions = 48;

std::size_t Size(int count, int width) {
  return static_cast<std::size_t>(count) * static_cast<std::size_t>(width);
}

// Bits of x and y in turn (G. M. Morton's order): boxes of all levels are neighbours of their siblings.
std::uint64_t MortonCode(int x, int y) {
  std::uint64_t code = 0;
  for (int bit = 0; bit < kFinestLevel; ++bit)
    code |= static_cast<std::uint64_t>((x >> bit & 1) | (y >> bit & 1) << 1) << (2 * bit);
  return code;
}

int EvenBits(std::uint64_t code) {
  int value = 0;
  for (int bit = 0; bit < kFinestLevel; ++bit) value |= static_cast<int>(code >> (2 * bit) & 1) << bit;
  return value;
}

// Numbers in the order of their codes, of 2 * kFinestLevel bits: stable, by half of the bits at a time.
std::vector<int> OrderOf(const std::vector<std::uint64_t>& codes) {
  constexpr std::size_t kBuckets = std::size_t{1} << kFinestLevel;
  std::vector<int> order(codes.size()), next(codes.size());
  std::iota(order.begin(), order.end(), 0);
  for (const int shift : {0, kFinestLevel}) {
    const auto bucket = [&](int k) { return codes[static_cast<std::size_t>(k)] >> shift & (kBuckets - 1); };
    std::array<std::size_t, kBuckets> at{};
    for (const int k : order) ++at[bucket(k)];
    std::exclusive_scan(at.begin(), at.end(), at.begin(), std::size_t{0});
    for (const int k : order) next[at[bucket(k)]++] = k;
    order.swap(next);
  }
  return order;
}

}  // namespace

template <class Real>
TreeSums<Real>::TreeSums(const Positions& positions) {
  Sort(positions);
}

template <class Real>
void TreeSums<Real>::Sort(const Positions& positions) {
  const Box box = BoxAround(positions, {0, positions.size()});
  low_x_m_ = box.low_x_m;
  low_y_m_ = box.low_y_m;
  side_m_ = std::max({box.high_x_m - box.low_x_m, box.high_y_m - box.low_y_m, 1e-9}) * (1.0 + 1e-9);
  constexpr int kBoxes = 1 << kFinestLevel;
  const auto cell = [&](double at, double low) {
    return std::clamp(static_cast<int>((at - low) / side_m_ * kBoxes), 0, kBoxes - 1);
  };
  std::vector<std::uint64_t> codes, sorted_codes;
  for (std::size_t k = 0; k < positions.x_m.size(); ++k)
    codes.push_back(MortonCode(cell(positions.x_m[k], low_x_m_), cell(positions.y_m[k], low_y_m_)));
  order_ = OrderOf(codes);
  for (const int number : order_) {
    const auto k = static_cast<std::size_t>(number);
    sorted_codes.push_back(codes[k]);
    sorted_.x_m.push_back(positions.x_m[k]);
    sorted_.y_m.push_back(positions.y_m[k]);
  }
  sorted_.along_m.assign(order_.size(), 0.0);
  for (int level = 0; level <= kFinestLevel; ++level) {
    AddLevel(level, sorted_codes);
    const auto boxes = static_cast<double>(NodesOf(level).size());
    if (level >= kFirstLevel && positions.size() <= kLeafPositions * boxes) break;
  }
  LinkChildren();
}

// With positions, not yet children.
template <class Real>
void TreeSums<Real>::AddLevel(int level, const std::vector<std::uint64_t>& codes) {
  Level& added = levels_.emplace_back();
  added.grid.assign(std::size_t{1} << (2 * level), -1);
  std::uint64_t last = ~std::uint64_t{0};
  for (int i = 0; i < static_cast<int>(codes.size()); ++i) {
    const std::uint64_t code = codes[static_cast<std::size_t>(i)] >> (2 * (kFinestLevel - level));
    if (code != last) {
      const int x = EvenBits(code), y = EvenBits(code >> 1);
      added.grid[static_cast<std::size_t>((y << level) + x)] = static_cast<int>(added.nodes.size());
      added.nodes.push_back({x, y, {i, i}});
      last = code;
    }
    ++added.nodes.back().own.end;
  }
}

// From the positions of a box to its children, which hold them.
template <class Real>
void TreeSums<Real>::LinkChildren() {
  for (int level = 0; level < leaf_level(); ++level) {
    const auto& children = NodesOf(level + 1);  // with positions yet
    int child = 0;
    for (TreeNode& node : levels_[static_cast<std::size_t>(level)].nodes) {
      const int first = child;
      while (child < static_cast<int>(children.size()) &&
             children[static_cast<std::size_t>(child)].own.first < node.own.end)
        ++child;
      node.own = {first, child};
    }
  }
}

template <class Real>
template <class F>
void TreeSums<Real>::ForEach(int level, const TreeNode& node, bool near, const F& f) const {
  const int boxes = 1 << level;
  const std::vector<int>& grid = levels_[static_cast<std::size_t>(level)].grid;
  const auto bounds = [&](int at) {
    return IndexRange{std::max(-kFarthest, -at), std::min(kFarthest, boxes - 1 - at) + 1};
  };
  const IndexRange ys = bounds(node.y), xs = bounds(node.x);
  for (int dy = ys.first; dy < ys.end; ++dy) {
    for (int dx = xs.first; dx < xs.end; ++dx) {
      const int other = grid[static_cast<std::size_t>(((node.y + dy) << level) + node.x + dx)];
      if (other < 0 || IsNear(dx, dy) != near) continue;
      if (IsNear(((node.x + dx) >> 1) - (node.x >> 1), ((node.y + dy) >> 1) - (node.y >> 1)))
        f(other, dx, dy);
    }
  }
}

template <class Real>
void TreeSums<Real>::Clear(int width) {
  width_ = width;
  h_.resize(Size(sorted_.size(), width));
  sum_.assign(h_.size(), Real(0));
  for (int level = kFirstLevel; level <= leaf_level(); ++level) {
    const std::size_t cells = Size(static_cast<int>(NodesOf(level).size()) * kTerms, width);
    levels_[static_cast<std::size_t>(level)].moments.assign(cells, Real(0));
    levels_[static_cast<std::size_t>(level)].local.assign(cells, Real(0));
  }
}

template <class Real>
SmallMatrix<Real> TreeSums<Real>::TermsIn(const TreeNode& leaf) {
  const double half_m = 0.5 * side_m_ / (1 << leaf_level());
  const double x_m = low_x_m_ + (2 * leaf.x + 1) * half_m, y_m = low_y_m_ + (2 * leaf.y + 1) * half_m;
  u_.clear();
  v_.clear();
  for (int i = leaf.own.first; i < leaf.own.end; ++i) {
    u_.push_back(static_cast<Real>((sorted_.x_m[static_cast<std::size_t>(i)] - x_m) / half_m));
    v_.push_back(static_cast<Real>((sorted_.y_m[static_cast<std::size_t>(i)] - y_m) / half_m));
  }
  const int count = leaf.own.size();
  terms_.resize(std::max(terms_.size(), Size(kTerms, count)));
  FillTerms(count, u_.data(), v_.data(), count, terms_.data());
  return {kTerms, count, count, terms_.data()};
}

// Leaves from their positions, the others from their children.
template <class Real>
void TreeSums<Real>::GatherMoments() {
  const auto& leaves = NodesOf(leaf_level());
  for (int i = 0; i < static_cast<int>(leaves.size()); ++i) {
    const TreeNode& leaf = leaves[static_cast<std::size_t>(i)];
    AddProduct(TermsIn(leaf), width_, RowOf(h_, leaf.own.first, width_), Moments(leaf_level(), i));
  }
  for (int level = leaf_level() - 1; level >= kFirstLevel; --level) {
    for (int i = 0; i < static_cast<int>(NodesOf(level).size()); ++i) {
      const IndexRange& own = NodesOf(level)[static_cast<std::size_t>(i)].own;
      for (int c = own.first; c < own.end; ++c) {
        const TreeNode& child = NodesOf(level + 1)[static_cast<std::size_t>(c)];
        AddProduct(FarField<Real>::Get().ChildOf(child.x, child.y), width_, Moments(level + 1, c),
                   Moments(level, i));
      }
    }
  }
}

template <class Real>
void TreeSums<Real>::MeetFar() {
  const FarField<Real>& field = FarField<Real>::Get();
  std::vector<typename FarField<Real>::Meeting> meetings;
  for (int level = kFirstLevel; level <= leaf_level(); ++level) {
    const auto side = static_cast<Real>(side_m_ / (1 << level));  // the series is for boxes of side 1
    for (int i = 0; i < static_cast<int>(NodesOf(level).size()); ++i) {
      meetings.clear();
      ForEach(level, NodesOf(level)[static_cast<std::size_t>(i)], false, [&](int other, int dx, int dy) {
        meetings.push_back(field.MeetingAt(dx, dy, Moments(level, other)));
      });
      field.Meet(meetings, side, width_, Local(level, i));
    }
  }
}

// From boxes to their children, from leaves to their positions.
template <class Real>
void TreeSums<Real>::SpreadDown() {
  for (int level = kFirstLevel; level < leaf_level(); ++level) {
    for (int i = 0; i < static_cast<int>(NodesOf(level).size()); ++i) {
      const IndexRange& own = NodesOf(level)[static_cast<std::size_t>(i)].own;
      for (int c = own.first; c < own.end; ++c) {
        const TreeNode& child = NodesOf(level + 1)[static_cast<std::size_t>(c)];
        AddTransposed(FarField<Real>::Get().ChildOf(child.x, child.y), width_, Local(level, i),
                      Local(level + 1, c));
      }
    }
  }
  const auto& leaves = NodesOf(leaf_level());
  for (int i = 0; i < static_cast<int>(leaves.size()); ++i) {
    const TreeNode& leaf = leaves[static_cast<std::size_t>(i)];
    AddTransposed(TermsIn(leaf), width_, Local(leaf_level(), i), RowOf(sum_, leaf.own.first, width_));
  }
}

// Positions in near leaves; neighbours in the tree's order as one.
template <class Real>
std::vector<IndexRange> TreeSums<Real>::NearRanges(const TreeNode& leaf) const {
  std::vector<IndexRange> ranges, merged;
  ForEach(leaf_level(), leaf, true, [&](int other, int, int) {
    ranges.push_back(NodesOf(leaf_level())[static_cast<std::size_t>(other)].own);
  });
  std::ranges::sort(ranges, {}, &IndexRange::first);
  for (const IndexRange& range : ranges) {
    if (!merged.empty() && merged.back().end == range.first)
      merged.back().end = range.end;
    else
      merged.push_back(range);
  }
  return merged;
}

// Pairs of positions in near leaves, one by one.
template <class Real>
void TreeSums<Real>::MeetNear() {
  const Pairs pairs(sorted_, sorted_, {BeliefShape::kUniform, std::numeric_limits<double>::infinity()},
                    ErrorKind::kDistance);
  Columns<Real> columns;
  std::vector<Real> distance;
  for (const TreeNode& leaf : NodesOf(leaf_level())) {
    const std::vector<IndexRange> ranges = NearRanges(leaf);
    for (int first = leaf.own.first; first < leaf.own.end; first += kStripPositions) {
      const IndexRange strip{first, std::min(leaf.own.end, first + kStripPositions)};
      for (const IndexRange& range : ranges) {
        const int stride = (range.size() + kTileSamples - 1) / kTileSamples * kTileSamples;
        distance.resize(std::max(distance.size(), Size(kStripPositions, stride)));
        pairs.Fill(strip, {range, true}, stride, &columns, distance.data(), distance.data());
        AddProduct<Real>({strip.size(), range.size(), stride, distance.data()}, width_,
                         RowOf(h_, range.first, width_), RowOf(sum_, first, width_));
      }
    }
  }
}

template <class Real>
void TreeSums<Real>::Add(const Real* h, int width, Real* weighted) {
  Clear(width);
  const auto row = [&](auto* table, int i) {
    return table + static_cast<std::ptrdiff_t>(order_[static_cast<std::size_t>(i)]) * width;
  };
  for (int i = 0; i < sorted_.size(); ++i) std::copy_n(row(h, i), width, RowOf(h_, i, width));
  GatherMoments();
  MeetFar();
  SpreadDown();
  MeetNear();
  for (int i = 0; i < sorted_.size(); ++i) AddRow(width, RowOf(sum_, i, width), row(weighted, i));
}

template <class Real>
double TreeSums<Real>::NearPairs() const {
  double pairs = 0.0;
  for (const TreeNode& leaf : NodesOf(leaf_level()))
    for (const IndexRange& range : NearRanges(leaf))
      pairs += static_cast<double>(leaf.own.size()) * range.size();
  return pairs;
}

template <class Real>
double TreeSums<Real>::FarPairs() const {
  double pairs = 0.0;
  for (int level = kFirstLevel; level <= leaf_level(); ++level)
    for (const TreeNode& node : NodesOf(level)) ForEach(level, node, false, [&](int, int, int) { ++pairs; });
  return pairs;
}

template class TreeSums<float>;
template class TreeSums<double>;

}  // namespace cairn::landmark_learning
