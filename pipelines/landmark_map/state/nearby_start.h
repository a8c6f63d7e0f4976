// Where a robot that may start anywhere starts in the next round, once rounds before have found it.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/landmark_map/model/e_step.h"
#include "pipelines/landmark_map/model/m_step.h"

namespace cairn::landmark_map {

// A heading's cells at a robot's first step.
struct StartBox {
  std::int32_t robot = 0, heading = 0;
  std::int32_t x0 = 0, y0 = 0, nx = 0, ny = 0;
  Box box() const { return {x0, y0, nx, ny}; }
  static void Fields(const auto& field) {
    field("robot", &StartBox::robot);
    field("heading", &StartBox::heading);
    field("x0", &StartBox::x0);
    field("y0", &StartBox::y0);
    field("nx", &StartBox::nx);
    field("ny", &StartBox::ny);
  }
};

// Throws InputError where a box is none of such a grid or of so many robots.
void CheckStart(const std::vector<StartBox>& start, std::int64_t robots, int headings);

// The boxes that hold all of a robot's first belief but what is a millionth of the likeliest pose.
std::vector<StartBox> SupportOf(const LayeredGrid& belief, int robot);

// `anywhere` (a box a heading) cut to what lies around `start`: within the distance over which landmarks
// contend and ten cells more, and within fifteen degrees. Where nothing is left, `anywhere`.
std::vector<Box> Nearby(const std::vector<Box>& anywhere, const std::vector<StartBox>& start,
                        const MapRules& rules);

}  // namespace cairn::landmark_map
