#include "datasets/simulate/sensing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "datasets/common/control.h"
#include "datasets/simulate/walls.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr double kImageSpacingM = 1;
constexpr int kMaxTypes = 16;

class Sensor {
 public:
  Sensor(const Drive& drive, const CorridorWorld& world, const std::vector<int>& types,
         const LoopSensing& sensing, Rng& rng)
      : drive_(drive), world_(world), types_(types), sensing_(sensing), rng_(rng) {
    Pose pose = drive.start;
    for (const Control& control : drive.controls) poses_.push_back(pose = Apply(pose, control));
  }

  std::vector<Sensed> Run() {
    sensing_.ranged() ? TakeImages() : DetectContacts();
    for (Sensed& s : sensed_) Recognise(s);
    for (Sensed& s : false_) {
      Recognise(s);
      const auto later = [](const Sensed& a, const Sensed& b) { return a.control < b.control; };
      sensed_.insert(std::upper_bound(sensed_.begin(), sensed_.end(), s, later), s);
    }
    return std::move(sensed_);
  }

 private:
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

  bool Misses(double rate) { return rate > 0 && rng_.Uniform() < rate; }

  // So that the false are their share of all.
  std::size_t FalseOnes() const {
    return static_cast<std::size_t>(
        std::lround(sensing_.false_rate / (1 - sensing_.false_rate) * static_cast<double>(sensed_.size())));
  }

  void DetectContacts() {
    const double further = 1 - (1 - sensing_.miss_rate) / (1 - kDriveMissRate);
    for (const datasets::Contact& contact : drive_.contacts) {
      if (Misses(further)) continue;
      sensed_.push_back({contact.control, static_cast<std::int32_t>(contact.landmark), 0, -1, kNan, kNan});
    }
    for (std::size_t n = FalseOnes(); n > 0; --n) false_.push_back({FalsePlace(), -1, 0, -1, kNan, kNan});
  }

  // Anywhere on the way, clear of landmarks.
  std::size_t FalsePlace() {
    for (;;) {
      double travelled_m = rng_.Uniform(0, drive_.length_m);
      std::size_t control = 0;
      while (control + 1 < drive_.controls.size() && (travelled_m -= drive_.controls[control].forward_m) > 0)
        ++control;
      const Pose& at = poses_[control];
      const auto near = [&](Point node) {
        return DistanceM(node, {at.x_m, at.y_m}) < kFalseContactClearanceM;
      };
      if (std::none_of(world_.nodes.begin(), world_.nodes.end(), near)) return control;
    }
  }

  void TakeImages() {
    const std::vector<Wall> walls = WallsOf(world_);
    std::vector<std::size_t> images;
    double travelled_m = 0;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      travelled_m += drive_.controls[i].forward_m;
      if (travelled_m < kImageSpacingM) continue;
      travelled_m = 0;
      images.push_back(i);
      for (std::size_t node = 0; node < world_.nodes.size(); ++node) Look(i, node, walls);
    }
    for (std::size_t n = FalseOnes(); n > 0; --n) {
      false_.push_back({images[rng_.Below(images.size())], -1, 0, -1, rng_.Uniform(0.5, kCameraMaxRangeM),
                        rng_.Uniform(-kCameraViewRad / 2, kCameraViewRad / 2)});
    }
  }

  void Look(std::size_t control, std::size_t node, const std::vector<Wall>& walls) {
    const Pose& pose = poses_[control];
    const Point from{pose.x_m, pose.y_m}, to = world_.nodes[node];
    const double range_m = DistanceM(from, to);
    if (range_m > kCameraMaxRangeM) return;
    const double heading = std::atan2(to.y_m - from.y_m, to.x_m - from.x_m);
    const double bearing = WrapAngle(heading - pose.heading_rad);
    if (std::abs(bearing) > kCameraViewRad / 2 || NearestWallM(walls, from, heading, 0) < range_m) return;
    if (Misses(sensing_.miss_rate)) return;
    const double seen_m = range_m + kCameraRangeSdM * rng_.Normal();
    const double seen_rad = bearing + kCameraBearingSdRad * rng_.Normal();
    if (seen_m <= 0 || seen_m > kCameraMaxRangeM || std::abs(seen_rad) > kCameraViewRad / 2) return;
    sensed_.push_back({control, static_cast<std::int32_t>(node), 0, -1, seen_m, seen_rad});
  }

  // What the landmark seems to be; a false one may seem any.
  void Recognise(Sensed& s) {
    const auto node = static_cast<std::size_t>(s.landmark);
    if (sensing_.identities)
      s.identity = s.landmark >= 0 ? s.landmark : static_cast<std::int32_t>(rng_.Below(world_.nodes.size()));
    if (sensing_.types == 1) return;
    const auto types = static_cast<std::uint64_t>(sensing_.types);
    if (s.landmark < 0) {
      s.type = static_cast<std::int32_t>(rng_.Below(types));
    } else {
      s.type = types_[node];
      if (Misses(sensing_.confusion))
        s.type = static_cast<std::int32_t>((s.type + 1 + rng_.Below(types - 1)) % types);
    }
  }

  const Drive& drive_;
  const CorridorWorld& world_;
  const std::vector<int>& types_;
  const LoopSensing& sensing_;
  Rng& rng_;
  std::vector<Pose> poses_;  // at each control's end
  std::vector<Sensed> sensed_, false_;
};

void Demand(bool allowed, const std::string& what, double value, const std::string& range) {
  if (!allowed) throw InputError(what + " is " + std::to_string(value) + "; allowed is " + range);
}

}  // namespace

void Check(const LoopSensing& sensing) {
  if (sensing.sensor != "contact" && !sensing.ranged())
    throw InputError("no sensor '" + sensing.sensor + "'; there are contact, range-bearing");
  Demand(sensing.false_rate >= 0 && sensing.false_rate <= 0.5, "false rate", sensing.false_rate, "0 to 0.5");
  Demand(sensing.miss_rate >= kDriveMissRate && sensing.miss_rate <= 0.9, "miss rate", sensing.miss_rate,
         "0.03 to 0.9");
  Demand(sensing.types >= 1 && sensing.types <= kMaxTypes, "types", sensing.types, "1 to 16");
  Demand(sensing.confusion >= 0 && sensing.confusion <= 0.5, "confusion", sensing.confusion, "0 to 0.5");
  if (sensing.types == 1 && sensing.confusion > 0)
    throw InputError("confusion is between types: ask for two or more");
  if (sensing.types > 1 && sensing.identities)
    throw InputError("types are for landmarks without identities: ask for either");
}

std::vector<Sensed> Sense(const Drive& drive, const CorridorWorld& world, const std::vector<int>& types,
                          const LoopSensing& sensing, Rng& rng) {
  return Sensor(drive, world, types, sensing, rng).Run();
}

}  // namespace cairn::datasets
