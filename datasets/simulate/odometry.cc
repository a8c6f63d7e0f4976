#include "datasets/simulate/odometry.h"

#include <cmath>

#include "datasets/common/control.h"

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
  const Pose end = DeadReckon(drive.start, draw.controls);
  const Pose true_end = DeadReckon(drive.start, drive.controls);
  draw.final_error_m = DistanceM({end.x_m, end.y_m}, {true_end.x_m, true_end.y_m});
  return draw;
}

// By which the heading is off in the end.
double HeadingErrorRad(const Drive& drive, const Errors& errors, double drift_factor) {
  double error = 0;
  for (std::size_t i = 0; i < errors.controls.size(); ++i) {
    const Control& control = drive.controls[i];
    error += errors.controls[i].turn_rad - control.turn_rad +
             drift_factor * errors.drift_rad_per_m * control.forward_m;
  }
  return std::abs(WrapAngle(error));
}

// The draw, where it ends in the range.
bool Fits(const Drive& drive, const Errors& errors, double drift_factor, const ErrorRange& range,
          OdometryDraw& draw) {
  if (range.least_heading_rad > 0 && HeadingErrorRad(drive, errors, drift_factor) < range.least_heading_rad)
    return false;
  draw = Measure(drive, errors, drift_factor);
  return draw.final_error_m >= range.low_m && draw.final_error_m <= range.high_m;
}

// The smallest of a fixed list of factors, from 0 to 4, that fits; false where none does.
bool FitDrift(const Drive& drive, const Errors& errors, const ErrorRange& range, OdometryDraw& draw) {
  for (int i = 0; i <= 80; ++i) {
    if (Fits(drive, errors, 0.05 * i, range, draw)) return true;
  }
  return false;
}

}  // namespace

Pose DeadReckon(const Pose& start, const std::vector<Control>& controls) {
  Pose pose = start;
  for (const Control& control : controls) pose = Apply(pose, control);
  return pose;
}

std::optional<OdometryDraw> DrawOdometry(const Drive& drive, const OdometryNoise& noise, ErrorRange range,
                                         Rng& rng) {
  for (int redraws = 0; redraws < kAllDraws; ++redraws) {
    const Errors errors = DrawErrors(drive, noise, rng);
    OdometryDraw draw;
    const bool fits = Fits(drive, errors, 1, range, draw) ||
                      (redraws >= kFreeDraws && FitDrift(drive, errors, range, draw));
    if (!fits) continue;
    draw.redraws = redraws;
    return draw;
  }
  return std::nullopt;
}

}  // namespace cairn::datasets
