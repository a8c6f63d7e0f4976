#include "datasets/simulate/office/tour.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "datasets/common/control.h"

namespace cairn::datasets::office {
namespace {

constexpr double kTurnRadps = 0.8;
constexpr double kSlowMps = 0.35, kFastMps = 0.5;
constexpr double kOffLaneSdM = 0.04, kMostOffLaneM = 0.08;
constexpr double kAheadM = 0.95;     // of somebody in the way
constexpr double kStopStretchM = 4;  // people step in the way on stretches so long, or longer
constexpr double kStopChance = 0.35, kLongStopChance = 0.3;
constexpr double kThroughChance = 0.5;  // on by the door to the next room
constexpr double kFirstStandS = 6, kWaitS = 30;

// Turns ways into controls, until the time is over.
class Pilot {
 public:
  Pilot(Tour* tour, double end_s, Rng& rng)
      : tour_(tour), end_s_(end_s), rng_(rng), pose_(tour->drive.start) {}

  bool over() const { return time_s_ >= end_s_ - kTickS / 2; }
  double time_s() const { return time_s_; }

  void MarkDoorway() {
    if (!over()) tour_->doorways_s.push_back(time_s_);
  }

  void Stand(double seconds) {
    for (const double until_s = time_s_ + seconds; !over() && time_s_ < until_s - kTickS / 2;) Do({0, 0});
  }

  // Near `target`: turns on the spot, then straight on, with a stop where somebody is in the way.
  void GoTo(Point target) {
    target.x_m += OffLane();
    target.y_m += OffLane();
    Turn(WrapAngle(std::atan2(target.y_m - pose_.y_m, target.x_m - pose_.x_m) - pose_.heading_rad));
    if (rng_.Uniform() < 0.2) Stand(rng_.Uniform(0.4, 2.5));
    const double distance_m = DistanceM({pose_.x_m, pose_.y_m}, target);
    const auto steps = static_cast<int>(std::ceil(distance_m / (rng_.Uniform(kSlowMps, kFastMps) * kTickS)));
    const int stop_at =
        distance_m > kStopStretchM && rng_.Uniform() < kStopChance ? static_cast<int>(0.3 * steps) : -1;
    for (int i = 0; i < steps; ++i) {
      if (i == stop_at)
        StopFor(rng_.Uniform() < kLongStopChance ? rng_.Uniform(32, 40) : rng_.Uniform(4, 15));
      Do({0, distance_m / steps});
    }
  }

  void Turn(double angle_rad) {
    const auto steps = static_cast<int>(std::ceil(std::abs(angle_rad) / (kTurnRadps * kTickS)));
    for (int i = 0; i < steps; ++i) Do({angle_rad / steps, 0});
  }

 private:
  double OffLane() { return std::clamp(kOffLaneSdM * rng_.Normal(), -kMostOffLaneM, kMostOffLaneM); }

  void StopFor(double seconds) {
    if (over()) return;
    const Point person{pose_.x_m + kAheadM * std::cos(pose_.heading_rad),
                       pose_.y_m + kAheadM * std::sin(pose_.heading_rad)};
    tour_->stops.push_back({time_s_, time_s_ + seconds, person, pose_.heading_rad});
    Stand(seconds);
  }

  void Do(const Control& control) {
    if (over()) return;
    time_s_ += kTickS;
    pose_ = Apply(pose_, control);
    tour_->drive.controls.push_back(control);
    tour_->drive.times_s.push_back(time_s_);
    tour_->drive.length_m += control.forward_m;
    tour_->poses.push_back(pose_);
  }

  Tour* tour_;
  double end_s_;
  Rng& rng_;
  Pose pose_;
  double time_s_ = 0;
};

// Chooses rooms.
class Visitor {
 public:
  Visitor(const Office& office, Pilot* pilot, Rng& rng) : office_(office), pilot_(pilot), rng_(rng) {}

  // To the corridor's near end, then into every room once, in an order drawn; `back()` after each, in the
  // corridor.
  template <class Back>
  void Round(const Back& back) {
    pilot_->GoTo({office_.from_x_m + kLaneM, 0});
    std::vector<std::size_t> rooms;
    for (std::size_t i = 0; i < office_.rooms.size(); ++i) rooms.push_back(i);
    for (std::size_t i = rooms.size(); i > 1; --i) std::swap(rooms[i - 1], rooms[rng_.Below(i)]);
    for (const std::size_t room : rooms) {
      Visit(room);
      back();
    }
  }

 private:
  void Visit(std::size_t which) {
    const Room& room = office_.rooms[which];
    pilot_->GoTo(room.Before(office_.half_width_m));
    pilot_->MarkDoorway();
    pilot_->GoTo(DoorLane(room));
    Circle(room);
    const bool through = room.next && rng_.Uniform() < kThroughChance;
    if (through) pilot_->MarkDoorway();
    Leave(through ? office_.rooms[*room.next] : room);
  }

  // Where the way in meets the lane along the near wall.
  static Point DoorLane(const Room& room) { return room.ToWorld({room.door_x_m, kLaneM}); }

  void Leave(const Room& room) {
    pilot_->GoTo(DoorLane(room));
    pilot_->MarkDoorway();
    pilot_->GoTo(room.Before(office_.half_width_m));
  }

  // Once round along the walls, either way.
  void Circle(const Room& room) {
    const double right = room.width_m - kLaneM, far = room.depth_m - kLaneM;
    std::vector<Point> corners{{kLaneM, kLaneM}, {kLaneM, far}, {right, far}, {right, kLaneM}};
    if (rng_.Below(2) == 1) std::reverse(corners.begin(), corners.end());
    for (const Point corner : corners) pilot_->GoTo(room.ToWorld(corner));
  }

  const Office& office_;
  Pilot* pilot_;
  Rng& rng_;
};

}  // namespace

Tour DrawTour(const Office& office, double minutes, bool waits, Rng& rng) {
  Tour tour;
  tour.drive.start = {rng.Uniform(0.3, 0.7) * (office.from_x_m + office.to_x_m), 0,
                      rng.Uniform(-std::numbers::pi, std::numbers::pi)};
  const double end_s = 60 * minutes;
  Pilot pilot(&tour, end_s, rng);
  Visitor visitor(office, &pilot, rng);
  pilot.Stand(kFirstStandS);
  const auto wait = [&] {
    if (!waits || tour.moved_s > 0 || pilot.over() || pilot.time_s() < end_s / 2) return;
    pilot.Stand(kWaitS);
    tour.moved_s = pilot.time_s();
  };
  while (!pilot.over()) visitor.Round(wait);
  return tour;
}

}  // namespace cairn::datasets::office
