#include "datasets/simulate/drive.h"

#include <algorithm>
#include <cmath>

#include "datasets/common/control.h"

namespace cairn::datasets {
namespace {

constexpr double kTurnRadiusM = 0.8;   // of the arc by which the robot takes a corner
constexpr double kAboutTurnRad = 2.0;  // above it the robot turns on the spot
constexpr double kSpotTurnRad = 0.5;   // of one control on the spot
constexpr double kSpeedMps = 0.4;
constexpr double kTurnRateRadps = 0.8;
constexpr double kSpeedJitter = 0.03;
constexpr double kStraightRad = 0.6;  // a smaller change of heading counts as straight on

double HeadingTo(Point from, Point to) { return std::atan2(to.y_m - from.y_m, to.x_m - from.x_m); }

// Chooses corridors.
class Tour {
 public:
  Tour(const CorridorWorld& world, Rng& rng) : world_(world), rng_(rng) {
    const auto edges = world.Edges();
    const auto [a, b] = edges[rng.Below(edges.size())];
    const bool forwards = rng.Below(2) == 0;
    from_ = forwards ? a : b;
    to_ = forwards ? b : a;
  }

  std::size_t from() const { return from_; }
  std::size_t to() const { return to_; }

  void Advance() {
    const std::size_t next = StartsRound() || round_left_ > 0 ? NextRound() : NextFree();
    from_ = to_;
    to_ = next;
  }

 private:
  bool OnCycle(std::size_t node) const { return node < world_.cycle_nodes; }

  bool StartsRound() {
    if (round_done_ || !OnCycle(to_)) return false;
    round_done_ = true;
    // Once round to the place where it began, and one corridor more.
    round_left_ = world_.cycle_nodes + 1;
    const std::size_t n = world_.cycle_nodes;
    if (OnCycle(from_)) {
      round_step_ = (to_ + n - from_) % n;  // 1 or n - 1: goes on the way it came
    } else {
      round_step_ = rng_.Below(2) == 0 ? 1 : n - 1;
    }
    return true;
  }

  std::size_t NextRound() {
    --round_left_;
    return (to_ + round_step_) % world_.cycle_nodes;
  }

  std::size_t NextFree() {
    const auto& around = world_.neighbours[to_];
    if (around.size() == 1) return around.front();
    std::vector<std::size_t> choices;
    const double heading = HeadingTo(world_.nodes[from_], world_.nodes[to_]);
    for (const std::size_t next : around) {
      if (next == from_) continue;
      choices.push_back(next);
      const double turn = WrapAngle(HeadingTo(world_.nodes[to_], world_.nodes[next]) - heading);
      if (std::abs(turn) < kStraightRad) choices.push_back(next);
    }
    return choices[rng_.Below(choices.size())];
  }

  const CorridorWorld& world_;
  Rng& rng_;
  std::size_t from_ = 0, to_ = 0;
  bool round_done_ = false;
  std::size_t round_left_ = 0;
  std::size_t round_step_ = 1;
};

// Turns way points into controls.
class Driver {
 public:
  Driver(Drive& drive, double step_m, Rng& rng)
      : drive_(drive), step_m_(step_m), rng_(rng), pose_(drive.start) {}

  // Takes the corner on an arc (an about turn on the spot), then goes straight, in equal steps, to end on
  // `target`.
  void GoTo(Point target) {
    TurnOnTheSpot(target);
    const double arc_rad = step_m_ / kTurnRadiusM;
    while (std::abs(ErrorTo(target)) > arc_rad) Do({std::copysign(arc_rad, ErrorTo(target)), step_m_});
    const double distance_m = DistanceM({pose_.x_m, pose_.y_m}, target);
    const auto steps = static_cast<int>(std::ceil(distance_m / step_m_));
    for (int i = 0; i < steps; ++i) Do({i == 0 ? ErrorTo(target) : 0, distance_m / steps});
  }

 private:
  double ErrorTo(Point target) const {
    return WrapAngle(HeadingTo({pose_.x_m, pose_.y_m}, target) - pose_.heading_rad);
  }

  void TurnOnTheSpot(Point target) {
    const double turn = ErrorTo(target);
    if (std::abs(turn) < kAboutTurnRad) return;
    const auto steps = static_cast<int>(std::ceil(std::abs(turn) / kSpotTurnRad));
    for (int i = 0; i < steps; ++i) Do({turn / steps, 0});
  }

  void Do(const Control& control) {
    const double pace = 1 + kSpeedJitter * std::clamp(rng_.Normal(), -3.0, 3.0);
    time_s_ += (control.forward_m / kSpeedMps + std::abs(control.turn_rad) / kTurnRateRadps) * pace;
    pose_ = Apply(pose_, control);
    drive_.controls.push_back(control);
    drive_.times_s.push_back(time_s_);
    drive_.length_m += control.forward_m;
  }

  Drive& drive_;
  double step_m_;
  Rng& rng_;
  Pose pose_;
  double time_s_ = 0;
};

}  // namespace

Drive DrawDrive(const CorridorWorld& world, const DriveOptions& options, Rng& rng) {
  Drive drive;
  Tour tour(world, rng);
  const Point a = world.nodes[tour.from()], b = world.nodes[tour.to()];
  const double share = rng.Uniform(0.1, 0.6);
  drive.start = {a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m), HeadingTo(a, b)};
  Driver driver(drive, options.step_m, rng);
  while (drive.length_m < options.min_length_m) {
    const std::size_t node = tour.to();
    driver.GoTo({world.nodes[node].x_m + options.pass_sd_m * rng.Normal(),
                 world.nodes[node].y_m + options.pass_sd_m * rng.Normal()});
    drive.passes.push_back(node);
    if (rng.Uniform() < options.contact_probability)
      drive.contacts.push_back({drive.controls.size() - 1, node});
    tour.Advance();
  }
  return drive;
}

}  // namespace cairn::datasets
