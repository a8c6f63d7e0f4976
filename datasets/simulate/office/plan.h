// An office: rooms on both sides of a corridor with metallic walls, as [DM98] has them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "datasets/simulate/echo.h"
#include "schema/geometry.h"
#include "schema/rng.h"

namespace cairn::datasets::office {

inline constexpr std::size_t kPlaces = 8;
inline constexpr double kLaneM = 1.1;  // from a room's walls to the way that a robot drives along them

// A box on the floor.
struct Piece {
  Point centre;
  double length_m = 1, depth_m = 0.4, angle_rad = 0;
  std::size_t place = 0;  // at which wall of its room, or in the middle: one of kPlaces
};

// In its own frame a room lies at x from 0 to width_m and y from 0 to depth_m, the corridor below it.
struct Room {
  Pose frame;
  double width_m = 5, depth_m = 4.5;
  double door_x_m = 2.5, door_width_m = 1;  // to the corridor
  std::optional<std::size_t> next;          // to which there is a door in the wall at width_m, at y = kLaneM
  bool door_from_last = false;              // there is one in the wall at 0
  std::vector<Piece> furniture;

  Point ToWorld(Point local) const;
  Point ToLocal(Point world) const;
  // Where one stands in the corridor, before its door.
  Point Before(double corridor_half_width_m) const;
};

// The corridor lies along x, its axis at y = 0.
struct Office {
  double from_x_m = -4, to_x_m = 10;
  double half_width_m = 1.1;
  std::vector<Room> rooms;
  std::vector<Piece> cabinets;  // in the corridor
  bool turned = false;          // the last room lies at the corridor's end, turned by kTurnedRad

  // Direction of the walls about a place, modulo pi/2.
  double WallsRad(Point at) const;
};

inline constexpr double kTurnedRad = 0.5235987755982988;  // 30 degrees

// Two rooms on each side of the corridor's last part, joined by a door. `turned`: and one at the far end.
Office DrawOffice(bool turned, Rng& rng);

// About half of the rooms' furniture is taken away, and other furniture stands in its places.
void MoveFurniture(Office* office, Rng& rng);

// Walls, and furniture after them. Corridor walls are mirrors for sound, walls of rooms plain, the rest
// rough.
std::vector<Obstacle> BuildingOf(const Office& office);
std::vector<Obstacle> FurnitureOf(const Office& office);
std::vector<Wall> DoorsOf(const Office& office);

}  // namespace cairn::datasets::office
