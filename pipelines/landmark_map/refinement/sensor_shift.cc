#include "pipelines/landmark_map/refinement/sensor_shift.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>

#include "pipelines/landmark_map/refinement/refined_path.h"

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

  double CostOfLate(double late_s) {
    const Odometry later = Later(odometry_, late_s);
    NodeTrack& track = problem_.robots[0];
    for (std::size_t k = 0; k < track.controls.size(); ++k)
      track.controls[k] = ControlsBetween(later, track.time_s[k], track.time_s[k + 1]);
    return Descend(problem_, point_, kSteps).cost;
  }
  double CostOfTurned(double turned_rad) const {
    LeastSquaresProblem turned = problem_;
    for (Sighting& seen : turned.sightings) {
      const Eigen::Vector2d place = Eigen::Rotation2Dd(-turned_rad) * Eigen::Vector2d(seen.x_m, seen.y_m);
      seen.x_m = place.x();
      seen.y_m = place.y();
    }
    return Descend(turned, point_, kSteps).cost;
  }
  double sightings() const { return static_cast<double>(problem_.sightings.size()); }

 private:
  LeastSquaresProblem problem_;
  LeastSquaresPoint point_;
  const Odometry& odometry_;
};

struct Least {
  double at = 0.0, gain_nats = 0.0;
};

// Where the cost is least: twice as far from 0 while that is less, then halfway between.
template <class F>
Least FindLeast(const F& cost, double first, double most) {
  constexpr int kHalvings = 3;
  const double none = cost(0.0);
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

}  // namespace

std::vector<SensorShift> FindSensorShifts(const LeastSquaresProblem& problem, const LeastSquaresPoint& point,
                                          std::span<const Odometry> odometry) {
  std::vector<SensorShift> shifts;
  for (std::size_t r = 0; r < odometry.size(); ++r) {
    Shifted shifted(problem, point, odometry[r], r);
    SensorShift& shift = shifts.emplace_back();
    if (shifted.sightings() == 0) continue;
    const double enough = std::max(kLeast_nats, kLeastEach_nats * shifted.sightings());
    const Least turned =
        FindLeast([&](double rad) { return shifted.CostOfTurned(rad); }, kFirst_rad, kMost_rad);
    const Least late = FindLeast([&](double s) { return shifted.CostOfLate(s); }, kFirst_s, kMost_s);
    // What explains more: the one may look like a little of the other.
    if (std::max(turned.gain_nats, late.gain_nats) < enough) continue;
    (late.gain_nats >= turned.gain_nats ? shift.late_s : shift.turned_rad) =
        late.gain_nats >= turned.gain_nats ? late.at : turned.at;
  }
  return shifts;
}

}  // namespace cairn::landmark_map
