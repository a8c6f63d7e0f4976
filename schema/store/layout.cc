#include "schema/store/layout.h"

#include <algorithm>
#include <array>
#include <utility>

namespace cairn::store {
namespace {

constexpr std::int64_t kChunkBytes = 1 << 20;

// Longer endings first where one is the end of another.
constexpr std::array<std::pair<std::string_view, std::string_view>, 15> kUnits{{
    {"_rad_per_sqrt_m", "rad/sqrt(m)"},
    {"_rad_per_m", "rad/m"},
    {"_per_m", "1/m"},
    {"_radps", "rad/s"},
    {"_mps", "m/s"},
    {"_rad2", "rad^2"},
    {"_m2", "m^2"},
    {"_rad", "rad"},
    {"_deg", "deg"},
    {"_hz", "Hz"},
    {"_bytes", "byte"},
    {"_px", "px"},
    {"_nats", "nat"},
    {"_m", "m"},
    {"_s", "s"},
}};

}  // namespace

std::string UnitOf(std::string_view name) {
  const std::string_view last = name.substr(name.rfind('/') + 1);
  for (const auto& [ending, unit] : kUnits) {
    if (last.ends_with(ending) || last == ending.substr(1)) return std::string(unit);
  }
  return "1";
}

bool UnitContradicts(std::string_view name, const std::string& unit) {
  constexpr std::array kOthers = {"mm", "cm", "km", "ft",  "feet",    "in",  "inch",
                                  "us", "ms", "ns", "min", "degrees", "km/h"};
  const std::string own = UnitOf(name);
  if (own == "1" || unit == own) return false;
  return std::ranges::find(kOthers, unit) != kOthers.end() ||
         std::ranges::find(kUnits, unit, &std::pair<std::string_view, std::string_view>::second) !=
             kUnits.end();
}

Shape ChunksOf(const Shape& shape, std::size_t item_bytes) {
  Shape chunks = shape;
  auto inner = static_cast<std::int64_t>(item_bytes);  // bytes of all steps along the axis at hand
  for (const std::int64_t n : shape) inner *= n;
  for (std::size_t axis = 0; axis < shape.size() && inner > kChunkBytes; ++axis) {
    const std::int64_t step = inner / shape[axis];
    const std::int64_t most = std::clamp<std::int64_t>(kChunkBytes / step, 1, shape[axis]);
    const std::int64_t count = (shape[axis] + most - 1) / most;
    chunks[axis] = (shape[axis] + count - 1) / count;
    inner = step * chunks[axis];
  }
  return chunks;
}

bool DeflatePays(const Array& array) {
  const std::size_t size = array.bytes().size(), needed = size / 4 * 3;
  if (size < (1U << 16)) return false;
  std::size_t zeros = 0, left = size;
  array.TakeInPieces([&](std::span<const std::byte> piece) {
    for (constexpr std::size_t kAtOnce = 1 << 16; !piece.empty() && zeros + left >= needed;) {
      const auto part = piece.first(std::min(kAtOnce, piece.size()));
      zeros += static_cast<std::size_t>(std::ranges::count(part, std::byte{0}));
      left -= part.size();
      piece = piece.subspan(part.size());
    }
    return zeros + left >= needed;
  });
  return zeros >= needed;
}

}  // namespace cairn::store
