#include "datasets/simulate/corridor/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cairn::datasets::corridor {
namespace {

constexpr double kHalfViewRad = 36 * std::numbers::pi / 180;  // sideways
constexpr int kRays = 2;                                      // of a pixel, each way

// Unit vectors: into the image, to its right, up in it.
struct Frame {
  Vec3 into, right, up;
};

Frame FrameOf(Look look, double heading_rad) {
  const double c = std::cos(heading_rad), s = std::sin(heading_rad);
  switch (look) {
    case Look::kOuter:
      return {{-s, c, 0}, {c, s, 0}, {0, 0, 1}};
    case Look::kInner:
      return {{s, -c, 0}, {-c, -s, 0}, {0, 0, 1}};
    case Look::kCeiling:
      return {{0, 0, 1}, {s, -c, 0}, {c, s, 0}};
  }
  return {};
}

Vec3 RayOf(const Frame& frame, double right, double up) {
  return {frame.into.x + right * frame.right.x + up * frame.up.x,
          frame.into.y + right * frame.right.y + up * frame.up.y,
          frame.into.z + right * frame.right.z + up * frame.up.z};
}

bool IsDoor(const World& world, const Hit& hit) {
  if (hit.surface != Surface::kDoor && hit.surface != Surface::kWithin) return false;
  return world.walls[hit.side].openings[hit.index].kind == OpeningKind::kDoor;
}

std::uint8_t ToByte(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

// Of mean 0 and variance 1, all but normal: the sum of four bytes, for there are 11,520 a snapshot.
double RoughNormal(Rng& rng) {
  constexpr double kMean = 510, kDeviation = 147.8;  // of that sum; its variance is 4 (256^2 - 1) / 12
  const std::uint32_t bits = rng.Bits32();
  const std::uint32_t sum = (bits & 255) + (bits >> 8 & 255) + (bits >> 16 & 255) + (bits >> 24);
  return (sum - kMean) / kDeviation;
}

}  // namespace

View TakeImage(const Scene& scene, const Shade& shade, const Snapshot& snapshot, Look look, Rng& rng) {
  const Frame frame = FrameOf(look, snapshot.pose.heading_rad);
  const Vec3 from{snapshot.pose.x_m, snapshot.pose.y_m, kCameraHeightM};
  const std::vector<Pillar> pillars = scene.PillarsNear(from.x, snapshot.time_s);
  const double step = 2 * std::tan(kHalfViewRad) / (kImageColumns * kRays);
  constexpr double kPart = 1.0 / (kRays * kRays);
  View view{{kImageRows, kImageColumns, {}}, 0, 0};
  view.image.rgb.reserve(std::size_t{3} * kImageRows * kImageColumns);
  for (int row = 0; row < kImageRows; ++row) {
    for (int column = 0; column < kImageColumns; ++column) {
      Rgb sum;
      for (int ray = 0; ray < kRays * kRays; ++ray) {
        const int across = column * kRays + ray % kRays, down = row * kRays + ray / kRays;
        const double right = (across + 0.5 - 0.5 * kImageColumns * kRays) * step;
        const double up = -(down + 0.5 - 0.5 * kImageRows * kRays) * step;
        const Hit hit = scene.Cast(from, RayOf(frame, right, up), pillars);
        const Rgb colour = shade(hit);
        sum = {sum.r + colour.r, sum.g + colour.g, sum.b + colour.b};
        view.door_share += IsDoor(scene.world(), hit) ? kPart : 0;
        view.light_share += hit.surface == Surface::kCeiling && shade.IsLight(hit.at) ? kPart : 0;
      }
      for (const double value : {sum.r, sum.g, sum.b})
        view.image.rgb.push_back(ToByte(kPart * value + scene.run().noise * RoughNormal(rng)));
    }
  }
  view.door_share /= kImageRows * kImageColumns;
  view.light_share /= kImageRows * kImageColumns;
  return view;
}

}  // namespace cairn::datasets::corridor
