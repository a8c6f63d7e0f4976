#include "datasets/import/log_rows.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <utility>

#include "datasets/common/observation_doubts.h"
#include "datasets/common/odometry_restart.h"
#include "datasets/common/range_sensor_doubts.h"
#include "datasets/common/unit_doubts.h"
#include "datasets/import/truth_doubts.h"
#include "schema/error.h"
#include "schema/kinds/log.h"
#include "schema/kinds/odometry_holes.h"
#include "schema/kinds/robots_without_observations.h"

namespace cairn::datasets {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;

using NamedParameter = std::pair<const char*, const std::optional<double>*>;

std::vector<NamedParameter> NamedParameters(const NoiseParameters& noise) {
  return {{"noise/heading_drift_rad_per_m", &noise.heading_drift_rad_per_m},
          {"noise/heading_walk_rad_per_sqrt_m", &noise.heading_walk_rad_per_sqrt_m},
          {"noise/forward_ratio", &noise.forward_ratio},
          {"noise/turn_ratio", &noise.turn_ratio},
          {"noise/contact_m", &noise.contact_m},
          {"noise/range_m", &noise.range_m},
          {"noise/bearing_rad", &noise.bearing_rad},
          {"noise/false_ratio", &noise.false_ratio},
          {"noise/miss_ratio", &noise.miss_ratio},
          {"sensor/max_range_m", &noise.max_range_m},
          {"sensor/field_of_view_rad", &noise.field_of_view_rad}};
}

std::vector<double> WithinATurn(std::vector<double> angles) {
  for (double& angle : angles)
    if (!std::isnan(angle)) angle = NormalizedAngle(angle);
  return angles;
}

kinds::PoseTable TableOf(Poses&& poses) {
  for (std::size_t i = 0; i < poses.heading_rad.size(); ++i) {
    const double heading = poses.heading_rad[i], within = NormalizedAngle(heading);
    if (!std::isnan(heading) && within != heading) poses.heading_rad[i] = within;
  }
  return {poses.time_s.Take(), poses.x_m.Take(), poses.y_m.Take(), poses.heading_rad.Take()};
}

// The ranges of a long log are most of the memory: they are not copied.
Array ArrayOf(const Shape& shape, RangeValues values) {
  const auto owner = std::make_shared<const RangeValues>(std::move(values));
  Result<Array> array =
      Array::Over(DType::kF64, sizeof(double), shape, std::as_bytes(std::span(*owner)), owner);
  CAIRN_DEMAND(array.ok(), array.status().message());
  return std::move(array).value();
}

kinds::Log::RangeSensor SensorOf(RangeRows&& rows) {
  const auto scans = static_cast<std::int64_t>(rows.time_s.size()),
             beams = static_cast<std::int64_t>(rows.beam_x_m.size());
  kinds::Log::RangeSensor sensor{
      rows.sensor,
      rows.time_s.Take(),
      rows.taken ? std::move(rows.taken->range_m) : ArrayOf({scans, beams}, std::move(rows.range_m)),
      rows.beam_x_m,
      rows.beam_y_m,
      rows.beam_heading_rad,
      {},
      rows.opening_rad,
      rows.max_range_m,
      {}};
  if (rows.taken && rows.taken->intensity) sensor.intensity = std::move(*rows.taken->intensity);
  if (!rows.intensity.empty()) sensor.intensity = Column<float>({scans, beams}, rows.intensity);
  return sensor;
}

// Takes all but observations.
void PutRobot(RobotRows& robot, std::size_t index, Blob* log) {
  const std::string prefix = "robot/" + std::to_string(index) + "/";
  const Observations &seen = robot.observations, &sighted = robot.robot_observations;
  kinds::Log::Robot of;
  of.odometry = {robot.odometry.time_s.Take(), robot.odometry.turn_rad.Take(),
                 robot.odometry.forward_m.Take()};
  of.observations = {seen.time_s, seen.range_m, WithinATurn(seen.bearing_rad), seen.landmark, {}};
  if (!sighted.time_s.empty())
    of.robot_observations = {sighted.time_s, sighted.range_m, WithinATurn(sighted.bearing_rad),
                             sighted.landmark};
  if (!robot.poses.time_s.empty()) of.poses = TableOf(std::move(robot.poses));
  for (RangeRows& ranges : robot.ranges) of.sensors.push_back(SensorOf(std::move(ranges)));
  PutFields(prefix, of, log);
  kinds::Log::TrueRobot truth;
  if (!seen.truth_landmark.empty()) truth.landmark = seen.truth_landmark;
  if (!robot.truth.time_s.empty()) truth.poses = TableOf(std::move(robot.truth));
  PutFields("truth/" + prefix, truth, log);
}

void Count(const RobotRows& robot, ImportReport* report) {
  const auto size = [](const auto& column) { return static_cast<std::int64_t>(column.size()); };
  report->controls += size(robot.odometry.time_s);
  report->observations += size(robot.observations.time_s);
  report->contacts +=
      std::ranges::count_if(robot.observations.range_m, [](double range) { return std::isnan(range); });
  report->robot_observations += size(robot.robot_observations.time_s);
  for (const RangeRows& ranges : robot.ranges) report->scans += size(ranges.time_s);
}

void Tell(const Origin& from, const std::string& who, const std::string& table,
          const std::optional<UnitDoubt>& doubt, ImportReport* report) {
  if (doubt) report->unit_doubts.push_back(DoubtText(from.Of(doubt->row), who, table, *doubt));
}

void DoubtUnits(const RobotRows& robot, bool range_is_known, ImportReport* report) {
  const std::string who = "robot '" + robot.name + "'";
  const Odometry& odometry = robot.odometry;
  if (robot.odometry_poses.time_s.empty())
    Tell(odometry.from, who, "odometry",
         DoubtControls(odometry.time_s, odometry.turn_rad, odometry.forward_m), report);
  const Poses& poses = robot.odometry_poses;
  const auto doubt = DoubtPoses(poses.time_s, poses.x_m, poses.y_m, poses.heading_rad);
  const auto restart = DoubtRestart(poses.time_s, poses.x_m, poses.y_m, poses.heading_rad);
  Tell(poses.from, who, "odometry",
       doubt     ? doubt
       : restart ? restart
                 : DoubtHeadings(poses.time_s, poses.x_m, poses.y_m, poses.heading_rad),
       report);
  for (const auto& [table, rows] : {std::pair{"observations", &robot.observations},
                                    std::pair{"robot_observations", &robot.robot_observations}}) {
    Tell(rows->from, who, table,
         DoubtObservations(rows->time_s, rows->range_m, rows->bearing_rad, range_is_known), report);
    Tell(rows->from, who, table, DoubtClock(odometry.time_s, rows->time_s), report);
  }
  DoubtPosesOf(robot.poses, who, "poses", report);
  DoubtPosesOf(robot.truth, who, "true poses", report);
}

}  // namespace

void LandmarkSensor::ToRobotFrame(double* range_m, double* bearing_rad) const {
  if (mount.x_m == 0 && mount.y_m == 0 && mount.heading_rad == 0) return;  // to the bit
  if (mount.x_m == 0 && mount.y_m == 0) {
    *bearing_rad += mount.heading_rad;
    return;
  }
  const Pose place = Compose(mount, {*range_m * std::cos(*bearing_rad), *range_m * std::sin(*bearing_rad)});
  *range_m = std::hypot(place.x_m, place.y_m);
  *bearing_rad = std::atan2(place.y_m, place.x_m);
}

NoiseParameters LandmarkSensor::OnRobot(NoiseParameters noise) const {
  if (noise.max_range_m) *noise.max_range_m += std::hypot(mount.x_m, mount.y_m);
  const bool aside =
      mount.x_m != 0 || mount.y_m != 0;  // then it sees to its sides what stands behind the robot
  if (aside)
    noise.field_of_view_rad.reset();
  else if (noise.field_of_view_rad)
    *noise.field_of_view_rad =
        std::min(2 * std::numbers::pi, *noise.field_of_view_rad + 2 * std::abs(WrapAngle(mount.heading_rad)));
  return noise;
}

std::string Origin::Of(std::size_t row) const {
  return row < line.size() ? file + before_line + std::to_string(line[row]) + ": " : "";
}

void DoubtPosesOf(const Poses& poses, const std::string& who, const std::string& table,
                  ImportReport* report) {
  Tell(poses.from, who, table, DoubtPoses(poses.time_s, poses.x_m, poses.y_m, poses.heading_rad), report);
}

void PutPoses(const std::string& prefix, Poses poses, Blob* blob) {
  PutFields(prefix, TableOf(std::move(poses)), blob);
}

void Odometry::Add(double time, double turn, double forward) {
  time_s.push_back(time);
  turn_rad.push_back(turn);
  forward_m.push_back(forward);
}

void Poses::Add(double time, double x, double y, double heading, std::size_t line) {
  time_s.push_back(time);
  x_m.push_back(x);
  y_m.push_back(y);
  heading_rad.push_back(heading);
  from.line.push_back(line);
}

void Poses::RemoveLast() {
  for (SpooledRows<double>* column : {&time_s, &x_m, &y_m, &heading_rad}) column->pop_back();
  from.line.pop_back();
}

void Observations::Add(double time, std::int32_t which, double range, double bearing) {
  time_s.push_back(time);
  landmark.push_back(which);
  range_m.push_back(range);
  bearing_rad.push_back(bearing);
}

void VelocityIntegrator::Add(double time_s, double v_mps, double omega_radps, Odometry* odometry) {
  if (!begun_) odometry->Add(time_s, 0, 0);
  const double seconds = begun_ ? time_s - time_s_ : 0;
  if (seconds > 0) {
    const double turn = omega_radps_ * seconds, forward = v_mps_ * seconds;
    const bool both = turn != 0 && forward != 0;
    odometry->Add(time_s, both ? turn / 2 : turn, forward);
    if (both) odometry->Add(time_s, turn / 2, 0);
    largest_gap_s_ = std::max(largest_gap_s_, seconds);
  }
  begun_ = true;
  time_s_ = time_s;
  v_mps_ = v_mps;
  omega_radps_ = omega_radps;
}

void CheckNoise(const NoiseParameters& noise) {
  for (const auto& [name, parameter] : NamedParameters(noise)) {
    if (*parameter && !(std::isfinite(**parameter) && **parameter >= 0)) {
      throw InputError(std::string(name) + ": a noise parameter must be a number of at least 0");
    }
  }
  for (const auto& [name, share] :
       {std::pair{"noise/false_ratio", noise.false_ratio}, std::pair{"noise/miss_ratio", noise.miss_ratio}})
    if (share.value_or(0) > 1)
      throw InputError(std::string(name) + ": " + std::to_string(*share) + " is no share; allowed: 0 to 1");
  if (noise.max_range_m == 0.0)
    throw InputError("sensor/max_range_m: a sensor that sees nothing; allowed: a number above 0");
  // With room for a full turn that is written in a few digits.
  const double field = noise.field_of_view_rad.value_or(kFullTurn);
  if (field == 0 || field > kFullTurn + 0.01)
    throw InputError("sensor/field_of_view_rad: " + std::to_string(field) +
                     " is no field of view; allowed: above 0, up to a full turn (6.2832)");
}

std::optional<Misreading> FindMisreading(double range_m, double bearing_rad, const NoiseParameters& noise) {
  if (range_m < 0) return Misreading{"negative range", std::to_string(range_m) + " m"};
  if (noise.max_range_m && range_m > *noise.max_range_m)
    return Misreading{
        "beyond the sensor's maximum",
        std::to_string(range_m) + " m of " + std::to_string(*noise.max_range_m) + " m" +
            (range_m > 100 * *noise.max_range_m ? ": are ranges in millimetres? Cairn reads metres" : "")};
  constexpr double kRounding_rad = 1e-9;
  const double within = std::abs(NormalizedAngle(bearing_rad));
  if (noise.field_of_view_rad && within > *noise.field_of_view_rad / 2 + kRounding_rad)
    return Misreading{
        "outside the sensor's field of view",
        std::to_string(bearing_rad) + " rad, of at most " + std::to_string(*noise.field_of_view_rad / 2) +
            " rad to either side" +
            (std::abs(bearing_rad) > kFullTurn + 0.01 ? ": are bearings in degrees? Cairn reads radians"
                                                      : "")};
  return std::nullopt;
}

Blob MakeLog(LogRows rows, const std::string& source, ImportReport* report) {
  Blob log;
  std::vector<std::string> names;
  for (std::size_t n = 0; n < rows.robots.size(); ++n) {
    names.push_back(rows.robots[n].name);
    DoubtUnits(rows.robots[n], rows.noise.max_range_m.has_value(), report);
    Count(rows.robots[n], report);
    PutRobot(rows.robots[n], n, &log);
  }
  if (report->controls == 0) throw InputError(source + ": the log is empty: it has no controls");
  if (report->observations == 0 && report->scans == 0)
    report->warnings.emplace_back("the log has controls only: nothing can be mapped from it");
  report->robots = static_cast<std::int64_t>(names.size());
  report->landmarks = static_cast<std::int64_t>(rows.landmarks.size());
  log.Put("robots", Array::Texts(names));
  log.Put("landmarks", Array::Texts(rows.landmarks));
  for (std::string& hole : OdometryHolesOf(log)) report->warnings.push_back(std::move(hole));
  for (std::string& robot : RobotsWithoutObservationsOf(log)) report->warnings.push_back(std::move(robot));
  for (std::string& doubt : ObservationDoubtsOf(log)) report->warnings.push_back(std::move(doubt));
  for (std::string& doubt : RangeSensorDoubtsOf(log)) report->warnings.push_back(std::move(doubt));
  if (rows.truth_landmarks) {
    log.Put("truth/landmarks/name", Array::Texts(rows.truth_landmarks->name));
    log.PutVector("truth/landmarks/x_m", rows.truth_landmarks->x_m);
    log.PutVector("truth/landmarks/y_m", rows.truth_landmarks->y_m);
  }
  // No more than warnings: truth makes no map wrong.
  for (std::string& doubt : FindTruthDoubts(Read<kinds::Log>(log)))
    report->warnings.push_back(std::move(doubt));
  for (const auto& [name, parameter] : NamedParameters(rows.noise)) {
    if (*parameter) log.PutScalar<double>(name, **parameter);
  }
  return log;
}

double NormalizedAngle(double angle_rad) {
  constexpr double kPi = std::numbers::pi;
  if (angle_rad > -kPi && angle_rad <= kPi) return angle_rad;
  const double wrapped = std::remainder(angle_rad, 2 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

}  // namespace cairn::datasets
