#include "datasets/simulate/corridor/world.h"

#include <algorithm>
#include <cmath>

namespace cairn::datasets::corridor {
namespace {

// Spacings and shares that were tuned until doors and lights localise as [Thr98] reports (docs/corridor.md).
constexpr double kOuterDoorM = 0.95, kInnerDoorM = 1.7;
constexpr double kBareShare = 0.10, kOfficeSpacingM = 3.2;
constexpr double kInnerSpacingM = 44, kInnerPairM = 7.5;
constexpr double kLampSpacingM = 5;

constexpr Rgb kDoorPaint{0.30, 0.36, 0.47}, kDoorWood{0.36, 0.22, 0.13};

Rgb Vary(const Rgb& colour, double by, Rng& rng) {
  const double all = 1 + by * rng.Normal();
  const auto one = [&](double c) { return std::clamp(c * (all + 0.4 * by * rng.Normal()), 0.02, 1.0); };
  return {one(colour.r), one(colour.g), one(colour.b)};
}

Rgb AnyColour(Rng& rng) { return {rng.Uniform(0.1, 0.95), rng.Uniform(0.1, 0.95), rng.Uniform(0.1, 0.95)}; }

bool IsFree(const Wall& wall, double x0, double x1, double margin_m) {
  const auto clear = [&](const auto& thing) {
    return thing.x1_m + margin_m <= x0 || x1 + margin_m <= thing.x0_m;
  };
  return std::ranges::all_of(wall.openings, clear) && std::ranges::all_of(wall.panels, clear);
}

void AddDoor(double middle_m, double width_m, Wall* wall, Rng& rng) {
  Opening door{.kind = OpeningKind::kDoor,
               .x0_m = middle_m - width_m / 2,
               .x1_m = middle_m + width_m / 2,
               .height_m = kDoorHeightM,
               .colour = Vary(rng.Uniform() < 0.75 ? kDoorPaint : kDoorWood, 0.1, rng),
               .room = Vary({0.62, 0.62, 0.58}, 0.25, rng),
               .open_ratio = rng.Uniform() < 0.6 ? 0.04 : 0.45,
               .has_pane = rng.Uniform() < 0.3};
  if (IsFree(*wall, door.x0_m, door.x1_m, 0.3)) wall->openings.push_back(door);
}

// Offices, door by door, but for a stretch at one end that has none.
void AddOuterDoors(double length_m, Wall* wall, Rng& rng) {
  const double bare_m = kBareShare * length_m;
  const bool bare_first = rng.Uniform() < 0.5;
  const double from = bare_first ? bare_m : 4.5, to = length_m - (bare_first ? 4.5 : bare_m);
  for (double x = from + rng.Uniform(0, 2); x < to; x += kOfficeSpacingM * rng.Uniform(0.6, 1.4))
    AddDoor(x, kOuterDoorM, wall, rng);
}

// Of large rooms, of which most have two.
void AddInnerDoors(double length_m, Wall* wall, Rng& rng) {
  const int rooms = std::max(1, static_cast<int>(std::lround(length_m / kInnerSpacingM)));
  for (int i = 0; i < rooms; ++i) {
    const double middle = length_m * (i + 0.5 + rng.Uniform(-0.15, 0.15)) / rooms;
    AddDoor(middle - kInnerPairM / 2, kInnerDoorM, wall, rng);
    if (rng.Uniform() < 0.9) AddDoor(middle + kInnerPairM / 2, kInnerDoorM, wall, rng);
  }
}

void AddInnerOpenings(double length_m, Wall* wall, Rng& rng) {
  const Rgb walls{0.60, 0.52, 0.42};
  for (const double x : {-kCornerM + 0.2, length_m + 0.2}) {
    wall->openings.push_back({OpeningKind::kCorner, x, x + kCornerM - 0.4, kHeightM, walls, walls, 0, false});
  }
  const double hallway = length_m * rng.Uniform(0.28, 0.42), elevator = length_m * rng.Uniform(0.58, 0.72);
  wall->openings.push_back({OpeningKind::kHallway, hallway, hallway + 2.2, kHeightM, walls, walls, 0, false});
  wall->openings.push_back(
      {OpeningKind::kElevator, elevator, elevator + 1.3, 2.15, {0.68, 0.69, 0.72}, {}, 0, false});
}

void AddPanel(Panel panel, double length_m, Wall* wall, Rng& rng) {
  const double width = panel.x1_m - panel.x0_m;
  panel.texture = rng.Bits32();
  for (int i = 0; i < 60; ++i) {
    panel.x0_m = rng.Uniform(0, length_m - width);
    panel.x1_m = panel.x0_m + width;
    if (!IsFree(*wall, panel.x0_m, panel.x1_m, 0.12)) continue;
    wall->panels.push_back(panel);
    return;
  }
}

void AddPanels(double length_m, Wall* wall, Rng& rng) {
  const auto count = [&](double spacing_m) { return static_cast<int>(length_m / spacing_m); };
  for (int i = 0; i < count(22); ++i) {
    AddPanel({PanelKind::kBlackboard,
              0,
              rng.Uniform(1.4, 2.6),
              0.85,
              1.95,
              Vary({0.10, 0.17, 0.13}, 0.15, rng),
              {0.75, 0.77, 0.74},
              0},
             length_m, wall, rng);
  }
  for (int i = 0; i < count(7); ++i) {
    const double z = rng.Uniform(0.95, 1.25);
    AddPanel({PanelKind::kPoster, 0, rng.Uniform(0.4, 1.1), z, z + rng.Uniform(0.5, 0.8), AnyColour(rng),
              AnyColour(rng), 0},
             length_m, wall, rng);
  }
  for (int i = 0; i < count(15); ++i) {
    const double z = rng.Uniform(0.9, 1.4);
    AddPanel({PanelKind::kSign,
              0,
              rng.Uniform(0.18, 0.35),
              z,
              z + rng.Uniform(0.2, 0.5),
              Vary({0.80, 0.10, 0.08}, 0.1, rng),
              {0.9, 0.9, 0.9},
              0},
             length_m, wall, rng);
  }
}

void AddWindows(double length_m, Wall* wall) {
  for (const double x : {0.9, length_m - 2.9})
    wall->panels.push_back({PanelKind::kWindow, x, x + 2.0, 0.9, 2.2, {0.8, 0.9, 1.0}, {0.85, 0.85, 0.8}, 0});
}

// Three stretches, in a third of the corridor each: a quarter of the wall.
void PaintOrange(double length_m, Wall* wall, Rng& rng) {
  const double third = length_m / 3, part = length_m / 12;
  for (int i = 0; i < 3; ++i) {
    const double x0 = i * third + rng.Uniform(0, third - part);
    wall->orange.push_back({x0, x0 + part});
  }
}

void HangLamps(World* world, Rng& rng) {
  const double first = rng.Uniform(1.5, 3.5);
  for (double x = first; x < world->length_m - 0.5; x += kLampSpacingM)
    world->lamps.push_back({x + 0.1 * rng.Normal(), Vary({1.0, 0.97, 0.88}, 0.05, rng)});
  // One or two are irregular: shifted.
  const std::uint64_t odd = 1 + rng.Below(2);
  for (std::uint64_t i = 0; i < odd; ++i) {
    Lamp& lamp = world->lamps[1 + rng.Below(world->lamps.size() - 2)];
    lamp.x_m += (rng.Uniform() < 0.5 ? -1 : 1) * rng.Uniform(0.9, 1.5);
  }
  std::ranges::sort(world->lamps, {}, &Lamp::x_m);
}

void LayTiles(World* world, Rng& rng) {
  const auto tiles = static_cast<int>(world->length_m / 1.6);
  for (int i = 0; i < tiles; ++i) {
    const double x = kTileM * (std::floor(rng.Uniform(0, world->length_m) / kTileM) + 0.5);
    const double y = kTileM * static_cast<double>(rng.Below(3)) - kTileM;
    const bool grille = rng.Uniform() < 0.35;
    const Rgb stained = Vary({0.70, 0.66, 0.56}, 0.12, rng);
    world->tiles.push_back({x, y, grille ? Rgb{0.52, 0.53, 0.54} : stained, grille});
  }
  std::ranges::sort(world->tiles, {}, &Tile::x_m);
}

void PlaceBins(World* world, Rng& rng) {
  const std::uint64_t bins = 3 + rng.Below(2);
  for (std::uint64_t i = 0; i < bins; ++i) {
    const double side = rng.Uniform() < 0.5 ? 1 : -1;
    const double x =
        world->length_m * (static_cast<double>(i) + rng.Uniform(0.2, 0.8)) / static_cast<double>(bins);
    world->bins.push_back({x, side * (kHalfWidthM - 0.25), Vary({0.25, 0.27, 0.30}, 0.2, rng)});
  }
}

}  // namespace

World DrawWorld(double length_m, Rng& rng) {
  World world;
  world.length_m = length_m;
  world.texture = rng.Bits32();
  Wall& outer = world.walls[kOuter];
  Wall& inner = world.walls[kInner];
  AddWindows(length_m, &outer);
  AddOuterDoors(length_m, &outer, rng);
  AddInnerOpenings(length_m, &inner, rng);
  AddInnerDoors(length_m, &inner, rng);
  for (Wall& wall : world.walls) {
    AddPanels(length_m, &wall, rng);
    PaintOrange(length_m, &wall, rng);
    wall.texture = rng.Bits32();
  }
  HangLamps(&world, rng);
  LayTiles(&world, rng);
  PlaceBins(&world, rng);
  return world;
}

}  // namespace cairn::datasets::corridor
