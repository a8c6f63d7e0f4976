#include "datasets/common/log_parts.h"

#include <algorithm>
#include <string>

#include "schema/kinds/log.h"

namespace cairn::datasets {
namespace {

std::string Prefix(std::size_t robot) { return "robot/" + std::to_string(robot) + "/"; }

void RequireRobot(std::size_t robot, const std::vector<std::string>& names) {
  if (robot >= names.size())
    throw InputError("the log has no robot " + std::to_string(robot) + ", only " +
                     std::to_string(names.size()));
}

template <class T>
std::vector<T> Backwards(const Column<T>& column, std::size_t rows) {
  if (column.size() != rows) throw InputError("'" + column.name() + "': columns of different length");
  return {column.values().rbegin(), column.values().rend()};
}

std::vector<double> TimesFromEnd(const Column<double>& time_s, double end_s) {
  std::vector<double> times = Backwards(time_s, time_s.size());
  for (double& time : times) time = end_s - time;
  return times;
}

}  // namespace

Blob RobotsOf(const Blob& log, const std::vector<std::size_t>& robots) {
  const std::vector<std::string> names = log.Texts("robots");
  Blob part = log.Without("robot/").Without("truth/robot/");
  std::vector<std::string> kept;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    RequireRobot(robots[r], names);
    kept.push_back(names[robots[r]]);
    part.PutAll(Prefix(r), log.Sub(Prefix(robots[r])).Without("robot_observations/"));
    part.PutAll("truth/" + Prefix(r), log.Sub("truth/" + Prefix(robots[r])));
  }
  part.Put("robots", Array::Texts(kept));
  return part;
}

Blob Reversed(const Blob& log, std::size_t robot) {
  RequireRobot(robot, log.Texts("robots"));
  const Blob alone = RobotsOf(log, {robot});
  const auto parts = Read<kinds::Log>(alone);
  const kinds::Log::Odometry& own = parts.robot[0].odometry;
  const kinds::Log::Observations& seen = parts.robot[0].observations;
  Blob reversed = alone.Without("truth/");
  reversed.PutAll("truth/landmarks/", alone.Sub("truth/landmarks/"));
  const std::size_t controls = own.time_s.size(), rows = seen.time_s.size();
  if (controls == 0) return reversed;
  const auto end_s = Backwards(own.time_s, controls), turn = Backwards(own.turn_rad, controls),
             forward = Backwards(own.forward_m, controls);
  // A control is a turn and then a way; backwards the way comes first, so that each turn goes with the next
  // way. The first turn of all is undone last, in a control of its own.
  std::vector<double> time_s, turn_rad, forward_m;
  for (std::size_t i = 0; i <= controls; ++i) {
    const bool start = i == controls;
    const double step_s = controls > 1 ? end_s[controls - 2] - end_s[controls - 1] : 1.0;
    time_s.push_back(end_s[0] - (i + 1 < controls ? end_s[i + 1] : end_s[controls - 1] - step_s));
    turn_rad.push_back(i == 0 ? 0.0 : -turn[i - 1]);
    forward_m.push_back(start ? 0.0 : -forward[i]);
  }
  const std::string prefix = Prefix(0);
  PutFields(prefix + "odometry/", kinds::Log::Odometry{time_s, turn_rad, forward_m}, &reversed);
  PutFields(prefix + "observations/",
            kinds::Log::Observations{TimesFromEnd(seen.time_s, end_s[0]),
                                     Backwards(seen.range_m, rows),
                                     Backwards(seen.bearing_rad, rows),
                                     Backwards(seen.landmark, rows),
                                     {}},
            &reversed);
  kinds::Log::TrueRobot truth;
  if (!parts.truth.robot.empty()) truth = parts.truth.robot[0];
  kinds::Log::TrueRobot back;
  if (truth.landmark) back.landmark = Backwards(truth.landmark, truth.landmark.size());
  if (const kinds::PoseTable& poses = truth.poses; poses.time_s) {
    const std::size_t count = poses.time_s.size();
    back.poses = {TimesFromEnd(poses.time_s, end_s[0]), Backwards(poses.x_m, count),
                  Backwards(poses.y_m, count), Backwards(poses.heading_rad, count)};
  }
  PutFields("truth/" + prefix, back, &reversed);
  return reversed;
}

}  // namespace cairn::datasets
