#include "pipelines/landmark_map/state/nearby_start.h"

#include <algorithm>
#include <cmath>

#include "pipelines/common/handed_over.h"

namespace cairn::landmark_map {

void CheckStart(const std::vector<StartBox>& start, std::int64_t robots, int headings) {
  constexpr std::int64_t kFarthest = 1 << 28;  // cells
  for (const StartBox& at : start) {
    RequireWithin("the robot of a start", std::int64_t{at.robot}, 0, robots - 1);
    RequireWithin("the heading of a start", std::int64_t{at.heading}, 0, std::int64_t{headings} - 1);
    for (const std::int32_t corner : {at.x0, at.y0})
      RequireWithin("the place of a start", std::int64_t{corner}, -kFarthest, kFarthest);
    for (const std::int32_t edge : {at.nx, at.ny})
      RequireWithin("the cells of a start", std::int64_t{edge}, 1, kFarthest);
  }
}

std::vector<StartBox> SupportOf(const LayeredGrid& belief, int robot) {
  constexpr double kUnlikely = 1e-6;
  const double least = kUnlikely * belief.Max();
  std::vector<StartBox> start;
  for (std::size_t c = 0; c < belief.layers.size(); ++c) {
    Layer likely = belief.layers[c];
    likely.Prune(least);
    const Box& box = likely.box;
    if (!box.empty()) start.push_back({robot, static_cast<std::int32_t>(c), box.x0, box.y0, box.nx, box.ny});
  }
  return start;
}

std::vector<Box> Nearby(const std::vector<Box>& anywhere, const std::vector<StartBox>& start,
                        const MapRules& rules) {
  constexpr double kHeadings = 15.0 / 360.0;  // of the circle, to either side
  constexpr int kCells = 10;
  const int headings = rules.grid.headings;
  const int reach = static_cast<int>(std::ceil(kHeadings * headings));
  const int margin = static_cast<int>(std::ceil(rules.radius_m / rules.grid.cell_m)) + kCells;
  std::vector<Box> near(anywhere.size());
  for (const StartBox& at : start) {
    for (int k = -reach; k <= reach; ++k) {
      Box& box = near[static_cast<std::size_t>((at.heading + k + headings) % headings)];
      box = Union(box, at.box().Grown(margin));
    }
  }
  for (std::size_t c = 0; c < near.size(); ++c) near[c] = Intersection(near[c], anywhere[c]);
  const bool any = std::ranges::any_of(near, [](const Box& box) { return !box.empty(); });
  return any ? near : anywhere;
}

}  // namespace cairn::landmark_map
