// A colour camera on the robot.
#pragma once

#include <cstdint>
#include <vector>

#include "datasets/simulate/corridor/shade.h"

namespace cairn::datasets::corridor {

// 8 bits of red, green, blue.
struct RgbImage {
  int rows = 0, columns = 0;
  std::vector<std::uint8_t> rgb;  // [rows][columns][3]
};

// Where it points: [Thr98]'s data sets D-1, D-2, D-3.
enum class Look : std::uint8_t { kOuter, kInner, kCeiling };

inline constexpr int kImageRows = 60, kImageColumns = 64;
inline constexpr double kCameraHeightM = 1.1;

struct View {
  RgbImage image;
  double door_share = 0, light_share = 0;  // of the image: what it truly shows
};

View TakeImage(const Scene& scene, const Shade& shade, const Snapshot& snapshot, Look look, Rng& rng);

}  // namespace cairn::datasets::corridor
