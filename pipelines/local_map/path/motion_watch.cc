#include "pipelines/local_map/path/motion_watch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace cairn::local_map {
namespace {

constexpr double kDeg = std::numbers::pi / 180;
// Over a short time a turn is less than half a circle, over a longer one a slow one shows; over the longest
// the place looks alike only where odometry hardly moves.
struct WatchOf {
  double over_s, most_m,
      most_rad;  // when two scans are compared: after so long, or such a motion by odometry
};
constexpr std::array<WatchOf, 3> kWatches{
    {{0.4, 1.2, 40 * kDeg}, {1.5, 1.2, 40 * kDeg}, {5.0, 0.4, 20 * kDeg}}};
constexpr std::size_t kLeastBeams = 30;
constexpr double kTells = 20;    // hits, at least
constexpr double kInView = 0.5;  // of a scan: what a narrow fan turned away from tells nothing

constexpr double kExplained = 0.8;  // of a scan: nothing else is looked for
constexpr double kGain = 0.2;       // of a scan that odometry does not explain and another motion does
constexpr double kSeen = 0.85, kTurn_rad = 10 * kDeg, kWay_m = 0.15;

constexpr double kHole_s = 2, kHoleRatio = 8;  // and so many times the usual
constexpr double kNews = 0.1, kStands_m = 0.3, kStands_rad = 15 * kDeg;
constexpr double kLong_s = 30;  // persons come and go meanwhile: such a hole is judged as a step is
constexpr double kMeets = 0.7;  // of a scan, where the other side of a hole may have been changed
// Of a scan another place explains less; over a longer way a room may be out of sight.
constexpr double kElsewhere = 0.5, kStep_m = 0.6, kStep_rad = 40 * kDeg;
constexpr double kFastest_mps = 0.8, kMostSlip_m = 1.2, kSlip_s = 3;  // that a robot is carried
constexpr double kMostTurn_rad = 60 * kDeg;

// Whether the scans say otherwise than that motion.
bool Contradicts(const ScanMotion& near) {
  return near.tells >= kTells && near.in_view >= kInView && near.share < kExplained;
}

}  // namespace

bool IsLaser(const ScaleWatch::Ring& ring) {
  return ring.opening_rad == 0 && ring.beams.size() >= kLeastBeams;
}

std::optional<std::size_t> LaserOfMostBeams(const std::vector<ScaleWatch::Ring>& rings) {
  std::optional<std::size_t> most;
  for (std::size_t r = 0; r < rings.size(); ++r)
    if (IsLaser(rings[r]) && (!most || rings[r].beams.size() > rings[*most].beams.size())) most = r;
  return most;
}

MotionWatch::MotionWatch(const std::vector<ScaleWatch::Ring>& rings) : before_(kWatches.size()) {
  const auto laser = LaserOfMostBeams(rings);
  if (!laser) return;
  ring_ = *laser;
  fan_.assign(1, LaserFan(rings[ring_].beams, rings[ring_].max_range_m));
}

void MotionWatch::Update(std::int64_t scan, double time_s, const Pose& pose, bool unsure,
                         std::span<const RingScan> read, bool own) {
  if (fan_.empty() || read[ring_].range_m.empty()) return;
  const bool is_long = time_s - last_s_ >= kLong_s, is_hole = EndsHole(time_s);
  if (unsure && !is_hole) {
    last_pose_ = pose;
    return;
  }
  Seen now{.scan = scan, .time_s = time_s, .pose = pose, .view = {}};
  std::int64_t compared = -1;  // the scan that it was compared with
  for (std::size_t w = 0; w < before_.size(); ++w) {
    Seen& before = before_[w];
    const Pose odometry = before.scan < 0 ? Pose() : Between(before.pose, pose);
    const bool due = before.scan < 0 || is_hole || time_s - before.time_s >= kWatches[w].over_s ||
                     std::hypot(odometry.x_m, odometry.y_m) > kWatches[w].most_m ||
                     std::abs(odometry.heading_rad) > kWatches[w].most_rad;
    if (!due) continue;
    if (now.view.hits.empty()) now.view = fan_.front().View(read[ring_]);
    if (before.scan >= 0 && own && before.scan != compared) {
      if (is_hole && !is_long && w == 0)
        CompareOverHole(before, now);
      else if (!is_hole)
        Compare(static_cast<std::int32_t>(w), before, now);
      if (w == 0) compared = before.scan;
    }
    before = now;
    if (w > 0) continue;
    if (is_hole && !is_long) last_.clear();
    if (last_.size() == 4) last_.erase(last_.begin());
    last_.push_back(now);
    if (own) CompareOverStep();
  }
  last_pose_ = pose;
}

bool MotionWatch::EndsHole(double time_s) {
  const bool is_first = before_[0].scan < 0;
  const double since_s = time_s - last_s_;
  last_s_ = time_s;
  if (is_first) return false;
  if (usual_s_ > 0 && since_s > std::max(kHole_s, kHoleRatio * usual_s_)) return true;
  usual_s_ = usual_s_ > 0 ? std::lerp(usual_s_, since_s, kNews) : since_s;
  return false;
}

void MotionWatch::Compare(std::int32_t watch, const Seen& before, const Seen& now) {
  const Pose odometry = Between(before.pose, now.pose);
  if (std::abs(odometry.heading_rad) > kMostTurn_rad) return;
  const ScanMotion near = NearOdometry(before.view, now.view, odometry, kExplained);
  if (!Contradicts(near)) return;
  const double over_s = now.time_s - before.time_s;
  const ScanMotion any =
      AnyMotion(before.view, now.view, odometry, kMostTurn_rad, std::min(kMostSlip_m, kFastest_mps * over_s));
  if (any.share < kSeen || any.share - near.share < kGain) return;
  const double turn = std::abs(any.moved.heading_rad - near.moved.heading_rad),
               way = std::hypot(any.moved.x_m - odometry.x_m, any.moved.y_m - odometry.y_m);
  if (turn > kTurn_rad || (way > kWay_m && over_s <= kSlip_s))
    found_.push_back({watch, before.scan, now.scan, any.moved, odometry, false, false});
}

// Where odometry moved meanwhile, it went on counting.
void MotionWatch::CompareOverHole(const Seen& before, const Seen& now) {
  const Pose meanwhile = Between(last_pose_, now.pose);
  if (std::hypot(meanwhile.x_m, meanwhile.y_m) > kStands_m || std::abs(meanwhile.heading_rad) > kStands_rad)
    return;
  const ScanMotion near = NearOdometry(before.view, now.view, Between(before.pose, now.pose), kExplained);
  if (Contradicts(near)) ReportHole(before, now, near);
}

void MotionWatch::CompareOverStep() {
  if (last_.size() < 4) return;
  const auto near = [&](std::size_t from, std::size_t to) {
    return NearOdometry(last_[from].view, last_[to].view, Between(last_[from].pose, last_[to].pose),
                        kExplained);
  };
  const Pose step = Between(last_[1].pose, last_[2].pose);
  if (std::hypot(step.x_m, step.y_m) > kStep_m || std::abs(step.heading_rad) > kStep_rad) return;
  // A person before the laser spoils one scan; another place all of them, and none of those before or after.
  const ScanMotion over = near(1, 2);
  for (const auto& [from, to] : {std::pair{1, 2}, {0, 2}, {1, 3}, {0, 3}}) {
    const ScanMotion pair = near(static_cast<std::size_t>(from), static_cast<std::size_t>(to));
    // What a narrow fan turned away from tells of no other place.
    if (pair.looked < kTells || pair.share * pair.tells >= kElsewhere * pair.looked) return;
  }
  if (near(0, 1).share >= kExplained && near(2, 3).share >= kExplained) ReportHole(last_[1], last_[2], over);
}

void MotionWatch::ReportHole(const Seen& before, const Seen& now, const ScanMotion& near) {
  const Pose odometry = Between(before.pose, now.pose);
  const ScanMotion any = AnyMotion(before.view, now.view, odometry, kMostTurn_rad, kMostSlip_m);
  const bool meets = any.share >= kMeets && any.share - near.share >= kGain;
  found_.push_back({0, before.scan, now.scan, meets ? any.moved : odometry, odometry, true, meets});
}

namespace {

constexpr double kLeastTurn_rad = 35 * kDeg, kLeast_m = 0.5;  // less does not harm a map

bool Follows(const Pose& path, const Pose& seen) {
  return std::hypot(path.x_m - seen.x_m, path.y_m - seen.y_m) < kLeast_m &&
         std::abs(WrapAngle(path.heading_rad - seen.heading_rad)) < kLeastTurn_rad;
}

// The contradictions of one watch, each with the one before where they follow each other.
std::vector<Disagreement> ChainsOf(std::size_t watch, const std::vector<Contradiction>& found,
                                   const std::vector<Scan>& scans) {
  std::vector<Disagreement> chains;
  Point apart, odometry_apart;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Contradiction& c = found[i];
    if (c.watch != static_cast<std::int32_t>(watch)) continue;
    const Scan &from = scans.at(static_cast<std::size_t>(c.from)),
               &to = scans.at(static_cast<std::size_t>(c.to));
    const Pose path = Between(from.pose, to.pose);
    if (c.meets && Follows(path, c.seen)) continue;
    const bool follows = !chains.empty() && !c.hole && !chains.back().hole &&
                         from.time_s - chains.back().until_s <= 2 * kWatches[watch].over_s;
    if (!follows) {
      chains.emplace_back().from_s = from.time_s;
      apart = odometry_apart = {};
    }
    Disagreement& chain = chains.back();
    const auto add = [&](const Pose& other, Point* sum) {
      const Pose off =
          Compose({0, 0, chain.scans_turn_rad}, {c.seen.x_m - other.x_m, c.seen.y_m - other.y_m, 0});
      *sum = {sum->x_m + off.x_m, sum->y_m + off.y_m};
    };
    add(path, &apart);
    add(c.odometry, &odometry_apart);
    chain.until_s = to.time_s;
    chain.hole = c.hole;
    chain.scans_turn_rad += c.seen.heading_rad;
    chain.odometry_turn_rad += c.odometry.heading_rad;
    chain.path_turn_rad += path.heading_rad;
    chain.apart_m = std::hypot(apart.x_m, apart.y_m);
    chain.odometry_apart_m = std::hypot(odometry_apart.x_m, odometry_apart.y_m);
    chain.of.push_back(i);
  }
  return chains;
}

double Missed(const Disagreement& chain) { return chain.scans_turn_rad - chain.odometry_turn_rad; }

// What a chain tells of most: turns first, for while a robot turns ways are seen badly.
std::pair<double, double> Weight(const Disagreement& chain) {
  if (chain.hole) return {};
  const double turn = std::max(std::abs(chain.scans_turn_rad - chain.path_turn_rad), std::abs(Missed(chain)));
  return {turn >= kLeastTurn_rad ? turn : 0, std::max(chain.apart_m, chain.odometry_apart_m)};
}

}  // namespace

std::vector<Disagreement> Disagreements(const std::vector<Contradiction>& found,
                                        const std::vector<Scan>& scans) {
  std::vector<Disagreement> chains, all;
  for (std::size_t w = 0; w < kWatches.size(); ++w) {
    for (const Disagreement& chain : ChainsOf(w, found, scans)) {
      const auto [turn, apart_m] = Weight(chain);
      // Two scans alone may be of two places that look alike.
      if (chain.hole || (chain.of.size() > 1 && (turn > 0 || apart_m >= kLeast_m))) chains.push_back(chain);
    }
  }
  // Of those that tell of one time, the one that tells of the most.
  std::ranges::stable_sort(chains, std::ranges::greater{}, Weight);
  for (const Disagreement& chain : chains) {
    const bool is_told = std::ranges::any_of(all, [&](const Disagreement& other) {
      return chain.from_s < other.until_s && other.from_s < chain.until_s;
    });
    if (!is_told) all.push_back(chain);
  }
  std::ranges::stable_sort(all, {}, &Disagreement::from_s);
  return all;
}

std::vector<double> MissedTurns(const std::vector<Contradiction>& found, const std::vector<Scan>& scans) {
  std::vector<double> more;
  for (const Disagreement& chain : Disagreements(found, scans)) {
    if (chain.hole || std::abs(Missed(chain)) < kLeastTurn_rad) continue;  // two scans are too few
    more.resize(scans.size());
    for (const std::size_t i : chain.of) {
      const double step = found[i].seen.heading_rad - found[i].odometry.heading_rad;
      for (std::int64_t s = found[i].from + 1; s <= found[i].to; ++s)
        more[static_cast<std::size_t>(s)] += step / static_cast<double>(found[i].to - found[i].from);
    }
  }
  std::partial_sum(more.begin(), more.end(), more.begin());
  return more;
}

void MakeWaysGood(const std::vector<Contradiction>& found, std::vector<Scan>* scans) {
  std::vector<Point> more(scans->size());
  for (const Disagreement& chain : Disagreements(found, *scans)) {
    if (chain.hole || chain.odometry_apart_m < kLeast_m) continue;
    for (const std::size_t i : chain.of) {
      const Contradiction& c = found[i];
      const double heading_rad = (*scans)[static_cast<std::size_t>(c.from)].pose.heading_rad;
      const Pose way =
          Compose({0, 0, heading_rad}, {c.seen.x_m - c.odometry.x_m, c.seen.y_m - c.odometry.y_m, 0});
      const auto steps = static_cast<double>(c.to - c.from);
      for (std::int64_t s = c.from + 1; s <= c.to; ++s) {
        const auto at = static_cast<std::size_t>(s);
        more[at] = {more[at].x_m + way.x_m / steps, more[at].y_m + way.y_m / steps};
        (*scans)[at].slipped = true;
      }
    }
  }
  Point sum;
  for (std::size_t s = 0; s < scans->size(); ++s) {
    sum = {sum.x_m + more[s].x_m, sum.y_m + more[s].y_m};
    (*scans)[s].pose.x_m += sum.x_m;
    (*scans)[s].pose.y_m += sum.y_m;
  }
}

}  // namespace cairn::local_map
