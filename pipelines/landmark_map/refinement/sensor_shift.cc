#include "pipelines/landmark_map/refinement/sensor_shift.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "pipelines/landmark_map/refinement/refined_path.h"
#include "schema/geometry.h"

namespace cairn::landmark_map {
namespace {

constexpr double kFirst_s = 0.1, kMost_s = 5.0, kFirst_rad = 0.01, kMost_rad = 0.5;
constexpr int kSteps = 20;
constexpr double kLeast_nats = 10.0, kLeastEach_nats = 0.02;  // to gain, in all and an observation
constexpr std::size_t kMostSightings = 2000;                  // that many tell it as well as more

// The odometry that a clock would have recorded which is so much later. Between two rows all goes on evenly.
Odometry Later(Odometry odometry, double late_s) {
  const Odometry was = odometry;
  for (std::size_t i = 0; i < was.time_s.size(); ++i) {
    const double time_s = std::clamp(was.time_s[i] - late_s, was.time_s.front(), was.time_s.back());
    const auto after = std::ranges::upper_bound(was.time_s, time_s) - was.time_s.begin();
    const auto k = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(after, 1, std::ssize(was.time_s) - 1));
    const double length_s = was.time_s[k] - was.time_s[k - 1];
    const double part = length_s > 0.0 ? (time_s - was.time_s[k - 1]) / length_s : 1.0;
    odometry.x_m[i] = std::lerp(was.x_m[k - 1], was.x_m[k], part);
    odometry.y_m[i] = std::lerp(was.y_m[k - 1], was.y_m[k], part);
    odometry.heading_rad[i] = std::lerp(was.heading_rad[k - 1], was.heading_rad[k], part);
  }
  return odometry;
}

// One robot's observations, among their landmarks, at other times than they say, and what that costs.
class Shifted {
 public:
  Shifted(const LeastSquaresProblem& problem, const LeastSquaresPoint& point, const Odometry& odometry,
          std::size_t robot)
      : odometry_(odometry) {
    LeastSquaresProblem alone = problem;
    alone.robots = {problem.robots[robot]};
    alone.widths = {problem.widths[robot]};
    alone.repeats = {};  // a shift that nobody takes off makes errors that go on
    std::erase_if(alone.sightings,
                  [&](const Sighting& seen) { return seen.robot != static_cast<int>(robot); });
    for (Sighting& seen : alone.sightings) seen.robot = 0;
    problem_ = Beginning(alone, kMostSightings);
    std::map<int, int> now;  // its landmarks, in the order in which it sees them
    for (Sighting& seen : problem_.sightings) {
      const auto [at, is_new] = now.try_emplace(seen.landmark, static_cast<int>(now.size()));
      if (is_new) point_.landmarks.push_back(point.landmarks[static_cast<std::size_t>(seen.landmark)]);
      seen.landmark = at->second;
    }
    problem_.landmarks = static_cast<int>(now.size());
    point_.nodes = {point.nodes[robot]};
    point_.nodes[0].resize(problem_.robots[0].time_s.size());
    point_.errors = {point.errors[robot]};
  }

  double CostOfLate(double late_s) const {
    const Odometry later = Later(odometry_, late_s);
    LeastSquaresProblem late = problem_;
    NodeTrack& track = late.robots[0];
    for (std::size_t k = 0; k < track.controls.size(); ++k)
      track.controls[k] = ControlsBetween(later, track.time_s[k], track.time_s[k + 1]);
    return Descend(late, point_, kSteps).cost;
  }
  // With the sensor there: the least.
  LeastSquaresEnd EndOfMount(const Pose& mount) const { return Descend(Mounted(mount), point_, kSteps); }
  double CostOfMount(const Pose& mount) const { return EndOfMount(mount).cost; }
  // Where nothing else moves.
  double CostOfMount(const Pose& mount, const LeastSquaresPoint& at) const {
    return CostOf(Mounted(mount), at);
  }
  double sightings() const { return static_cast<double>(problem_.sightings.size()); }

 private:
  LeastSquaresProblem Mounted(const Pose& mount) const {
    LeastSquaresProblem mounted = problem_;
    for (Sighting& seen : mounted.sightings) {
      if (seen.contact()) continue;
      const Pose place = Compose(mount, {seen.x_m, seen.y_m, 0});
      seen.x_m = place.x_m;
      seen.y_m = place.y_m;
    }
    return mounted;
  }

  LeastSquaresProblem problem_;
  LeastSquaresPoint point_;
  const Odometry& odometry_;
};

struct Least {
  double at = 0.0, gain_nats = 0.0;
};

// Where the cost is least: twice as far from 0 while that is less, then halfway between. `none`: the cost at
// 0.
template <class F>
Least FindLeast(const F& cost, double none, double first, double most) {
  constexpr int kHalvings = 3;
  double from = 0.0, at = first, to, least = cost(at);
  if (least >= none) least = cost(at = -first);
  if (least >= none) return {};
  for (to = 2.0 * at; std::abs(to) <= most; to *= 2.0) {
    const double further = cost(to);
    if (further >= least) break;
    from = std::exchange(at, to);
    least = further;
  }
  for (int k = 0; k < kHalvings; ++k) {
    const double nearer = std::midpoint(from, at), further = std::midpoint(at, to);
    if (const double there = cost(nearer); there < least) {
      to = std::exchange(at, nearer);
      least = there;
    } else if (const double beyond = cost(further); beyond < least) {
      from = std::exchange(at, further);
      least = beyond;
    } else {
      from = nearer;
      to = further;
    }
  }
  return {at, none - least};
}

Pose Moved(const Pose& at, const Eigen::Vector3d& by) {
  return {at.x_m + by.x(), at.y_m + by.y(), at.heading_rad + by.z()};
}

// A paraboloid through costs about a mount, in units of what it is moved by. Where all else is at its least,
// the slope is that of the cost where nothing else moves.
class MountParaboloid {
 public:
  MountParaboloid(const Shifted& shifted, const Pose& at, const LeastSquaresEnd& end)
      : shifted_(shifted), at_(at), cost_(end.cost) {
    constexpr double kSmall = 0.01;
    for (int i = 0; i < 3; ++i) {
      const auto cost = [&](double by) {
        return shifted.CostOfMount(Moved(at, kUnit.cwiseProduct(by * Eigen::Vector3d::Unit(i))), end.point);
      };
      slope_[i] = (cost(kSmall) - cost(-kSmall)) / (2.0 * kSmall);
      up_[i] = Cost(Eigen::Vector3d::Unit(i));
      curvature_(i, i) = std::max(1e-9, 2.0 * (up_[i] - cost_ - slope_[i]));
    }
  }

  // Along one of them.
  double GainAlongOne() const { return 0.5 * slope_.cwiseAbs2().cwiseQuotient(curvature_.diagonal()).sum(); }
  // From here to where it is least; none where that is nowhere.
  std::optional<Eigen::Vector3d> ToLeast() {
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < i; ++k)
        curvature_(i, k) = curvature_(k, i) =
            Cost(Eigen::Vector3d::Unit(i) + Eigen::Vector3d::Unit(k)) - up_[i] - up_[k] + cost_;
    const Eigen::LLT<Eigen::Matrix3d> solver(curvature_);
    if (solver.info() != Eigen::Success) return std::nullopt;
    return kUnit.cwiseProduct(-solver.solve(slope_));
  }

 private:
  inline static const Eigen::Vector3d kUnit{0.1, 0.1, 0.03};  // m, m, rad
  double Cost(const Eigen::Vector3d& by) const {
    return shifted_.CostOfMount(Moved(at_, kUnit.cwiseProduct(by)));
  }

  const Shifted& shifted_;
  Pose at_;
  double cost_;
  Eigen::Vector3d slope_, up_;
  Eigen::Matrix3d curvature_ = Eigen::Matrix3d::Zero();
};

struct LeastMount {
  Pose at;
  LeastSquaresEnd end;
};

// Where such a paraboloid is least, and again from there, as long as the cost falls.
LeastMount FindLeastMount(const Shifted& shifted, const Pose& start) {
  constexpr double kMost_m = 2.0;
  constexpr int kRounds = 4;
  LeastMount least{start, shifted.EndOfMount(start)};
  const double first = least.end.cost;
  for (int round = 0; round < kRounds; ++round) {
    const auto step = MountParaboloid(shifted, least.at, least.end).ToLeast();
    if (!step) break;
    Pose at = Moved(least.at, *step);
    at = {std::clamp(at.x_m, -kMost_m, kMost_m), std::clamp(at.y_m, -kMost_m, kMost_m),
          std::clamp(at.heading_rad, -kMost_rad, kMost_rad)};
    LeastSquaresEnd there = shifted.EndOfMount(at);
    const double fell = least.end.cost - there.cost;
    if (!(fell > 0)) break;
    least = {at, std::move(there)};
    if (fell < std::max(0.5, 0.05 * (first - least.end.cost))) break;
  }
  return least;
}

}  // namespace

std::vector<SensorShift> FindSensorShifts(const LeastSquaresProblem& problem, const LeastSquaresPoint& point,
                                          std::span<const Odometry> odometry) {
  std::vector<SensorShift> shifts;
  for (std::size_t r = 0; r < odometry.size(); ++r) {
    Shifted shifted(problem, point, odometry[r], r);
    SensorShift& shift = shifts.emplace_back();
    if (shifted.sightings() == 0) continue;
    const double enough = std::max(kLeast_nats, kLeastEach_nats * shifted.sightings());
    const LeastSquaresEnd as_is = shifted.EndOfMount({});
    const Least late =
        FindLeast([&](double s) { return shifted.CostOfLate(s); }, as_is.cost, kFirst_s, kMost_s);
    Least turned;
    LeastMount mount{{}, as_is};
    constexpr double kWorthALook = 0.3;  // of what is to gain; chance makes less of three in nine of ten
    if (MountParaboloid(shifted, {}, as_is).GainAlongOne() > kWorthALook * enough) {
      turned = FindLeast([&](double rad) { return shifted.CostOfMount({0, 0, -rad}); }, as_is.cost,
                         kFirst_rad, kMost_rad);
      mount = FindLeastMount(shifted, {0, 0, -turned.at});
    }
    const double mount_nats = as_is.cost - mount.end.cost;
    // What explains more: the one may look like a little of the other.
    if (std::max(mount_nats, late.gain_nats) < enough) continue;
    if (late.gain_nats >= mount_nats)
      shift.late_s = late.at;
    else if (mount_nats - turned.gain_nats < enough)
      shift.turned_rad = turned.at;
    else
      shift = {0, -mount.at.heading_rad, mount.at.x_m, mount.at.y_m};
  }
  return shifts;
}

}  // namespace cairn::landmark_map
