#include "pipelines/local_map/path/scan_motion.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "schema/kinds/log.h"
#include "schema/square.h"

namespace cairn::local_map {
namespace {

constexpr std::size_t kHits = 60;                   // of a scan that are compared
constexpr double kNear_m = 0.1, kNearRatio = 0.01;  // how far from what the first saw, and a metre of range
constexpr double kCoarse_m = 0.15;                  // further in a search whose steps are coarse
constexpr double kOneWall_m = 0.3, kOneWallRatio = 0.05;  // two neighbouring hits that close are of one wall
constexpr double kOneWallSpacings = 2.9;  // and those so many spacings of the rays apart, as a metre of range

double Distance2(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x_m - a.x_m, dy = b.y_m - a.y_m, length2 = dx * dx + dy * dy;
  const double along =
      length2 > 0 ? std::clamp(((p.x_m - a.x_m) * dx + (p.y_m - a.y_m) * dy) / length2, 0.0, 1.0) : 0;
  return Square(p.x_m - a.x_m - along * dx) + Square(p.y_m - a.y_m - along * dy);
}

// From what `view` saw at a beam and between it and its neighbours.
double FromSeen2(const LaserView& view, std::size_t beam, const Point& p, double range_m) {
  const Point& at = view.hits[beam];
  double least = Distance2(p, at, at);
  const double wall2 = Square(std::max(kOneWall_m + kOneWallRatio * range_m, view.one_wall_ratio * range_m));
  for (const std::size_t other : {beam - 1, beam + 1}) {
    if (other >= view.hits.size() || std::isnan(view.hits[other].x_m)) continue;
    const Point& next = view.hits[other];
    const bool one_wall = Square(next.x_m - at.x_m) + Square(next.y_m - at.y_m) < wall2;
    least = std::min(least, one_wall ? Distance2(p, at, next) : Distance2(p, next, next));
  }
  return least;
}

bool Looks(const LaserView& view, std::int16_t beam, double range_m) {
  const auto b = static_cast<std::size_t>(beam);
  return beam >= 0 && b >= view.first_beam && b <= view.last_beam && range_m < view.max_range_m;
}

ScanMotion Weighed(const LaserView& from, const LaserView& to, const Pose& moved, double more_m = 0) {
  const double c = std::cos(moved.heading_rad), s = std::sin(moved.heading_rad);
  double near = 0, looked = 0, in_view = 0;
  for (const Point& hit : to.some) {
    const Point p{moved.x_m + c * hit.x_m - s * hit.y_m, moved.y_m + s * hit.x_m + c * hit.y_m};
    const double dx = p.x_m - from.origin.x_m, dy = p.y_m - from.origin.y_m;
    const std::int16_t beam = from.beam_at[DirectionOf(std::atan2(dy, dx))];
    const double range_m = std::sqrt(dx * dx + dy * dy), within_m = kNear_m + kNearRatio * range_m + more_m;
    in_view += Looks(from, beam, range_m);
    if (beam < 0 || std::isnan(from.hits[static_cast<std::size_t>(beam)].x_m)) continue;
    ++looked;
    near += FromSeen2(from, static_cast<std::size_t>(beam), p, range_m) <= within_m * within_m;
  }
  // A motion that turns most hits out of sight is not explained by the few that are left.
  const auto all = static_cast<double>(to.some.size());
  const double tells = std::max(looked, all / 2);
  return {moved, tells > 0 ? near / tells : 0, tells, looked, all > 0 ? in_view / all : 0};
}

// Around `middle`, so many steps to either side.
struct Lattice {
  int turns = 0, ways = 0;
  double turn_rad = 0, way_m = 0, more_m = 0;
};

ScanMotion BestAround(const LaserView& from, const LaserView& to, const Pose& middle,
                      const Lattice& lattice) {
  ScanMotion best = Weighed(from, to, middle, lattice.more_m);
  for (int turn = -lattice.turns; turn <= lattice.turns; ++turn) {
    for (int x = -lattice.ways; x <= lattice.ways; ++x) {
      for (int y = -lattice.ways; y <= lattice.ways; ++y) {
        const ScanMotion motion = Weighed(from, to,
                                          {middle.x_m + x * lattice.way_m, middle.y_m + y * lattice.way_m,
                                           middle.heading_rad + turn * lattice.turn_rad},
                                          lattice.more_m);
        if (motion.share > best.share) best = motion;
      }
    }
  }
  return best;
}

constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

std::size_t DirectionOf(double angle_rad) {
  const double turns = angle_rad / (2 * std::numbers::pi) + 0.5;
  return std::min(kDirections - 1, static_cast<std::size_t>(turns * kDirections));
}

LaserFan::LaserFan(std::vector<Pose> beams, double max_range_m)
    : beams_(std::move(beams)), max_range_m_(max_range_m), beam_at_(kDirections, -1) {
  std::vector<double> spacings{0};
  for (std::size_t b = 1; b < beams_.size(); ++b)
    spacings.push_back(std::abs(WrapAngle(beams_[b].heading_rad - beams_[b - 1].heading_rad)));
  std::ranges::sort(spacings);
  const double spacing = spacings.back();
  one_wall_ratio_ = kOneWallSpacings * spacings[spacings.size() / 2];
  for (std::size_t d = 0; d < kDirections; ++d) {
    const double angle = ((static_cast<double>(d) + 0.5) / kDirections - 0.5) * 2 * std::numbers::pi;
    double least = spacing;
    for (std::size_t b = 0; b < beams_.size(); ++b) {
      const double off = std::abs(WrapAngle(beams_[b].heading_rad - angle));
      if (off > least) continue;
      least = off;
      beam_at_[d] = static_cast<std::int16_t>(b);
    }
  }
}

LaserView LaserFan::View(const RingScan& scan) const {
  LaserView view;
  view.beam_at = beam_at_;
  view.origin = {beams_.front().x_m, beams_.front().y_m};
  view.max_range_m = max_range_m_;
  view.one_wall_ratio = one_wall_ratio_;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::size_t count = 0;
  for (std::size_t b = 0; b < beams_.size(); ++b) {
    const double range = scan.range_m[b];
    const bool hit = range > 0 && kinds::IsEcho(range, max_range_m_);
    if (hit && count++ == 0) view.first_beam = b;
    if (hit) view.last_beam = b;
    view.hits.push_back(hit ? Point{beams_[b].x_m + range * std::cos(beams_[b].heading_rad),
                                    beams_[b].y_m + range * std::sin(beams_[b].heading_rad)}
                            : Point{kNone, kNone});
  }
  std::size_t k = 0;
  for (const Point& hit : view.hits) {
    if (std::isnan(hit.x_m)) continue;
    if (count <= kHits || k * kHits / count != (k + 1) * kHits / count) view.some.push_back(hit);
    ++k;
  }
  return view;
}

ScanMotion WeighMotion(const LaserView& from, const LaserView& to, const Pose& moved) {
  return Weighed(from, to, moved);
}

ScanMotion NearOdometry(const LaserView& from, const LaserView& to, const Pose& odometry, double explained) {
  const ScanMotion itself = Weighed(from, to, odometry);
  if (itself.share >= explained) return itself;
  const ScanMotion near =
      BestAround(from, to, odometry, {.turns = 3, .ways = 2, .turn_rad = 2 * kDegree, .way_m = 0.075});
  return BestAround(from, to, near.moved, {.turns = 2, .ways = 1, .turn_rad = kDegree / 2, .way_m = 0.05});
}

ScanMotion AnyMotion(const LaserView& from, const LaserView& to, const Pose& odometry, double most_rad,
                     double most_m) {
  constexpr double kTurn_rad = 4 * kDegree, kWay_m = 0.2;
  constexpr std::size_t kTurns = 3;
  std::vector<ScanMotion> turns;  // without a way, and with odometry's
  const int steps = static_cast<int>(most_rad / kTurn_rad);
  for (int turn = -steps; turn <= steps; ++turn) {
    const ScanMotion still = Weighed(from, to, {0, 0, turn * kTurn_rad}, kCoarse_m);
    const ScanMotion driven = Weighed(from, to, {odometry.x_m, odometry.y_m, turn * kTurn_rad}, kCoarse_m);
    turns.push_back(driven.share > still.share ? driven : still);
  }
  std::ranges::stable_sort(turns, std::ranges::greater{}, &ScanMotion::share);
  turns.resize(std::min(turns.size(), kTurns));
  turns.push_back({.moved = odometry});
  ScanMotion best;
  const int ways =
      static_cast<int>(std::ceil((most_m + std::hypot(odometry.x_m, odometry.y_m) / 2) / kWay_m));
  for (const ScanMotion& turn : turns) {
    const Pose middle{odometry.x_m / 2, odometry.y_m / 2, turn.moved.heading_rad};
    const ScanMotion found =
        BestAround(from, to, middle,
                   {.turns = 0, .ways = ways, .turn_rad = 0, .way_m = kWay_m, .more_m = kCoarse_m / 2});
    if (found.share > best.share) best = found;
  }
  const ScanMotion fine =
      BestAround(from, to, best.moved, {.turns = 2, .ways = 2, .turn_rad = 2 * kDegree, .way_m = 0.1});
  return BestAround(from, to, fine.moved, {.turns = 2, .ways = 1, .turn_rad = kDegree / 2, .way_m = 0.05});
}

}  // namespace cairn::local_map
