#include "pipelines/local_map/path/laser_agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipelines/local_map/path/motion_watch.h"

namespace cairn::local_map {
namespace {

constexpr double kLooked_m = 8;                   // beams lie too far apart beyond
constexpr double kSame_m = 0.12, kClose_m = 0.3;  // from a hit: as near as the same wall; in a coarse search
constexpr double kOneDegree = std::numbers::pi / 180;

double ViewOf(const ScaleWatch::Ring& ring) {
  double view_rad = 0;
  for (std::size_t b = 1; b < ring.beams.size(); ++b)
    view_rad += std::abs(WrapAngle(ring.beams[b].heading_rad - ring.beams[b - 1].heading_rad));
  return view_rad;
}

// Where its beams begin, on average.
Point PlaceOf(const ScaleWatch::Ring& ring) {
  Point place;
  for (const Pose& beam : ring.beams) {
    place.x_m += beam.x_m / static_cast<double>(ring.beams.size());
    place.y_m += beam.y_m / static_cast<double>(ring.beams.size());
  }
  return place;
}

// What a laser met, and what it saw free, over a part of the path.
class SeenAround {
 public:
  enum : std::uint8_t { kFree = 1, kNear = 2, kClose = 4, kHit = 8 };

  explicit SeenAround(const Point& middle)
      : box_{middle.x_m - kReach_m, middle.y_m - kReach_m, kCell_m, kCells, kCells},
        cells_(kCells * kCells, 0) {}

  void AddBeam(const Pose& beam, double range_m) {
    constexpr double kBefore_m = 0.2;
    const double c = std::cos(beam.heading_rad), s = std::sin(beam.heading_rad);
    for (double at_m = 0; at_m < std::min(range_m - kBefore_m, kLooked_m); at_m += kCell_m)
      Mark(box_.ColumnOf(beam.x_m + at_m * c), box_.RowOf(beam.y_m + at_m * s), kFree);
    if (range_m > kLooked_m) return;
    const std::int64_t column = box_.ColumnOf(beam.x_m + range_m * c),
                       row = box_.RowOf(beam.y_m + range_m * s);
    if (!box_.Holds(column, row) || (cells_[box_.Index(column, row)] & kHit) != 0) return;
    Mark(column, row, kHit);
    constexpr auto kDisc = static_cast<std::int64_t>(kClose_m / kCell_m);
    for (std::int64_t dy = -kDisc; dy <= kDisc; ++dy) {
      for (std::int64_t dx = -kDisc; dx <= kDisc; ++dx) {
        const double off_m = kCell_m * std::sqrt(static_cast<double>(dx * dx + dy * dy));
        if (off_m <= kClose_m) Mark(column + dx, row + dy, off_m <= kSame_m ? kNear | kClose : kClose);
      }
    }
  }
  // 0: nothing is known of it.
  std::uint8_t At(const Point& point) const {
    const std::int64_t column = box_.ColumnOf(point.x_m), row = box_.RowOf(point.y_m);
    return box_.Holds(column, row) ? cells_[box_.Index(column, row)] : 0;
  }

 private:
  static constexpr double kCell_m = 0.05, kReach_m = 14;
  static constexpr std::int64_t kCells = 560;

  void Mark(std::int64_t column, std::int64_t row, int as) {
    if (box_.Holds(column, row)) cells_[box_.Index(column, row)] |= static_cast<std::uint8_t>(as);
  }

  GridBox box_;
  std::vector<std::uint8_t> cells_;
};

// What the second laser met, on the robot.
struct Hit {
  double x_m, y_m, cos, sin;  // of the robot's pose
  Point at;
};

struct Part {
  SeenAround first;
  std::vector<Hit> second;
};

struct Count {
  std::int64_t met = 0, looked = 0;
  // The most that are met, and the fewest in what is free: where there are many walls, one may stand for
  // another.
  std::int64_t Score() const { return met - 2 * (looked - met); }
};

// With the second laser moved on the robot, about where it sits.
Count CountMet(const std::vector<Part>& parts, const Point& place, const Pose& moved, std::uint8_t where) {
  Count count;
  const double c = std::cos(moved.heading_rad), s = std::sin(moved.heading_rad);
  const double x_m = place.x_m + moved.x_m, y_m = place.y_m + moved.y_m;
  for (const Part& part : parts) {
    for (const Hit& hit : part.second) {
      const double dx = hit.at.x_m - place.x_m, dy = hit.at.y_m - place.y_m;
      const Point at{x_m + c * dx - s * dy, y_m + s * dx + c * dy};
      const std::uint8_t seen = part.first.At(
          {hit.x_m + hit.cos * at.x_m - hit.sin * at.y_m, hit.y_m + hit.sin * at.x_m + hit.cos * at.y_m});
      count.met += (seen & where) != 0;
      count.looked += (seen & (where | SeenAround::kFree)) != 0;
    }
  }
  return count;
}

struct Motion {
  Pose moved;
  Count count;
};

double SizeOf(const Pose& moved) { return std::hypot(moved.x_m, moved.y_m) + std::abs(moved.heading_rad); }

constexpr double kMostWay_m = 1.5;  // ahead or aside, that a laser may sit elsewhere

// Better and better by smaller and smaller steps.
Motion Climb(const std::vector<Part>& parts, const Point& place, Motion from, std::uint8_t where) {
  constexpr double kWay_m = 0.16, kTurn_rad = 2.5 * kOneDegree;
  constexpr int kSizes = 4, kMostSteps = 20;
  from.count = CountMet(parts, place, from.moved, where);
  for (int size = 0; size < kSizes; ++size) {
    const double part = std::pow(0.5, size), way_m = part * kWay_m, turn_rad = part * kTurn_rad;
    for (int step = 0; step < kMostSteps; ++step) {
      Motion best = from;
      for (const Pose& by : {Pose{way_m, 0, 0}, Pose{-way_m, 0, 0}, Pose{0, way_m, 0}, Pose{0, -way_m, 0},
                             Pose{0, 0, turn_rad}, Pose{0, 0, -turn_rad}}) {
        const Pose moved{from.moved.x_m + by.x_m, from.moved.y_m + by.y_m,
                         from.moved.heading_rad + by.heading_rad};
        if (std::max(std::abs(moved.x_m), std::abs(moved.y_m)) > kMostWay_m) continue;
        const Count count = CountMet(parts, place, moved, where);
        if (count.Score() > best.count.Score()) best = {moved, count};
      }
      if (best.count.Score() == from.count.Score()) break;
      from = best;
    }
  }
  return from;
}

// The motions that look best from afar, of any turn.
std::vector<Motion> Candidates(const std::vector<Part>& parts, const Point& place,
                               const std::function<void()>& tick) {
  constexpr int kTurns = 72;
  constexpr double kTurn_rad = 2 * std::numbers::pi / kTurns, kWay_m = 0.3;
  constexpr auto kWays = static_cast<int>(kMostWay_m / kWay_m);
  constexpr std::size_t kBest = 24;
  std::vector<Motion> all;
  for (int turn = 0; turn < kTurns; ++turn) {
    tick();
    for (int x = -kWays; x <= kWays; ++x) {
      for (int y = -kWays; y <= kWays; ++y) {
        const Pose moved{kWay_m * x, kWay_m * y, WrapAngle(kTurn_rad * turn)};
        all.push_back({moved, CountMet(parts, place, moved, SeenAround::kClose)});
      }
    }
  }
  std::ranges::stable_sort(all, [](const Motion& a, const Motion& b) {
    return a.count.Score() != b.count.Score() ? a.count.Score() > b.count.Score()
                                              : SizeOf(a.moved) < SizeOf(b.moved);
  });
  all.resize(std::min(all.size(), kBest));
  all.push_back({});
  return all;
}

// Of those that explain about the most the smallest.
Motion FindMotion(const std::vector<Part>& parts, const Point& place, const std::function<void()>& tick) {
  constexpr double kAbout = 0.02;
  std::vector<Motion> found = {{{}, CountMet(parts, place, {}, SeenAround::kNear)}};
  for (const Motion& from : Candidates(parts, place, tick)) {
    tick();
    found.push_back(Climb(parts, place, Climb(parts, place, from, SeenAround::kClose), SeenAround::kNear));
    found.push_back(Climb(parts, place, from, SeenAround::kNear));
  }
  std::int64_t most = std::numeric_limits<std::int64_t>::min();
  for (const Motion& motion : found) most = std::max(most, motion.count.Score());
  Motion best{{kLooked_m, 0, 0}, {}};
  for (const Motion& motion : found) {
    const double about = static_cast<double>(most) - kAbout * static_cast<double>(motion.count.looked);
    if (static_cast<double>(motion.count.Score()) >= about && SizeOf(motion.moved) < SizeOf(best.moved))
      best = motion;
  }
  return best;
}

// Scans [first, end) of the path, which five metres or a run end.
struct PathPart {
  std::size_t first, end;
};

std::vector<PathPart> CutPath(const std::vector<Scan>& path) {
  constexpr double kLong_m = 5;
  constexpr std::size_t kMost = 40;
  std::vector<PathPart> all;
  for (std::size_t s = 0; s < path.size(); ++s) {
    const bool goes_on = !all.empty() && path[s].run == path[all.back().first].run &&
                         path[s].path_m - path[all.back().first].path_m < kLong_m;
    if (goes_on)
      all.back().end = s + 1;
    else
      all.push_back({s, s + 1});
  }
  if (all.size() <= kMost) return all;
  std::vector<PathPart> some;
  for (std::size_t k = 0; k < kMost; ++k) some.push_back(all[k * all.size() / kMost]);
  return some;
}

// Lets pass the scans of a laser between which the robot moved.
class Thinning {
 public:
  bool Pass(const Pose& pose) {
    constexpr double kMoved_m = 0.08;
    constexpr double kTurned_rad = 4 * kOneDegree;
    if (passed_ > 0 && std::hypot(pose.x_m - last_.x_m, pose.y_m - last_.y_m) < kMoved_m &&
        std::abs(WrapAngle(pose.heading_rad - last_.heading_rad)) < kTurned_rad)
      return false;
    constexpr std::size_t kMost = 150;
    last_ = pose;
    return passed_++ < kMost;
  }

 private:
  std::size_t passed_ = 0;
  Pose last_;
};

// Calls `take` with each beam on the robot, and how far it reached, of those that met something; `most` of
// them, evenly.
template <class Take>
void EachHit(const ScaleWatch::Ring& ring, const RingScan& scan, std::size_t most, const Take& take) {
  constexpr double kWithin = 0.98;  // what is as far as any may be the sensor's reach
  const std::size_t step = (ring.beams.size() + most - 1) / most;
  for (std::size_t b = 0; b < scan.range_m.size(); b += step)
    if (const double range_m = scan.range_m[b]; range_m < kWithin * ring.max_range_m)
      take(Compose({0, 0, scan.turret_rad}, ring.beams[b]), range_m);
}

class Comparison {
 public:
  Comparison(const std::vector<ScaleWatch::Ring>& rings, std::size_t first, std::size_t second)
      : first_(first), second_(second), rings_(rings) {}

  void Add(const std::vector<Scan>& path, const PathPart& stretch, std::size_t most_hits,
           const std::function<std::span<const RingScan>(std::size_t)>& read) {
    constexpr std::size_t kFirstBeams = 360, kSecondBeams = 60;
    const Pose& middle = path[(stretch.first + stretch.end) / 2].pose;
    Part part{SeenAround({middle.x_m, middle.y_m}), {}};
    Thinning first_thinning, second_thinning;
    bool looked = false;
    for (std::size_t s = stretch.first; s < stretch.end; ++s) {
      const Pose& pose = path[s].pose;
      const std::span<const RingScan> scan = read(s);
      if (path[s].unsure) continue;
      if (!scan[first_].range_m.empty() && first_thinning.Pass(pose)) {
        looked = true;
        EachHit(rings_[first_], scan[first_], kFirstBeams,
                [&](const Pose& beam, double range_m) { part.first.AddBeam(Compose(pose, beam), range_m); });
      }
      if (!scan[second_].range_m.empty() && second_thinning.Pass(pose))
        EachHit(rings_[second_], scan[second_], kSecondBeams, [&](const Pose& beam, double range_m) {
          if (range_m > kLooked_m) return;
          const Pose at = Compose(beam, {range_m, 0, 0});
          part.second.push_back(
              {pose.x_m, pose.y_m, std::cos(pose.heading_rad), std::sin(pose.heading_rad), {at.x_m, at.y_m}});
        });
    }
    if (!looked || part.second.empty()) return;
    const std::size_t hits = part.second.size();
    if (hits > most_hits) {
      for (std::size_t k = 0; k < most_hits; ++k) part.second[k] = part.second[k * hits / most_hits];
      part.second.resize(most_hits);
    }
    parts_.push_back(std::move(part));
  }

  LaserAgreement Result(const std::function<void()>& tick) const {
    const Point place = PlaceOf(rings_[second_]);
    const Count as_is = CountMet(parts_, place, {}, SeenAround::kNear);
    LaserAgreement all{.first = static_cast<std::int32_t>(first_),
                       .second = static_cast<std::int32_t>(second_),
                       .looked = as_is.looked,
                       .share = ShareOf(as_is)};
    if (as_is.looked == 0) return all;
    const Motion motion = FindMotion(parts_, place, tick);
    all.moved_looked = motion.count.looked;
    all.moved_share = ShareOf(motion.count);
    all.moved_m = std::hypot(motion.moved.x_m, motion.moved.y_m);
    all.moved_rad = std::abs(WrapAngle(motion.moved.heading_rad));
    return all;
  }

 private:
  static double ShareOf(const Count& count) {
    return count.looked > 0 ? static_cast<double>(count.met) / static_cast<double>(count.looked) : 0;
  }

  std::size_t first_, second_;
  const std::vector<ScaleWatch::Ring>& rings_;
  std::vector<Part> parts_;
};

}  // namespace

std::vector<LaserAgreement> CompareLasers(const std::vector<ScaleWatch::Ring>& rings,
                                          const std::vector<Scan>& path,
                                          const std::function<std::span<const RingScan>(std::size_t)>& read,
                                          const std::function<void()>& tick) {
  constexpr std::size_t kMostHits = 4000;
  std::vector<LaserAgreement> all;
  const std::vector<PathPart> stretches = CutPath(path);
  for (std::size_t a = 0; a < rings.size(); ++a) {
    for (std::size_t b = a + 1; b < rings.size(); ++b) {
      if (!IsLaser(rings[a]) || !IsLaser(rings[b])) continue;
      const bool b_wider = ViewOf(rings[b]) > ViewOf(rings[a]);
      Comparison comparison(rings, b_wider ? b : a, b_wider ? a : b);
      for (const PathPart& stretch : stretches) {
        tick();
        comparison.Add(path, stretch, kMostHits / stretches.size(), read);
      }
      if (const LaserAgreement agreement = comparison.Result(tick); agreement.looked > 0)
        all.push_back(agreement);
    }
  }
  return all;
}

}  // namespace cairn::local_map
