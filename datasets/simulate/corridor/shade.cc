#include "datasets/simulate/corridor/shade.h"

#include <algorithm>
#include <cmath>

namespace cairn::datasets::corridor {
namespace {

constexpr double kLightStepM = 0.1;
constexpr Rgb kLightBrown{0.76, 0.65, 0.50}, kOrange{0.86, 0.47, 0.19};

Rgb Times(const Rgb& c, double by) { return {c.r * by, c.g * by, c.b * by}; }
Rgb Times(const Rgb& c, const Rgb& d) { return {c.r * d.r, c.g * d.g, c.b * d.b}; }
Rgb Mix(const Rgb& a, const Rgb& b, double share_b) {
  return {a.r + share_b * (b.r - a.r), a.g + share_b * (b.g - a.g), a.b + share_b * (b.b - a.b)};
}

// In [0, 1), of a lattice point: the finaliser of M. O'Neill's PCG family serves as a hash.
double Lattice(int i, int j, std::uint32_t seed) {
  std::uint32_t h =
      seed ^ (static_cast<std::uint32_t>(i) * 0x9E3779B9U) ^ (static_cast<std::uint32_t>(j) * 0x85EBCA6BU);
  h = ((h >> ((h >> 28) + 4)) ^ h) * 277803737U;
  h = (h >> 22) ^ h;
  h = ((h >> ((h >> 28) + 4)) ^ h) * 277803737U;
  return static_cast<double>((h >> 22) ^ h) / 4294967296.0;
}

// Smooth between lattice points, in [0, 1).
double Noise(double u, double v, std::uint32_t seed) {
  const double fu = std::floor(u), fv = std::floor(v);
  const int i = static_cast<int>(fu), j = static_cast<int>(fv);
  const double a = u - fu, b = v - fv, s = a * a * (3 - 2 * a), t = b * b * (3 - 2 * b);
  const double low = Lattice(i, j, seed) * (1 - s) + Lattice(i + 1, j, seed) * s;
  const double high = Lattice(i, j + 1, seed) * (1 - s) + Lattice(i + 1, j + 1, seed) * s;
  return low * (1 - t) + high * t;
}

// Dirt and wear: round 1.
double Worn(double u, double v, std::uint32_t seed) {
  return 0.86 + 0.18 * Noise(0.7 * u, 0.9 * v, seed) + 0.10 * Noise(5 * u, 5 * v, seed + 1);
}

bool IsOrange(const Wall& wall, double x_m) {
  return std::ranges::any_of(wall.orange, [&](const Stretch& s) { return x_m >= s.x0_m && x_m < s.x1_m; });
}

double ToEdge(double x, double x0, double x1) { return std::min(x - x0, x1 - x); }

}  // namespace

Shade::Shade(const Scene& scene) : scene_(&scene) {
  const World& world = scene.world();
  const Run& run = scene.run();
  for (double x = -kCornerM; x < world.length_m + kCornerM + kLightStepM; x += kLightStepM) {
    double lamps = 0, day = 0;
    for (std::size_t i = 0; i < world.lamps.size(); ++i) {
      const double d = (x - world.lamps[i].x_m) / 1.9;
      if (run.lamp_on[i]) lamps += std::exp(-d * d);
    }
    for (const struct Panel& panel : world.walls[kOuter].panels) {
      const double d = x - (panel.x0_m + panel.x1_m) / 2;
      if (panel.kind == PanelKind::kWindow) day += std::exp(-std::abs(d) / 2.5);
    }
    light_.push_back(run.brightness * (0.5 + 0.7 * lamps + 0.7 * run.daylight * day));
  }
}

double Shade::LightAt(double x_m) const {
  const double at = std::clamp((x_m + kCornerM) / kLightStepM, 0.0, static_cast<double>(light_.size() - 1));
  return light_[static_cast<std::size_t>(at)];
}

Rgb Shade::Lit(const Rgb& colour, const Vec3& at) const {
  return Times(colour, LightAt(at.x) * (0.72 + 0.28 * at.z / kHeightM));
}

Rgb Shade::Wall(const Hit& hit) const {
  const struct Wall& wall = scene_->world().walls[hit.side];
  Rgb colour = IsOrange(wall, hit.at.x) ? kOrange : kLightBrown;
  if (hit.at.z < 0.12)
    colour = {0.22, 0.19, 0.17};
  else if (std::abs(hit.at.z - 0.92) < 0.035)
    colour = Times(colour, 0.7);  // a rail
  return Lit(Times(colour, Worn(hit.at.x, hit.at.z, wall.texture)), hit.at);
}

Rgb Shade::Panel(const Hit& hit) const {
  const struct Panel& panel = scene_->world().walls[hit.side].panels[hit.index];
  const double x = hit.at.x, z = hit.at.z;
  const double edge = std::min(ToEdge(x, panel.x0_m, panel.x1_m), ToEdge(z, panel.z0_m, panel.z1_m));
  switch (panel.kind) {
    case PanelKind::kWindow: {
      const bool frame = edge < 0.06 || std::abs(x - (panel.x0_m + panel.x1_m) / 2) < 0.03;
      if (frame) return Lit(panel.ink, hit.at);
      return Times(panel.colour, scene_->run().daylight * (0.55 + 0.45 * (z - panel.z0_m)));
    }
    case PanelKind::kBlackboard:
      if (edge < 0.05) return Lit({0.5, 0.36, 0.2}, hit.at);
      return Lit(Mix(panel.colour, panel.ink, Noise(9 * x, 14 * z, panel.texture) > 0.74 ? 0.6 : 0.06),
                 hit.at);
    case PanelKind::kPoster:
      if (edge < 0.03) return Lit({0.9, 0.9, 0.87}, hit.at);
      return Lit(Noise(6 * x, 6 * z, panel.texture) > 0.55 ? panel.ink : panel.colour, hit.at);
    case PanelKind::kSign:
      return Lit(edge < 0.03 ? panel.ink : panel.colour, hit.at);
  }
  return {};
}

Rgb Shade::Door(const Hit& hit) const {
  const Opening& door = scene_->world().walls[hit.side].openings[hit.index];
  const double x = hit.at.x, z = hit.at.z, middle = (door.x0_m + door.x1_m) / 2;
  const double edge = std::min(ToEdge(x, door.x0_m, door.x1_m), door.height_m - z);
  const bool is_double = door.x1_m - door.x0_m > 1.25;
  if (edge < 0.07) return Lit(Times(door.colour, 0.6), hit.at);
  if (is_double && std::abs(x - middle) < 0.02) return Lit({0.05, 0.05, 0.05}, hit.at);
  const double handle_x = is_double ? middle + 0.1 : door.x1_m - 0.16;
  if (std::hypot(x - handle_x, z - 1.03) < 0.05) return Lit({0.85, 0.85, 0.8}, hit.at);
  if (door.has_pane && std::abs(x - middle) < 0.16 && std::abs(z - 1.55) < 0.2)
    return Lit({0.5, 0.58, 0.62}, hit.at);
  return Lit(Times(door.colour, Worn(x, z, scene_->world().texture)), hit.at);
}

Rgb Shade::Within(const Hit& hit) const {
  const Opening& opening = scene_->world().walls[hit.side].openings[hit.index];
  const double depth = std::abs(hit.at.y) - kHalfWidthM;
  const Rgb colour = opening.kind == OpeningKind::kDoor ? opening.room : opening.colour;
  const double shelf = 0.75 + 0.5 * Noise(2 * hit.at.x, 2.5 * hit.at.z, scene_->world().texture + 7);
  return Times(colour, scene_->run().brightness * shelf * (0.35 + 0.6 * std::exp(-depth / 2.5)));
}

int Shade::LampAt(const Vec3& at) const {
  if (std::abs(at.y) > kLampWidthM / 2) return -1;
  const std::vector<Lamp>& lamps = scene_->world().lamps;
  const auto lamp = std::ranges::lower_bound(lamps, at.x - kLampLengthM / 2, {}, &Lamp::x_m);
  return lamp != lamps.end() && lamp->x_m <= at.x + kLampLengthM / 2 ? static_cast<int>(lamp - lamps.begin())
                                                                     : -1;
}

bool Shade::IsLight(const Vec3& at) const {
  const int lamp = LampAt(at);
  return lamp >= 0 && scene_->run().lamp_on[static_cast<std::size_t>(lamp)];
}

Rgb Shade::Ceiling(const Vec3& at) const {
  const World& world = scene_->world();
  if (const int lamp = LampAt(at); lamp >= 0) {
    const auto i = static_cast<std::size_t>(lamp);
    return scene_->run().lamp_on[i] ? Times(world.lamps[i].tint, 1.5 * scene_->run().brightness)
                                    : Rgb{0.62, 0.62, 0.6};
  }
  const auto to_joint = [](double u) { return std::abs(u / kTileM - std::round(u / kTileM)) * kTileM; };
  Rgb colour = to_joint(at.x) < 0.012 || to_joint(at.y + kTileM / 2) < 0.012 ? Rgb{0.5, 0.5, 0.48}
                                                                             : Rgb{0.80, 0.79, 0.75};
  auto tile = std::ranges::lower_bound(world.tiles, at.x - kTileM / 2, {}, &Tile::x_m);
  for (; tile != world.tiles.end() && tile->x_m <= at.x + kTileM / 2; ++tile) {
    if (std::abs(at.y - tile->y_m) > kTileM / 2) continue;
    const bool slot = tile->grille && std::fmod(at.x + 100, 0.1) < 0.05;
    colour = slot ? Rgb{0.15, 0.15, 0.15} : tile->colour;
  }
  // The light that walls throw back.
  for (const Side side : {kOuter, kInner}) {
    const double near = 0.5 + (side == kOuter ? 0.5 : -0.5) * at.y / kHalfWidthM;
    const Rgb paint = IsOrange(world.walls[side], at.x) ? kOrange : kLightBrown;
    colour = Times(colour, Mix({1, 1, 1}, Times(paint, 1 / paint.r), 0.3 * near));
  }
  return Times(colour, 0.62 * LightAt(at.x) * Worn(at.x, at.y, world.texture + 3));
}

Rgb Shade::Floor(const Vec3& at) const {
  const bool dark =
      (static_cast<int>(std::floor(at.x / 0.4)) + static_cast<int>(std::floor(at.y / 0.4))) % 2 == 0;
  return Times(dark ? Rgb{0.40, 0.38, 0.35} : Rgb{0.46, 0.44, 0.41}, 0.75 * LightAt(at.x));
}

Rgb Shade::Person(const Hit& hit) const {
  const struct Person& person = scene_->run().people[hit.index];
  const double z = hit.at.z / person.height_m;
  const Rgb colour = z > 0.96   ? Rgb{0.15, 0.1, 0.07}
                     : z > 0.86 ? person.skin
                     : z > 0.48 ? person.shirt
                                : person.trousers;
  return Lit(colour, hit.at);
}

Rgb Shade::operator()(const Hit& hit) const {
  Rgb colour;
  switch (hit.surface) {
    case Surface::kWall:
      colour = Wall(hit);
      break;
    case Surface::kPanel:
      colour = Panel(hit);
      break;
    case Surface::kDoor:
      colour = Door(hit);
      break;
    case Surface::kWithin:
      colour = Within(hit);
      break;
    case Surface::kReveal:
      colour = Lit({0.3, 0.27, 0.24}, hit.at);
      break;
    case Surface::kFloor:
      colour = Floor(hit.at);
      break;
    case Surface::kCeiling:
      colour = Ceiling(hit.at);
      break;
    case Surface::kEnd:
      colour = Lit(kLightBrown, hit.at);
      break;
    case Surface::kPerson:
      colour = Person(hit);
      break;
    case Surface::kBin:
      colour = Lit(scene_->run().bins[hit.index].colour, hit.at);
      break;
  }
  return Times(colour, scene_->run().white);
}

}  // namespace cairn::datasets::corridor
