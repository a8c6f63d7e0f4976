#include "datasets/simulate/hall/world.h"

#include "datasets/simulate/sonar.h"

namespace cairn::datasets {

Hall BuildHall(const HallPlan& plan) {
  Hall hall;
  const double low = -plan.below_m, high = plan.above_m;
  const Point a{plan.from_x_m, low}, b{plan.to_x_m, low}, c{plan.to_x_m, high}, d{plan.from_x_m, high};
  (plan.smooth_below ? hall.smooth : hall.rough).push_back({a, b});
  hall.rough.push_back({b, c});
  hall.rough.push_back({d, a});
  double done_x = plan.from_x_m;
  for (const DoorPlan& door : plan.doors) {
    const Point left{door.centre_x_m - door.width_m / 2, high},
        right{door.centre_x_m + door.width_m / 2, high};
    hall.rough.push_back({{done_x, high}, left});
    done_x = right.x_m;
    hall.doors.push_back({left, right});
    hall.open.push_back(door.open);
    if (!door.open) hall.rough.push_back({left, right});
    const double back = high + door.room_depth_m;
    const double from = door.centre_x_m - door.room_half_width_m,
                 to = door.centre_x_m + door.room_half_width_m;
    hall.rooms.push_back({{from, high}, {from, back}});
    hall.rooms.push_back({{from, back}, {to, back}});
    hall.rooms.push_back({{to, back}, {to, high}});
  }
  hall.rough.push_back({{done_x, high}, c});
  return hall;
}

std::vector<Obstacle> ObstaclesOf(const Hall& hall) {
  std::vector<Obstacle> obstacles;
  for (const Wall& wall : hall.rough) obstacles.push_back({wall, Surface::kRough});
  for (const Wall& wall : hall.rooms) obstacles.push_back({wall, Surface::kBeyondDoor});
  for (const Wall& wall : hall.smooth) obstacles.push_back({wall, Surface::kMirror});
  return obstacles;
}

void PutHall(const Hall& hall, Blob& log) {
  std::vector<Wall> walls = hall.smooth;
  walls.insert(walls.end(), hall.rough.begin(), hall.rough.end());
  walls.insert(walls.end(), hall.rooms.begin(), hall.rooms.end());
  PutWalls(walls, log);
  std::vector<std::uint8_t> smooth(walls.size(), 0), open;
  for (std::size_t i = 0; i < hall.smooth.size(); ++i) smooth[i] = 1;
  for (const bool is_open : hall.open) open.push_back(is_open ? 1 : 0);
  log.PutVector("truth/walls/smooth", smooth);
  PutSegments("truth/doors/", hall.doors, log);
  log.PutVector("truth/doors/open", open);
}

}  // namespace cairn::datasets
