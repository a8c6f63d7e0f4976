// The corridor of [Thr98] section 5.1.1, as a simulator draws it: what stays the same from run to run.
//
// Frame: x along the corridor from 0 to its length, y to the left of a robot that drives along x, z up. The
// outer wall is at y = kHalfWidthM, the inner one at -kHalfWidthM.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "schema/rng.h"

namespace cairn::datasets::corridor {

inline constexpr double kHalfWidthM = 1.4;
inline constexpr double kHeightM = 2.6;
inline constexpr double kCornerM = 2.6;  // beyond either end, where the corridor turns towards the inner side
inline constexpr double kDoorHeightM = 2.1;

struct Rgb {
  double r = 0, g = 0, b = 0;  // 0 to 1
};

enum Side : std::uint8_t { kOuter, kInner };

// What one can look, or walk, into.
enum class OpeningKind : std::uint8_t { kDoor, kElevator, kHallway, kCorner };

struct Opening {
  OpeningKind kind = OpeningKind::kDoor;
  double x0_m = 0, x1_m = 0, height_m = 0;
  Rgb colour;             // of the door, or of the walls within
  Rgb room;               // behind a door
  double open_ratio = 0;  // of the runs in which a door is open
  bool has_pane = false;  // a door with a small window
};

enum class PanelKind : std::uint8_t { kWindow, kBlackboard, kPoster, kSign };

// What hangs flat on a wall.
struct Panel {
  PanelKind kind = PanelKind::kPoster;
  double x0_m = 0, x1_m = 0, z0_m = 0, z1_m = 0;
  Rgb colour, ink;
  std::uint32_t texture = 0;
};

struct Stretch {
  double x0_m = 0, x1_m = 0;
};

struct Wall {
  std::vector<Opening> openings;
  std::vector<Panel> panels;
  std::vector<Stretch> orange;
  std::uint32_t texture = 0;
};

struct Lamp {
  double x_m = 0;
  Rgb tint;
};

// A tile of the ceiling that looks different.
struct Tile {
  double x_m = 0, y_m = 0;  // its middle
  Rgb colour;
  bool grille = false;
};

struct Bin {
  double x_m = 0, y_m = 0;
  Rgb colour;
};

struct World {
  double length_m = 0;
  std::array<Wall, 2> walls;  // by Side
  std::vector<Lamp> lamps;    // by x_m, as are the tiles
  std::vector<Tile> tiles;
  std::vector<Bin> bins;
  std::uint32_t texture = 0;
};

inline constexpr double kLampLengthM = 1.2, kLampWidthM = 0.6, kTileM = 0.6;

// `length_m`: at least 30.
World DrawWorld(double length_m, Rng& rng);

}  // namespace cairn::datasets::corridor
