#include "datasets/common/log_parts.h"

#include <algorithm>
#include <string>

namespace cairn::datasets {
namespace {

std::string Prefix(std::size_t robot) { return "robot/" + std::to_string(robot) + "/"; }

void RequireRobot(std::size_t robot, const std::vector<std::string>& names) {
  if (robot >= names.size())
    throw InputError("the log has no robot " + std::to_string(robot) + ", only " +
                     std::to_string(names.size()));
}

template <class T>
std::vector<T> Backwards(const Blob& blob, const std::string& name, std::size_t rows) {
  const auto values = blob.Get<T>(name);
  if (values.size() != rows) throw InputError("'" + name + "': columns of different length");
  return {values.rbegin(), values.rend()};
}

std::vector<double> TimesFromEnd(const std::vector<double>& backwards, double end_s) {
  std::vector<double> times;
  for (const double time : backwards) times.push_back(end_s - time);
  return times;
}

// True poses and associations, as far as there are any.
void ReverseTruth(const Blob& truth, double end_s, Blob* reversed) {
  const std::string prefix = "truth/" + Prefix(0);
  if (truth.Has("observations/landmark")) {
    const std::size_t seen = truth.Get<std::int32_t>("observations/landmark").size();
    reversed->PutVector(prefix + "observations/landmark",
                        Backwards<std::int32_t>(truth, "observations/landmark", seen));
  }
  if (!truth.Has("poses/time_s")) return;
  const std::size_t poses = truth.Get<double>("poses/time_s").size();
  reversed->PutVector(prefix + "poses/time_s",
                      TimesFromEnd(Backwards<double>(truth, "poses/time_s", poses), end_s));
  for (const char* name : {"poses/x_m", "poses/y_m", "poses/heading_rad"})
    reversed->PutVector(prefix + name, Backwards<double>(truth, name, poses));
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
  const Blob own = log.Sub(Prefix(robot));
  const Blob alone = RobotsOf(log, {robot});
  Blob reversed = alone.Without("truth/");
  reversed.PutAll("truth/landmarks/", alone.Sub("truth/landmarks/"));
  const std::size_t controls = own.Get<double>("odometry/time_s").size();
  const std::size_t seen = own.Get<double>("observations/time_s").size();
  if (controls == 0) return reversed;
  const auto end_s = Backwards<double>(own, "odometry/time_s", controls);
  const auto turn = Backwards<double>(own, "odometry/turn_rad", controls);
  const auto forward = Backwards<double>(own, "odometry/forward_m", controls);
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
  reversed.PutVector(prefix + "odometry/time_s", time_s);
  reversed.PutVector(prefix + "odometry/turn_rad", turn_rad);
  reversed.PutVector(prefix + "odometry/forward_m", forward_m);
  reversed.PutVector(prefix + "observations/time_s",
                     TimesFromEnd(Backwards<double>(own, "observations/time_s", seen), end_s[0]));
  reversed.PutVector(prefix + "observations/landmark",
                     Backwards<std::int32_t>(own, "observations/landmark", seen));
  for (const char* name : {"observations/range_m", "observations/bearing_rad"})
    reversed.PutVector(prefix + name, Backwards<double>(own, name, seen));
  ReverseTruth(alone.Sub("truth/" + prefix), end_s[0], &reversed);
  return reversed;
}

}  // namespace cairn::datasets
