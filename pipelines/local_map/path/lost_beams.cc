#include "pipelines/local_map/path/lost_beams.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "schema/error.h"

namespace cairn::local_map {
namespace {

constexpr double kGap_rad = 4.2 * std::numbers::pi / 180;
constexpr double kSpacings = 2.1;  // of beams that stand further apart than that: one may be lost

double WidestGap(std::span<const Pose> beams) {
  double widest = 0;
  for (std::size_t b = 1; b < beams.size(); ++b)
    widest = std::max(widest, std::abs(WrapAngle(beams[b].heading_rad - beams[b - 1].heading_rad)));
  return std::max(kGap_rad, kSpacings * widest);
}

}  // namespace

std::vector<bool> LostBeams(std::span<const Pose> beams, const std::vector<bool>& answered) {
  const std::size_t n = beams.size();
  CAIRN_DEMAND(answered.size() == n, "an answer, or none, for each beam");
  std::vector<bool> lost(n, false);
  const auto start = static_cast<std::size_t>(std::ranges::find(answered, true) - answered.begin());
  const double widest = WidestGap(beams);
  // Once around, from one that answered to the next: in a fan the gap behind it is too wide.
  for (std::size_t k = start; k < start + n && start < n;) {
    double gap = 0;
    std::size_t next = k;
    do {
      const Pose &here = beams[next % n], &there = beams[(next + 1) % n];
      gap += std::abs(WrapAngle(there.heading_rad - here.heading_rad));
      ++next;
    } while (!answered[next % n]);
    for (std::size_t b = k + 1; b < next; ++b) lost[b % n] = gap <= widest;
    k = next;
  }
  return lost;
}

}  // namespace cairn::local_map
