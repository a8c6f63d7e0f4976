#include "datasets/simulate/office/furniture.h"

#include <array>
#include <cmath>
#include <numbers>

namespace cairn::datasets::office {
namespace {

constexpr double kCornerM = 0.55;  // of a wall, left free for the shelf of the other one
constexpr double kClearM = 0.55;   // from a lane to what stands in the middle
constexpr double kShelfChance = 0.8, kTableChance = 0.75;
constexpr std::size_t kTable = 6, kChair = 7;  // places; walls are before them
constexpr double kSideBoardM = 0.35;

// A shelf against the wall from `a`, `length_m` long in the direction `angle_rad`, the room to its left.
// Where the wall is too short none.
void AddShelf(std::size_t place, Point a, double length_m, double angle_rad, Rng& rng,
              std::vector<Piece>* pieces) {
  const double shelf_m = rng.Uniform(0.8, 1.8), depth_m = rng.Uniform(0.3, 0.5), at = rng.Uniform();
  const double free_m = length_m - 2 * kCornerM - shelf_m;
  if (free_m < 0 || rng.Uniform() > kShelfChance) return;
  const double along_m = kCornerM + at * free_m + shelf_m / 2;
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  pieces->push_back({{a.x_m + c * along_m - s * depth_m / 2, a.y_m + s * along_m + c * depth_m / 2},
                     shelf_m,
                     depth_m,
                     angle_rad,
                     place});
}

// Within the lanes.
void AddMiddle(const Room& room, Rng& rng, std::vector<Piece>* pieces) {
  const double x0 = kLaneM + kClearM, x1 = room.width_m - kLaneM - kClearM;
  const double y0 = kLaneM + kClearM, y1 = room.depth_m - kLaneM - kClearM;
  const double chair_m = rng.Uniform(0.4, 0.5), chair_rad = rng.Uniform(0, std::numbers::pi / 2);
  const double length_m = rng.Uniform(0.7, 1.4), depth_m = rng.Uniform(0.5, 0.8);
  const double x = rng.Uniform(), y = rng.Uniform(), chair_x = rng.Uniform(), chair_y = rng.Uniform();
  const bool table = rng.Uniform() < kTableChance;
  if (table && length_m < x1 - x0 && depth_m < y1 - y0) {
    pieces->push_back(
        {{x0 + length_m / 2 + x * (x1 - x0 - length_m), y0 + depth_m / 2 + y * (y1 - y0 - depth_m)},
         length_m,
         depth_m,
         0,
         kTable});
  }
  const double reach_m = chair_m * std::numbers::sqrt2 / 2;
  if (2 * reach_m < x1 - x0 && 2 * reach_m < y1 - y0) {
    pieces->push_back(
        {{x0 + reach_m + chair_x * (x1 - x0 - 2 * reach_m), y0 + reach_m + chair_y * (y1 - y0 - 2 * reach_m)},
         chair_m,
         chair_m,
         chair_rad,
         kChair});
  }
}

}  // namespace

std::vector<Piece> DrawFurniture(const Room& room, Rng& rng) {
  constexpr double kQuarter = std::numbers::pi / 2;
  const double w = room.width_m, d = room.depth_m, door_m = room.door_width_m / 2 + 0.1;
  const double lane_end_m = kLaneM + kCornerM;  // inner doors lie before it
  std::vector<Piece> pieces;
  AddShelf(0, {room.door_x_m + door_m, 0}, w - room.door_x_m - door_m, 0, rng, &pieces);
  AddShelf(1, {0, 0}, room.door_x_m - door_m, 0, rng, &pieces);
  AddShelf(2, {w, lane_end_m}, d - lane_end_m, kQuarter, rng, &pieces);
  AddShelf(3, {w, d}, w / 2, 2 * kQuarter, rng, &pieces);
  AddShelf(4, {w / 2, d}, w / 2, 2 * kQuarter, rng, &pieces);
  AddShelf(5, {0, d}, d - lane_end_m, 3 * kQuarter, rng, &pieces);
  AddMiddle(room, rng, &pieces);
  return pieces;
}

std::vector<Piece> DrawCabinets(const Office& office, Rng& rng) {
  std::vector<Piece> cabinets;
  for (const double side : {1.0, -1.0}) {
    const double length_m = rng.Uniform(0.7, 1.2);
    const double x = rng.Uniform(office.from_x_m + 1, office.to_x_m - 3);
    bool clear = true;
    for (const Room& room : office.rooms) {
      const Point door = room.ToWorld({room.door_x_m, 0});
      clear = clear && (door.y_m * side < 0 || std::abs(door.x_m - x) > length_m / 2 + room.door_width_m);
    }
    const double y = side * (office.half_width_m - kSideBoardM / 2);
    if (clear) cabinets.push_back({{x, y}, length_m, kSideBoardM, 0, 0});
  }
  return cabinets;
}

void AddSides(const Piece& piece, const Room& room, std::vector<Obstacle>* obstacles) {
  const double c = std::cos(piece.angle_rad), s = std::sin(piece.angle_rad);
  std::array<Point, 4> corners;
  constexpr std::array<double, 4> kAlong{-0.5, 0.5, 0.5, -0.5}, kAcross{-0.5, -0.5, 0.5, 0.5};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double along = kAlong[i] * piece.length_m, across = kAcross[i] * piece.depth_m;
    corners[i] =
        room.ToWorld({piece.centre.x_m + c * along - s * across, piece.centre.y_m + s * along + c * across});
  }
  for (std::size_t i = 0; i < corners.size(); ++i)
    obstacles->push_back({{corners[i], corners[(i + 1) % corners.size()]}, Surface::kRough});
}

}  // namespace cairn::datasets::office
