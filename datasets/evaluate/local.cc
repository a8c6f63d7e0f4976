#include "datasets/evaluate/local.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>

#include "datasets/common/made_from.h"
#include "datasets/evaluate/relations.h"
#include "datasets/evaluate/track.h"
#include "schema/kinds/local_map.h"
#include "schema/kinds/log.h"
#include "schema/kinds/provenance.h"

namespace cairn::datasets {
namespace {

constexpr double kErrorDegree_rad = std::numbers::pi / 180;
constexpr double kWrongLoopM = 0.5, kRightAngleRad = 2 * kErrorDegree_rad;
constexpr std::int32_t kLoop = 2;  // connections/kind

// Sums up distances.
class ErrorSum {
 public:
  void Add(double error_m) {
    ++sum_.poses;
    sum_.rmse_m += error_m * error_m;
    sum_.mean_m += error_m;
    sum_.worst_m = std::max(sum_.worst_m, error_m);
  }
  PathError Error() const {
    PathError error = sum_;
    if (error.poses == 0) return error;
    error.rmse_m = std::sqrt(error.rmse_m / static_cast<double>(error.poses));
    error.mean_m /= static_cast<double>(error.poses);
    return error;
  }

 private:
  PathError sum_;
};

// A robot's path, the truth, and what odometry alone makes of it; what else the result and the truth have of
// it.
struct Robot {
  Track estimate, truth, odometry;
  kinds::LocalMap::Robot found;
  kinds::Log::TrueRobot of_truth;
};

std::vector<Robot> RobotsOf(const kinds::LocalMap& map, const kinds::Log& log) {
  if (map.robots.values() != log.robots.values())
    throw InputError("the result's robots are not the log's: was it made from this log?");
  std::vector<Robot> robots;
  bool known = false;
  for (std::size_t r = 0; r < log.robot.size(); ++r) {
    kinds::Log::TrueRobot truth;
    if (r < log.truth.robot.size()) truth = log.truth.robot[r];
    robots.push_back({TrackOf(map.robot[r].poses), TrackOf(truth.poses), DeadReckoned(log.robot[r].odometry),
                      map.robot[r], truth});
    known = known || !robots.back().truth.time_s.empty();
  }
  if (!known) throw InputError("the log has no true poses: nothing to evaluate against");
  return robots;
}

struct PosePair {
  Pose ours, theirs;
};

// At the times of `estimate`, where the truth knows.
std::vector<PosePair> Pairs(const Track& estimate, const Track& truth) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < estimate.time_s.size(); ++i) {
    if (const auto at = PoseAt(truth, estimate.time_s[i])) pairs.push_back({estimate.poses[i], *at});
  }
  return pairs;
}

Similarity FitPoses(const std::vector<PosePair>& pairs) {
  std::vector<PointPair> points;
  for (const PosePair& pair : pairs)
    points.push_back({{pair.ours.x_m, pair.ours.y_m}, {pair.theirs.x_m, pair.theirs.y_m}});
  return FitRigid(points);
}

void AddErrors(const std::vector<PosePair>& pairs, const Similarity& alignment, ErrorSum* sum) {
  for (const PosePair& pair : pairs) {
    const Pose moved = alignment(pair.ours);
    sum->Add(DistanceM({moved.x_m, moved.y_m}, {pair.theirs.x_m, pair.theirs.y_m}));
  }
}

double HeadingSquares(const std::vector<PosePair>& pairs, const Similarity& alignment) {
  double squares = 0;
  for (const PosePair& pair : pairs) {
    const double off = WrapAngle(alignment(pair.ours).heading_rad - pair.theirs.heading_rad);
    squares += off * off;
  }
  return squares;
}

void ScorePaths(const std::vector<Robot>& robots, LocalEvaluation* out) {
  std::size_t count = 0;
  double heading_squares = 0;
  ErrorSum path, odometry;
  for (const Robot& robot : robots) {
    const std::vector<PosePair> pairs = Pairs(robot.estimate, robot.truth);
    out->alignment.push_back(FitPoses(pairs));
    AddErrors(pairs, out->alignment.back(), &path);
    heading_squares += HeadingSquares(pairs, out->alignment.back());
    count += pairs.size();
    Track reckoned{robot.estimate.time_s, {}};
    for (const double time_s : reckoned.time_s)
      reckoned.poses.push_back(PoseAt(robot.odometry, time_s, HUGE_VAL).value_or(Pose{}));
    const std::vector<PosePair> dead = Pairs(reckoned, robot.truth);
    AddErrors(dead, FitPoses(dead), &odometry);
  }
  std::vector<TrackAndTruth> tracks;
  for (const Robot& robot : robots) tracks.push_back({robot.estimate, robot.truth});
  out->other_clock = FindOtherClock(tracks);
  if (count == 0)
    throw InputError("no pose of the result is of a time at which the truth has one" +
                     (out->other_clock ? "; " + out->other_clock->Text() : ""));
  out->path = path.Error();
  out->odometry = odometry.Error();
  out->heading_rmse_deg = std::sqrt(heading_squares / static_cast<double>(count)) / kErrorDegree_rad;
}

// Where the truth has the traces' frames: x is z, y is u.
class TrueFrames {
 public:
  TrueFrames(const kinds::LocalMap::Traces& traces, const std::vector<Robot>& robots) {
    for (std::size_t k = 0; k < traces.robot.size(); ++k) {
      const Robot& who = robots.at(static_cast<std::size_t>(traces.robot[k]));
      const Pose origin{traces.x_m[k], traces.y_m[k], traces.direction_rad[k]};
      const double first_s = traces.first_s[k], last_s = traces.last_s[k];
      frames_.push_back(Place(who, first_s, last_s, [&](std::size_t i) {
        return std::optional(Between(origin, who.estimate.poses[i]));
      }));
      odometric_.push_back(Place(who, first_s, last_s, [&](std::size_t i) {
        return PoseAt(who.odometry, who.estimate.time_s[i], HUGE_VAL);
      }));
    }
  }

  std::size_t size() const { return frames_.size(); }
  // None: the truth does not know where the trace was recorded.
  std::optional<Point> ToWorld(std::size_t trace, double z_m, double u_m) const {
    const auto& frame = frames_.at(trace);
    if (!frame) return std::nullopt;
    return (*frame)(Point{z_m, u_m});
  }
  // Where the robot is by what odometry alone says of its way since it recorded the trace.
  std::optional<Point> ByOdometry(std::size_t trace, const Robot& robot, double time_s) const {
    const auto& frame = odometric_.at(trace);
    const auto at = PoseAt(robot.odometry, time_s, HUGE_VAL);
    if (!frame || !at) return std::nullopt;
    return (*frame)(Point{at->x_m, at->y_m});
  }

 private:
  // The frame of `pose_of` each pose of the estimate. Turned as the path is, on average, and moved to where
  // its middle is: a short way says little of its turn.
  template <class PoseOf>
  static std::optional<Similarity> Place(const Robot& robot, double first_s, double last_s,
                                         const PoseOf& pose_of) {
    double sin = 0, cos = 0;
    Point ours, theirs;
    int count = 0;
    for (std::size_t i = 0; i < robot.estimate.time_s.size(); ++i) {
      const double time_s = robot.estimate.time_s[i];
      if (time_s < first_s || time_s > last_s) continue;
      const auto truth = PoseAt(robot.truth, time_s);
      const std::optional<Pose> at = pose_of(i);
      if (!truth || !at) continue;
      const double turn = truth->heading_rad - at->heading_rad;
      sin += std::sin(turn);
      cos += std::cos(turn);
      ours.x_m += at->x_m;
      ours.y_m += at->y_m;
      theirs.x_m += truth->x_m;
      theirs.y_m += truth->y_m;
      ++count;
    }
    if (count == 0) return std::nullopt;
    Similarity frame;
    frame.angle_rad = std::atan2(sin, cos);
    const Point turned = frame(Point{ours.x_m / count, ours.y_m / count});
    frame.x_m = theirs.x_m / count - turned.x_m;
    frame.y_m = theirs.y_m / count - turned.y_m;
    return frame;
  }

  std::vector<std::optional<Similarity>> frames_, odometric_;
};

// How far the robot was from a place in a trace; none where the truth does not know.
std::optional<double> OffM(const TrueFrames& frames, std::int32_t trace, double z_m, double u_m,
                           const Track& truth, double time_s) {
  const auto there = frames.ToWorld(static_cast<std::size_t>(trace), z_m, u_m);
  const auto at = PoseAt(truth, time_s);
  if (!there || !at) return std::nullopt;
  return DistanceM(*there, {at->x_m, at->y_m});
}

void ScorePositions(const std::vector<Robot>& robots, const TrueFrames& frames, LocalEvaluation* out) {
  ErrorSum sum, odometry;
  std::int64_t corrections = 0;
  for (const Robot& robot : robots) {
    const kinds::LocalMap::Positions& at = robot.found.positions;
    for (std::size_t i = 0; i < at.trace.OrNone().size(); ++i) {
      const double time_s = at.time_s[i];
      const auto off_m = OffM(frames, at.trace[i], at.z_m[i], at.u_m[i], robot.truth, time_s);
      if (!off_m) continue;
      sum.Add(*off_m);
      corrections += at.corrected[i];
      const auto reckoned = frames.ByOdometry(static_cast<std::size_t>(at.trace[i]), robot, time_s);
      const auto truth = PoseAt(robot.truth, time_s);
      if (reckoned && truth) odometry.Add(DistanceM(*reckoned, {truth->x_m, truth->y_m}));
    }
  }
  const PathError error = sum.Error();
  if (error.poses == 0) return;
  out->traces = error;
  out->traces_odometry = odometry.Error();
  out->corrected = static_cast<double>(corrections) / static_cast<double>(error.poses);
}

void ScoreLoops(const kinds::LocalMap& map, const std::vector<Robot>& robots, const TrueFrames& frames,
                LoopScore* out) {
  const kinds::LocalMap::Connections& c = map.connections;
  std::int64_t right = 0;
  for (std::size_t k = 0; k < c.kind.size(); ++k) {
    if (c.kind[k] != kLoop) continue;
    const std::int32_t robot = map.traces.robot[static_cast<std::size_t>(c.to[k])];
    const Track& truth = robots.at(static_cast<std::size_t>(robot)).truth;
    const auto off_m = OffM(frames, c.from[k], c.from_z_m[k], c.from_u_m[k], truth, c.to_s[k]);
    const bool used = c.used[k] != 0, wrong = off_m && *off_m > kWrongLoopM;
    ++(used ? out->found : out->rejected);
    if (wrong) ++(used ? out->wrong : out->rejected_wrong);
    if (!used || !off_m || wrong) continue;
    ++right;
    out->mean_m += *off_m;
  }
  if (right > 0) out->mean_m /= static_cast<double>(right);
}

double ModuloQuarter(double angle_rad) { return std::remainder(angle_rad, std::numbers::pi / 2); }

struct WallSums {
  std::int64_t scored = 0, within = 0, turned = 0, turned_found = 0, straight = 0, straight_told = 0;
  double error_rad = 0, first_lock_s = 0;
};

constexpr double kSame_rad = 1e-6;  // walls that stand so

// The walls that most rows are of: those of the building, whichever way its frame is turned.
double MainWalls(std::span<const double> angle_rad) {
  std::map<std::int64_t, std::size_t> rows;
  double main_rad = 0;
  std::size_t most = 0;
  for (const double angle : angle_rad) {
    const std::size_t count = ++rows[std::llround(ModuloQuarter(angle) / kSame_rad)];
    if (count <= most) continue;
    most = count;
    main_rad = angle;
  }
  return main_rad;
}

void AddWalls(const Robot& robot, WallSums* sums) {
  const kinds::LocalMap::Walls& walls = robot.found.walls;
  if (!walls.time_s || !robot.of_truth.walls_time_s) return;
  const std::span<const double> time = walls.time_s, angle = walls.angle_rad,
                                true_time = robot.of_truth.walls_time_s,
                                true_angle = robot.of_truth.walls_angle_rad;
  const std::span<const std::uint8_t> locked = walls.locked, other = walls.other_area;
  const double main_rad = MainWalls(true_angle);
  bool begun = false;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const auto next = std::ranges::lower_bound(true_time, time[i]);
    const auto truth = PoseAt(robot.truth, time[i]), reckoned = PoseAt(robot.odometry, time[i], HUGE_VAL);
    if (next == true_time.end() || !truth || !reckoned) continue;
    if (!begun && locked[i]) sums->first_lock_s = std::max(sums->first_lock_s, time[i] - time.front());
    begun = begun || locked[i];
    if (!begun) continue;
    const double wall_rad = true_angle[static_cast<std::size_t>(next - true_time.begin())];
    const bool turned = std::abs(ModuloQuarter(wall_rad - main_rad)) > kSame_rad;
    ++(turned ? sums->turned : sums->straight);
    if (other[i]) ++(turned ? sums->turned_found : sums->straight_told);
    if (turned || other[i] || std::isnan(angle[i])) continue;
    const double expected = wall_rad + reckoned->heading_rad - truth->heading_rad;
    const double off = std::abs(ModuloQuarter(angle[i] - expected));
    ++sums->scored;
    sums->error_rad += off;
    sums->within += off < kRightAngleRad ? 1 : 0;
  }
}

std::optional<WallScore> ScoreWalls(const std::vector<Robot>& robots) {
  WallSums sums;
  for (const Robot& robot : robots) AddWalls(robot, &sums);
  if (sums.scored == 0) return std::nullopt;
  const auto share = [](std::int64_t part, std::int64_t of) -> std::optional<double> {
    if (of == 0) return std::nullopt;
    return static_cast<double>(part) / static_cast<double>(of);
  };
  WallScore score;
  score.scans = sums.scored;
  score.error_deg = sums.error_rad / static_cast<double>(sums.scored) / kErrorDegree_rad;
  score.within_2_deg = *share(sums.within, sums.scored);
  score.first_lock_s = sums.first_lock_s;
  score.other_area_found = share(sums.turned_found, sums.turned);
  score.other_area_false = share(sums.straight_told, sums.straight);
  return score;
}

void AddPath(const LocalEvaluation& score, Scores* scores) {
  const auto add = [&](const std::string& prefix, const PathError& error) {
    scores->Add(prefix + "rmse_m", error.rmse_m);
    scores->Add(prefix + "mean_m", error.mean_m);
    scores->Add(prefix + "worst_m", error.worst_m);
  };
  add("trajectory.", score.path);
  scores->Add("trajectory.heading_rmse_deg", score.heading_rmse_deg);
  AddClock(score.other_clock, scores);
  add("trajectory.odometry_", score.odometry);
  if (score.traces) {
    add("trajectory.in_trace_", *score.traces);
    scores->Add("trajectory.in_trace_odometry_mean_m", score.traces_odometry.mean_m);
    scores->Add("trajectory.in_trace_corrected", Share{score.corrected}, " of the scans");
  } else {
    for (const char* name : {"rmse_m", "mean_m", "worst_m", "odometry_mean_m", "corrected"})
      scores->AddForPrograms(std::string("trajectory.in_trace_") + name, {});
  }
  scores->AddForPrograms("trajectory.poses", score.path.poses);
}

void AddWalls(const std::optional<WallScore>& walls, Scores* scores) {
  if (!walls) {
    scores->AddForPrograms("wall_orientation", {});
    return;
  }
  const auto share = [](const std::optional<double>& value) {
    return value ? ScoreValue(Share{*value}) : ScoreValue();
  };
  scores->Add("wall_orientation.error_deg", walls->error_deg, " on average");
  scores->Add("wall_orientation.within_2_deg", Share{walls->within_2_deg},
              " of the scans after the first lock");
  scores->Add("wall_orientation.first_lock_s", walls->first_lock_s);
  scores->AddForPrograms("wall_orientation.scans", walls->scans);
  scores->Add("wall_orientation.other_area_found", share(walls->other_area_found),
              walls->other_area_found ? " of the scans in turned areas" : "no area is turned");
  scores->Add("wall_orientation.other_area_false", share(walls->other_area_false),
              walls->other_area_false ? " of the other scans" : "no area is turned");
}

}  // namespace

LocalEvaluation EvaluateLocal(const Blob& result, const Blob& log) {
  for (const char* name : {"robots", "traces/robot", "connections/kind"})
    if (!result.Has(name)) throw InputError(std::string("not a local_map: '") + name + "' is missing");
  CheckMadeFrom(result, log);
  const auto map = Read<kinds::LocalMap>(result);
  const std::vector<Robot> robots = RobotsOf(map, Read<kinds::Log>(log));
  LocalEvaluation out;
  ScorePaths(robots, &out);
  const TrueFrames frames(map.traces, robots);
  ScorePositions(robots, frames, &out);
  ScoreLoops(map, robots, frames, &out.loops);
  out.walls = ScoreWalls(robots);
  out.trace_count = static_cast<std::int64_t>(frames.size());
  for (const Robot& robot : robots)
    out.cuts += static_cast<std::int64_t>(robot.found.cuts.time_s.OrNone().size());
  out.seconds = kinds::Provenance::In(result).seconds_s.Optional();
  return out;
}

Scores MakeScores(const LocalEvaluation& score) {
  Scores scores;
  AddPath(score, &scores);
  AddWalls(score.walls, &scores);
  scores.Add("loops.found", score.loops.found, fmt::format(", {} of them wrong", score.loops.wrong));
  scores.AddForPrograms("loops.wrong", score.loops.wrong);
  const bool any_right = score.loops.found > score.loops.wrong;
  scores.Add("loops.mean_m", any_right ? ScoreValue(score.loops.mean_m) : ScoreValue(),
             any_right ? " off those that are right" : "");
  scores.Add("loops.rejected", score.loops.rejected,
             fmt::format(", {} of them wrong", score.loops.rejected_wrong));
  scores.AddForPrograms("loops.rejected_wrong", score.loops.rejected_wrong);
  scores.Add("traces", score.trace_count);
  scores.Add("cuts", score.cuts);
  scores.Add("seconds", OrNone(score.seconds));
  // Of the first robot; each of the others has one of its own.
  scores.AddForPrograms("alignment.angle_rad", score.alignment.front().angle_rad);
  scores.AddForPrograms("alignment.x_m", score.alignment.front().x_m);
  scores.AddForPrograms("alignment.y_m", score.alignment.front().y_m);
  return scores;
}

}  // namespace cairn::datasets
