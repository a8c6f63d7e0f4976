#include "datasets/simulate/world.h"

#include <algorithm>
#include <array>

namespace cairn::datasets {
namespace {

constexpr double kCycleWidthM = 60;
constexpr double kCycleHeightM = 25;
constexpr double kBendM = 0.5;  // how far a node may lie off its corridor's axis

class LoopBuilder {
 public:
  explicit LoopBuilder(Rng& rng) : rng_(rng) {}

  CorridorWorld Build() {
    left_m_ = 15 + rng_.Uniform(-2, 2);
    bottom_m_ = 32.5 + rng_.Uniform(-2, 2);
    AddCycle();
    AddLongSideBranches();
    AddBranch(kRight, {rng_.Uniform(9, 12), 0}, "dead end");
    AddBranch(kLeft, {-rng_.Uniform(9, 12), 0}, "dead end");
    for (auto& list : world_.neighbours) std::sort(list.begin(), list.end());
    return std::move(world_);
  }

 private:
  // Places round the cycle, counter-clockwise from the lower left corner.
  static constexpr std::size_t kBottom = 1, kRight = 5, kTop = 7, kLeft = 11;

  std::size_t AddNode(Point at, const std::string& kind) {
    const auto before = std::count_if(world_.names.begin(), world_.names.end(),
                                      [&](const std::string& name) { return name.starts_with(kind); });
    world_.nodes.push_back(at);
    world_.names.push_back(kind + " " + std::to_string(before));
    world_.neighbours.emplace_back();
    return world_.nodes.size() - 1;
  }

  void Join(std::size_t a, std::size_t b) {
    world_.neighbours[a].push_back(b);
    world_.neighbours[b].push_back(a);
  }

  // Three places along a long side, a quarter apart, each moved by at most 2.5 m.
  std::array<double, 3> DrawAlong() {
    std::array<double, 3> along{};
    for (std::size_t i = 0; i < along.size(); ++i) {
      along[i] = kCycleWidthM * static_cast<double>(i + 1) / 4 + rng_.Uniform(-2.5, 2.5);
    }
    return along;
  }

  void AddCycleNode(double along_m, double up_m, const char* kind) {
    AddNode(
        {left_m_ + along_m + rng_.Uniform(-kBendM, kBendM), bottom_m_ + up_m + rng_.Uniform(-kBendM, kBendM)},
        kind);
  }

  void AddCycle() {
    AddCycleNode(0, 0, "corner");
    for (const double along : DrawAlong()) AddCycleNode(along, 0, "junction");
    AddCycleNode(kCycleWidthM, 0, "corner");
    AddCycleNode(kCycleWidthM, rng_.Uniform(9, 16), "junction");
    AddCycleNode(kCycleWidthM, kCycleHeightM, "corner");
    for (const double along : DrawAlong()) AddCycleNode(kCycleWidthM - along, kCycleHeightM, "junction");
    AddCycleNode(0, kCycleHeightM, "corner");
    AddCycleNode(0, rng_.Uniform(9, 16), "junction");
    world_.cycle_nodes = world_.nodes.size();
    for (std::size_t i = 0; i < world_.cycle_nodes; ++i) Join(i, (i + 1) % world_.cycle_nodes);
  }

  std::size_t AddBranch(std::size_t from, Point offset, const std::string& kind) {
    const Point at = world_.nodes[from];
    const std::size_t end = AddNode({at.x_m + offset.x_m, at.y_m + offset.y_m}, kind);
    Join(from, end);
    return end;
  }

  // Downwards from the bottom side and upwards from the top side; one neighbouring pair joins at its ends.
  void AddLongSideBranches() {
    const std::size_t loop_side = rng_.Below(2);
    const std::size_t loop_first = rng_.Below(2);
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      const double sign = side == 0 ? -1 : 1;
      const std::size_t first = side == 0 ? kBottom : kTop;
      const double loop_length_m = rng_.Uniform(13, 18);
      std::vector<std::size_t> loop_ends;
      for (std::size_t i = 0; i < 3; ++i) {
        const bool in_loop = side == loop_side && (i == loop_first || i == loop_first + 1);
        const double length_m = in_loop ? loop_length_m : rng_.Uniform(10, 20);
        const Point offset{rng_.Uniform(-kBendM, kBendM), sign * length_m};
        const std::size_t end = AddBranch(first + i, offset, in_loop ? "corner" : "dead end");
        if (in_loop) loop_ends.push_back(end);
      }
      if (loop_ends.size() == 2) Join(loop_ends[0], loop_ends[1]);
    }
  }

  Rng& rng_;
  CorridorWorld world_;
  double left_m_ = 0;
  double bottom_m_ = 0;
};

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> CorridorWorld::Edges() const {
  std::vector<std::pair<std::size_t, std::size_t>> edges;
  for (std::size_t a = 0; a < neighbours.size(); ++a) {
    for (const std::size_t b : neighbours[a]) {
      if (a < b) edges.emplace_back(a, b);
    }
  }
  return edges;
}

CorridorWorld MakeLoopWorld(double box_m, Rng& rng) {
  CorridorWorld world = LoopBuilder(rng).Build();
  for (Point& node : world.nodes) {
    node.x_m *= box_m / kLoopBoxM;
    node.y_m *= box_m / kLoopBoxM;
  }
  return world;
}

}  // namespace cairn::datasets
