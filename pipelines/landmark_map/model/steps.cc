#include "pipelines/landmark_map/model/steps.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/odometry.h"

namespace cairn::landmark_map {
namespace {

struct Detection {
  OdometricPose at;
  std::size_t row;
  std::int32_t type;
  double range_m, bearing_rad;  // NaN: at the robot
  bool contact() const { return std::isnan(range_m); }
};

[[noreturn]] void Refuse(const std::string& robot, std::size_t row, const std::string& why) {
  throw InputError("robot '" + robot + "', observation " + std::to_string(row) + ": " + why);
}

// For each row, the layer of the landmark.
std::vector<std::int32_t> TypesOf(const kinds::Log::Observations& seen, const std::string& name,
                                  const StepRules& rules) {
  const std::span<const std::int32_t> landmark = seen.landmark;
  std::vector<std::int32_t> types(landmark.size(), rules.types);
  for (std::size_t i = 0; i < landmark.size(); ++i) {
    if (rules.classes > 1) {
      if (seen.type[i] < 0) Refuse(name, i, "without a type, where the log has types");
      types[i] += seen.type[i];
    }
    if (landmark[i] >= 0) types[i] = landmark[i];
  }
  return types;
}

std::vector<Detection> DetectionsOf(const kinds::Log::Observations& seen, const std::string& name,
                                    const Odometry& odometry, const StepRules& rules) {
  const std::vector<std::int32_t> types = TypesOf(seen, name, rules);
  const std::span<const double> time = seen.time_s, range = seen.range_m, bearing = seen.bearing_rad;
  std::vector<Detection> detections;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (std::isnan(range[i]) != std::isnan(bearing[i]))
      Refuse(name, i, "range without bearing, or the reverse");
    constexpr double kSlack_s = 1.0;  // sensors and odometry seldom stop in the same instant
    if (time[i] < odometry.time_s.front() - kSlack_s) Refuse(name, i, "before the first control");
    if (time[i] > odometry.time_s.back() + kSlack_s) Refuse(name, i, "after the last control");
    detections.push_back({PoseAt(odometry, time[i]), i, types[i], range[i], bearing[i]});
  }
  return detections;
}

Observation Turned(const Observation& o, double angle) {
  const double cosine = std::cos(angle), sine = std::sin(angle);
  return {o.type, cosine * o.x_m - sine * o.y_m, sine * o.x_m + cosine * o.y_m};
}

// Where steps stand: the progress along the track at which each range-bearing observation is gathered, and
// the splits of long motion increments.
class StepPlanner {
 public:
  StepPlanner(const Odometry& odometry, const StepRules& rules) : odometry_(odometry), rules_(rules) {}

  // From range-bearing observation `begin` on; the first step is the one that gathers it (`late`) or stands
  // at the track's start.
  void Plan(const std::vector<Detection>& detections, std::size_t begin, bool late, RobotSteps* steps) {
    steps_ = steps;
    if (!late) AddStep(PoseOf(odometry_, 0));
    for (std::size_t i = begin; i < detections.size();) i = AddFrame(detections, i);
    const bool all = rules_.until_s >= odometry_.time_s.back();
    MoveTo(all ? PoseOf(odometry_, odometry_.time_s.size() - 1) : PoseAt(odometry_, rules_.until_s));
    steps_->first_observation.push_back(static_cast<std::int32_t>(steps_->observations.size()));
  }

 private:
  // Progress in units of frames: a distance of frame_m or a turn of frame_rad is one.
  double Progress(const OdometricPose& pose) const {
    return pose.path_m / rules_.frame_m + pose.turn_rad / rules_.frame_rad;
  }

  void AddStep(const OdometricPose& pose) {
    const bool first = steps_->time_s.empty();
    steps_->time_s.push_back(pose.time_s);
    steps_->odo_x_m.push_back(pose.x_m);
    steps_->odo_y_m.push_back(pose.y_m);
    steps_->odo_heading_rad.push_back(pose.heading_rad);
    steps_->path_m.push_back(first ? 0.0 : pose.path_m - last_.path_m);
    steps_->turn_rad.push_back(first ? 0.0 : pose.turn_rad - last_.turn_rad);
    steps_->first_observation.push_back(static_cast<std::int32_t>(steps_->observations.size()));
    last_ = pose;
  }

  // A step at `pose`, with others before it where the distance there is too long; none where the robot has
  // not moved.
  void MoveTo(const OdometricPose& pose) {
    if (steps_->time_s.empty()) return AddStep(pose);
    const double travelled = pose.path_m - last_.path_m;
    const int parts = std::max(1, static_cast<int>(std::ceil(travelled / rules_.max_increment_m)));
    const double start = last_.path_m;
    // [TBF98] section 5, coarse-grained time
    for (int k = 1; k < parts; ++k) AddStep(PoseAtPath(odometry_, start + travelled * k / parts));
    if (travelled > 0 || pose.turn_rad > last_.turn_rad) AddStep(pose);
  }

  // Gathers the range-bearing observations from `begin` on that share a frame; returns the first that does
  // not.
  std::size_t AddFrame(const std::vector<Detection>& detections, std::size_t begin) {
    std::size_t end = begin + 1;
    if (detections[begin].contact()) {
      MoveTo(detections[begin].at);
    } else {
      const double reach = Progress(detections[begin].at) + 1.0;
      while (end < detections.size() && !detections[end].contact() && Progress(detections[end].at) < reach)
        ++end;
      MoveTo(detections[begin + (end - begin) / 2].at);
    }
    AddObservations(detections, begin, end);
    return end;
  }

  // Means of the vectors to each identified landmark; of unidentified ones those nearest to the step, one
  // image's.
  void AddObservations(const std::vector<Detection>& detections, std::size_t begin, std::size_t end) {
    const auto first = static_cast<std::int32_t>(steps_->observations.size());
    std::vector<int> counts;
    const double shown_s = detections[begin + (end - begin) / 2].at.time_s;
    for (std::size_t i = begin; i < end; ++i) {
      const Detection& seen = detections[i];
      const bool unknown = seen.type >= rules_.types;
      if (unknown && !seen.contact() && seen.at.time_s != shown_s) continue;
      std::int32_t k = first;
      const auto known = static_cast<std::int32_t>(steps_->observations.size());
      while (k < known && (unknown || steps_->observations[k].type != seen.type)) ++k;
      if (k == known) {
        steps_->observations.push_back({seen.type, 0.0, 0.0});
        counts.push_back(0);
      }
      Accumulate(seen, &steps_->observations[k], ++counts[k - first]);
      steps_->row_observation[i] = k;
    }
  }

  void Accumulate(const Detection& seen, Observation* observation, int count) const {
    if (seen.contact()) return;  // the vector is zero
    const double angle = seen.at.heading_rad + seen.bearing_rad;
    const double x = seen.at.x_m - last_.x_m + seen.range_m * std::cos(angle);
    const double y = seen.at.y_m - last_.y_m + seen.range_m * std::sin(angle);
    observation->x_m += (x - observation->x_m) / count;
    observation->y_m += (y - observation->y_m) / count;
  }

  const Odometry& odometry_;
  const StepRules& rules_;
  RobotSteps* steps_ = nullptr;
  OdometricPose last_{};
};

// Of a robot none of whose observations tells where it is in the first robot's map.
[[noreturn]] void RefuseUnplaced(const std::string& name, bool observed, const std::vector<bool>& shared) {
  if (!observed)
    throw InputError("robot '" + name +
                     "' has no observations: it cannot be placed; leave its rows out of the odometry");
  if (std::ranges::none_of(shared, std::identity{}))
    throw InputError("the first robot has no observations: robot '" + name +
                     "' cannot be placed in its map; leave the first robot's rows out of the odometry");
  throw InputError(
      "robot '" + name +
      "' has seen nothing that the first robot saw too: it cannot be placed; landmarks that both "
      "saw need the same names, two at least, or none. Or map each robot by itself");
}

}  // namespace

MotionIncrement RobotSteps::IncrementTo(int step) const {
  if (step == 0) return {};
  return {odo_x_m[step] - odo_x_m[step - 1], odo_y_m[step] - odo_y_m[step - 1], path_m[step], turn_rad[step]};
}

RobotSteps RobotSteps::In(const Blob& blob, int layers, double cell_m) {
  RobotSteps steps = Read<RobotSteps>(blob);
  const std::size_t count = steps.time_s.size();
  const auto observations = static_cast<std::int64_t>(steps.observations.size());
  RequireWithin("the number of steps", static_cast<std::int64_t>(count), 1, kMostSteps);
  for (const auto* const values : {&steps.odo_x_m, &steps.odo_y_m, &steps.odo_heading_rad}) {
    RequireSize("a step's odometry", values->size(), count);
    RequireAllWithin("a step's odometry", *values, -kFar_m, kFar_m);
  }
  for (const auto* const values : {&steps.path_m, &steps.turn_rad}) {
    RequireSize("a step's motion", values->size(), count);
    RequireAllWithin("a step's motion", *values, 0.0, kFar_m);
  }
  RequireSize("first_observation", steps.first_observation.size(), count + 1);
  std::int64_t before = 0;
  for (const std::int32_t first : steps.first_observation) {
    RequireWithin("first_observation", std::int64_t{first}, before, observations);
    before = first;
  }
  const double farthest_m = (1 << 26) * cell_m;
  for (const Observation& observation : steps.observations) {
    RequireWithin("an observation's type", std::int64_t{observation.type}, 0, std::int64_t{layers} - 1);
    RequireWithin("an observation's x_m", observation.x_m, -farthest_m, farthest_m);
    RequireWithin("an observation's y_m", observation.y_m, -farthest_m, farthest_m);
  }
  RequireAllWithin("row_observation", steps.row_observation, std::int64_t{-1}, observations - 1);
  return steps;
}

std::vector<double> RobotSteps::DistanceTravelled() const {
  std::vector<double> travelled(path_m.size(), 0.0);
  for (std::size_t s = 1; s < travelled.size(); ++s) travelled[s] = travelled[s - 1] + path_m[s];
  return travelled;
}

RobotSteps RobotSteps::WithoutDrift(double drift_rad_per_m) const {
  RobotSteps steps = *this;
  if (drift_rad_per_m == 0.0) return steps;
  const std::vector<double> travelled = DistanceTravelled();
  for (int s = 0; s < size(); ++s) {
    const double turn = -drift_rad_per_m * travelled[s];
    steps.odo_heading_rad[s] += turn;
    if (s > 0) {
      const MotionIncrement increment = IncrementTo(s);
      const Observation moved =
          Turned({0, increment.dx_m, increment.dy_m}, turn + 0.5 * drift_rad_per_m * increment.path_m);
      steps.odo_x_m[s] = steps.odo_x_m[s - 1] + moved.x_m;
      steps.odo_y_m[s] = steps.odo_y_m[s - 1] + moved.y_m;
    }
    for (int k = first_observation[s]; k < first_observation[s + 1]; ++k) {
      steps.observations[k] = Turned(observations[k], turn);
    }
  }
  return steps;
}

RobotSteps MakeSteps(const kinds::Log::Robot& robot, const std::string& name, const StepRules& rules,
                     const std::vector<bool>* shared) {
  const Odometry whole = Integrate(robot.odometry, name);
  std::vector<Detection> detections = DetectionsOf(robot.observations, name, whole, rules);
  RobotSteps steps;
  steps.row_observation.assign(detections.size(), -1);
  const Odometry odometry = Until(whole, rules.until_s);
  while (!detections.empty() && detections.back().at.time_s > rules.until_s) detections.pop_back();
  for (Detection& seen : detections) seen.at = PoseAt(odometry, seen.at.time_s);
  std::size_t begin = 0;
  if (shared != nullptr) {
    while (begin < detections.size() && !(*shared)[static_cast<std::size_t>(detections[begin].type)]) ++begin;
    if (begin == detections.size())
      RefuseUnplaced(name, !robot.observations.time_s.OrNone().empty(), *shared);
  }
  StepPlanner(odometry, rules).Plan(detections, begin, shared != nullptr, &steps);
  return steps;
}

}  // namespace cairn::landmark_map
