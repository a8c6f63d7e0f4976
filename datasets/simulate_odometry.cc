#include "datasets/simulate_odometry.h"

#include <cmath>

#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr int kFreeDraws = 100;
constexpr int kAllDraws = 1000;
constexpr double kResolution = 1e6;  // steps in a radian and in a metre

double Quantise(double value) { return std::round(value * kResolution) / kResolution; }

// One realisation of the errors, before its drift is scaled.
struct Errors {
  double drift_rad_per_m = 0;
  std::vector<Control> controls;  // as measured, without the drift
};

Errors DrawErrors(const Drive& drive, const OdometryNoise& noise, Rng& rng) {
  Errors errors;
  errors.drift_rad_per_m = noise.heading_drift_rad_per_m * rng.Normal();
  const double scale = 1 + noise.forward_ratio * rng.Normal();
  errors.controls.reserve(drive.controls.size());
  for (const Control& control : drive.controls) {
    const double walk = noise.heading_walk_rad_per_sqrt_m * std::sqrt(control.forward_m) * rng.Normal();
    const double turn = control.turn_rad * (1 + noise.turn_ratio * rng.Normal()) + walk;
    errors.controls.push_back({turn, control.forward_m * scale * (1 + noise.forward_ratio * rng.Normal())});
  }
  return errors;
}

OdometryDraw Measure(const Drive& drive, const Errors& errors, double drift_factor) {
  OdometryDraw draw;
  draw.drift_factor = drift_factor;
  draw.controls.reserve(errors.controls.size());
  for (std::size_t i = 0; i < errors.controls.size(); ++i) {
    const double drift = drift_factor * errors.drift_rad_per_m * drive.controls[i].forward_m;
    draw.controls.push_back(
        {Quantise(errors.controls[i].turn_rad + drift), Quantise(errors.controls[i].forward_m)});
  }
  const PoseM end = DeadReckon(drive.start, draw.controls);
  const PoseM true_end = DeadReckon(drive.start, drive.controls);
  draw.final_error_m = DistanceM({end.x_m, end.y_m}, {true_end.x_m, true_end.y_m});
  return draw;
}

bool In(const ErrorRange& range, double error_m) { return error_m >= range.low_m && error_m <= range.high_m; }

// The smallest of a fixed list of factors, from 0 to 4, that fits; false where none does.
bool FitDrift(const Drive& drive, const Errors& errors, ErrorRange range, OdometryDraw& draw) {
  for (int i = 0; i <= 80; ++i) {
    draw = Measure(drive, errors, 0.05 * i);
    if (In(range, draw.final_error_m)) return true;
  }
  return false;
}

}  // namespace

PoseM DeadReckon(const PoseM& start, const std::vector<Control>& controls) {
  PoseM pose = start;
  for (const Control& control : controls) pose = Apply(pose, control);
  return pose;
}

OdometryDraw DrawOdometry(const Drive& drive, const OdometryNoise& noise, ErrorRange range, Rng& rng) {
  for (int redraws = 0; redraws < kAllDraws; ++redraws) {
    const Errors errors = DrawErrors(drive, noise, rng);
    OdometryDraw draw = Measure(drive, errors, 1);
    const bool fits =
        In(range, draw.final_error_m) || (redraws >= kFreeDraws && FitDrift(drive, errors, range, draw));
    if (!fits) continue;
    draw.redraws = redraws;
    return draw;
  }
  throw InputError("no odometric error of " + std::to_string(range.low_m) + " to " +
                   std::to_string(range.high_m) + " m comes of this noise and drive: take another seed");
}

}  // namespace cairn::datasets
