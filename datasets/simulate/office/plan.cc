#include "datasets/simulate/office/plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "datasets/simulate/office/furniture.h"

namespace cairn::datasets::office {
namespace {

constexpr double kThickM = 0.12;  // of walls
constexpr double kInnerDoorM = 1.0;
constexpr int kRoomsOfASide = 2;
constexpr double kBeforeTurnedM = 1.7;  // from the other rooms to the turned one's door

using Gaps = std::vector<std::pair<double, double>>;  // from, to: metres along a wall

// The wall from a to b but for its gaps.
void AddWall(Point a, Point b, const Gaps& gaps, Surface surface, std::vector<Obstacle>* obstacles) {
  const double length_m = DistanceM(a, b);
  std::vector<Part> open;
  for (const auto& [from_m, to_m] : gaps) open.push_back({from_m / length_m, to_m / length_m});
  std::vector<Wall> walls;
  AddOutside(a, b, std::move(open), walls);
  for (const Wall& wall : walls) obstacles->push_back({wall, surface});
}

Gaps InnerDoor(bool there) {
  if (!there) return {};
  return {{kLaneM - kInnerDoorM / 2, kLaneM + kInnerDoorM / 2}};
}

Gaps DoorOf(const Room& room) {
  return {{room.door_x_m - room.door_width_m / 2, room.door_x_m + room.door_width_m / 2}};
}

void AddRoom(const Room& room, std::vector<Obstacle>* obstacles) {
  const Point a = room.ToWorld({0, 0}), b = room.ToWorld({room.width_m, 0});
  const Point c = room.ToWorld({room.width_m, room.depth_m}), d = room.ToWorld({0, room.depth_m});
  AddWall(a, b, DoorOf(room), Surface::kPlain, obstacles);
  AddWall(b, c, InnerDoor(room.next.has_value()), Surface::kPlain, obstacles);
  AddWall(c, d, {}, Surface::kPlain, obstacles);
  AddWall(a, d, InnerDoor(room.door_from_last), Surface::kPlain, obstacles);
}

// The short walls between a door's two sides.
void AddPosts(const Office& office, std::vector<Obstacle>* obstacles) {
  for (const Room& room : office.rooms) {
    if (office.turned && &room == &office.rooms.back()) continue;  // it opens on the corridor as it is
    for (const auto& [from_m, to_m] : DoorOf(room)) {
      for (const double x : {from_m, to_m})
        obstacles->push_back({{room.ToWorld({x, -kThickM}), room.ToWorld({x, 0})}, Surface::kRough});
    }
    if (!room.next) continue;
    for (const auto& [from_m, to_m] : InnerDoor(true)) {
      for (const double y : {from_m, to_m})
        obstacles->push_back(
            {{room.ToWorld({room.width_m, y}), room.ToWorld({room.width_m + kThickM, y})}, Surface::kRough});
    }
  }
}

void AddCorridor(const Office& office, std::vector<Obstacle>* obstacles) {
  const double h = office.half_width_m, lean_m = office.turned ? h * std::tan(kTurnedRad) : 0;
  for (const double side : {1.0, -1.0}) {
    Gaps gaps;
    for (const Room& room : office.rooms) {
      if (office.turned && &room == &office.rooms.back()) continue;
      const Point door = room.ToWorld({room.door_x_m, 0});
      if (door.y_m * side < 0) continue;
      const double at_m = door.x_m - office.from_x_m;
      gaps.emplace_back(at_m - room.door_width_m / 2, at_m + room.door_width_m / 2);
    }
    AddWall({office.from_x_m, side * h}, {office.to_x_m - side * lean_m, side * h}, gaps, Surface::kMirror,
            obstacles);
  }
  AddWall({office.from_x_m, h}, {office.from_x_m, -h}, {}, Surface::kPlain, obstacles);
  if (!office.turned) AddWall({office.to_x_m, h}, {office.to_x_m, -h}, {}, Surface::kPlain, obstacles);
}

// Widths of a side's rooms; they add up to `length_m`, their walls included.
std::vector<double> DrawWidths(double length_m, Rng& rng) {
  std::vector<double> widths;
  double sum = 0;
  for (int i = 0; i < kRoomsOfASide; ++i) sum += widths.emplace_back(rng.Uniform(0.85, 1.15));
  for (double& width : widths) width *= (length_m - (kRoomsOfASide - 1) * kThickM) / sum;
  return widths;
}

// Clear of the lanes along the room's walls, and of the doors of the other side, so that all ways are along
// the walls.
void DrawDoor(const std::vector<Room>& others, Room* room, Rng& rng) {
  constexpr double kApartM = 0.7;
  constexpr int kMostDraws = 100;
  room->door_width_m = rng.Uniform(0.95, 1.05);
  for (int draw = 0; draw < kMostDraws; ++draw) {
    room->door_x_m = rng.Uniform(kLaneM + kApartM, room->width_m - kLaneM - kApartM);
    const double x = room->ToWorld({room->door_x_m, 0}).x_m;
    const bool apart = std::ranges::all_of(others, [&](const Room& other) {
      return std::abs(other.ToWorld({other.door_x_m, 0}).x_m - x) > kApartM;
    });
    if (apart) return;
  }
}

// In the order of its own x, which is the corridor's, or against it below the corridor.
void AddSide(bool above, double length_m, Office* office, Rng& rng) {
  const std::vector<double> widths = DrawWidths(length_m, rng);
  const double y = office->half_width_m + kThickM;
  double done_m = 0;
  for (int i = 0; i < kRoomsOfASide; ++i) {
    Room room;
    room.width_m = widths[static_cast<std::size_t>(i)];
    room.depth_m = rng.Uniform(4.0, 5.2);
    room.frame = above ? Pose{done_m, y, 0} : Pose{length_m - done_m, -y, std::numbers::pi};
    DrawDoor(office->rooms, &room, rng);
    done_m += room.width_m + kThickM;
    if (i == 0) room.next = office->rooms.size() + 1;
    room.door_from_last = i == 1;
    office->rooms.push_back(room);
  }
}

// The corridor ends in its wall, slantwise.
void AddTurned(Office* office, Rng& rng) {
  office->turned = true;
  office->to_x_m += kBeforeTurnedM;
  Room room;
  room.depth_m = rng.Uniform(4.0, 5.2);
  room.width_m = rng.Uniform(4.6, 5.2);
  room.door_x_m = room.width_m / 2;
  room.door_width_m = 2 * office->half_width_m / std::cos(kTurnedRad);
  const double heading = kTurnedRad - std::numbers::pi / 2;
  room.frame = {office->to_x_m - room.door_x_m * std::cos(heading), -room.door_x_m * std::sin(heading),
                heading};
  office->rooms.push_back(room);
}

}  // namespace

Point Room::ToWorld(Point local) const {
  const double c = std::cos(frame.heading_rad), s = std::sin(frame.heading_rad);
  return {frame.x_m + c * local.x_m - s * local.y_m, frame.y_m + s * local.x_m + c * local.y_m};
}

Point Room::ToLocal(Point world) const {
  const double c = std::cos(frame.heading_rad), s = std::sin(frame.heading_rad);
  const double x = world.x_m - frame.x_m, y = world.y_m - frame.y_m;
  return {c * x + s * y, -s * x + c * y};
}

Point Room::Before(double corridor_half_width_m) const {
  const bool square = std::abs(std::sin(frame.heading_rad)) < 0.1;
  return ToWorld({door_x_m, square ? -kThickM - corridor_half_width_m : 0});
}

double Office::WallsRad(Point at) const {
  if (!turned) return 0;
  const Point local = rooms.back().ToLocal(at);
  const bool inside =
      local.y_m > 0 && local.y_m < rooms.back().depth_m && local.x_m > 0 && local.x_m < rooms.back().width_m;
  return inside ? kTurnedRad : 0;
}

Office DrawOffice(bool turned, Rng& rng) {
  Office office;
  office.to_x_m = rng.Uniform(9.5, 11.5);
  office.from_x_m = -rng.Uniform(3.5, 5);
  office.half_width_m = rng.Uniform(1.05, 1.2);
  const double length_m = office.to_x_m;
  for (const bool above : {true, false}) AddSide(above, length_m, &office, rng);
  if (turned) AddTurned(&office, rng);
  for (Room& room : office.rooms) room.furniture = DrawFurniture(room, rng);
  office.cabinets = DrawCabinets(office, rng);
  return office;
}

void MoveFurniture(Office* office, Rng& rng) {
  for (Room& room : office->rooms) {
    std::array<bool, kPlaces> moves{};
    for (bool& move : moves) move = rng.Uniform() < 0.5;
    std::vector<Piece> now;
    for (const Piece& piece : room.furniture)
      if (!moves.at(piece.place)) now.push_back(piece);
    for (const Piece& piece : DrawFurniture(room, rng))
      if (moves.at(piece.place)) now.push_back(piece);
    room.furniture = now;
  }
}

std::vector<Obstacle> BuildingOf(const Office& office) {
  std::vector<Obstacle> obstacles;
  AddCorridor(office, &obstacles);
  for (const Room& room : office.rooms) AddRoom(room, &obstacles);
  AddPosts(office, &obstacles);
  return obstacles;
}

std::vector<Obstacle> FurnitureOf(const Office& office) {
  std::vector<Obstacle> obstacles;
  for (const Piece& cabinet : office.cabinets) AddSides(cabinet, Room{}, &obstacles);
  for (const Room& room : office.rooms) {
    for (const Piece& piece : room.furniture) AddSides(piece, room, &obstacles);
  }
  return obstacles;
}

std::vector<Wall> DoorsOf(const Office& office) {
  std::vector<Wall> doors;
  for (const Room& room : office.rooms) {
    for (const auto& [from_m, to_m] : DoorOf(room))
      doors.push_back({room.ToWorld({from_m, 0}), room.ToWorld({to_m, 0})});
    for (const auto& [from_m, to_m] : InnerDoor(room.next.has_value()))
      doors.push_back({room.ToWorld({room.width_m, from_m}), room.ToWorld({room.width_m, to_m})});
  }
  return doors;
}

}  // namespace cairn::datasets::office
