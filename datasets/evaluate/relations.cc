#include "datasets/evaluate/relations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "datasets/common/array_text.h"
#include "datasets/common/control.h"
#include "datasets/common/fields.h"
#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

constexpr double kRelationDegree_rad = std::numbers::pi / 180;

std::size_t RobotOf(const Blob& blob, const std::string& robot) {
  const std::vector<std::string> robots = blob.Texts("robots");
  if (robot.empty() && robots.size() == 1) return 0;
  const auto found = std::ranges::find(robots, robot);
  if (found == robots.end())
    throw InputError((robot.empty() ? "which robot? " : "there is no robot '" + robot + "'; there are: ") +
                     NameList(robots));
  return static_cast<std::size_t>(found - robots.begin());
}

}  // namespace

Track DeadReckoned(const kinds::Log::Odometry& odometry) {
  const std::span<const double> time = odometry.time_s, turn = odometry.turn_rad,
                                forward = odometry.forward_m;
  Track track;
  Pose pose;
  for (std::size_t i = 0; i < time.size(); ++i) {
    pose = Apply(pose, {turn[i], forward[i]});
    if (i == 0 || time[i] > time[i - 1]) {
      track.time_s.push_back(time[i]);
      track.poses.emplace_back();
    }
    track.poses.back() = pose;
  }
  return track;
}

std::vector<Relation> ReadRelations(const std::string& path) {
  constexpr std::size_t kValues = 8;
  BadLines bad(false);
  std::vector<Relation> relations;
  ForEachLine(path, &bad, [&](const Fields& line, std::size_t) {
    if (line.size() != kValues)
      throw LineError{"wrong number of values",
                      std::to_string(line.size()) + " where 'time time x y z roll pitch yaw' are needed"};
    const Pose motion = line.PoseAt(2);  // whose third number is z
    for (const std::size_t tilt : {5, 6}) static_cast<void>(line.Number(tilt));
    relations.push_back({line.Stamp(0), line.Stamp(1), {motion.x_m, motion.y_m, WrapAngle(line.Number(7))}});
  });
  if (relations.empty()) throw InputError(path + ": there are no relations in it");
  return relations;
}

RelationScore ScoreRelations(const Track& track, const std::vector<Relation>& relations, double offset_s) {
  constexpr double kAnyGap = std::numeric_limits<double>::infinity();
  RelationScore score;
  double squares_m2 = 0, squares_deg2 = 0;
  for (const Relation& relation : relations) {
    const auto from = PoseAt(track, relation.from_s - offset_s, kAnyGap),
               to = PoseAt(track, relation.to_s - offset_s, kAnyGap);
    if (!from || !to) {
      ++score.outside;
      continue;
    }
    const Pose error = Relative(relation.motion, Relative(*from, *to));
    const double translation_m = std::hypot(error.x_m, error.y_m);
    const double rotation_deg = std::abs(error.heading_rad) / kRelationDegree_rad;
    ++score.scored;
    score.translation_m += translation_m;
    score.rotation_deg += rotation_deg;
    squares_m2 += translation_m * translation_m;
    squares_deg2 += rotation_deg * rotation_deg;
  }
  if (score.scored == 0) {
    const std::string span = track.time_s.empty() ? "there are none"
                                                  : "they go from " + ShortNumber(track.time_s.front()) +
                                                        " to " + ShortNumber(track.time_s.back()) + " s";
    throw InputError("no relation lies within the time of the poses: " + span +
                     ", the first relation is of " + ShortNumber(relations.front().from_s) +
                     " s; --offset-s says what the relations' clock is ahead");
  }
  const auto count = static_cast<double>(score.scored);
  score.translation_m /= count;
  score.rotation_deg /= count;
  score.translation_rms_m = std::sqrt(squares_m2 / count);
  score.rotation_rms_deg = std::sqrt(squares_deg2 / count);
  return score;
}

Track ReadTrajectory(const Blob& blob, const std::string& robot) {
  const std::string prefix = "robot/" + std::to_string(RobotOf(blob, robot)) + "/";
  for (const char* group : {"poses/", "laser/", "sonar/"}) {
    if (blob.Has(prefix + group + "x_m")) return TrackOf(kinds::LikeliestPoses(prefix + group, blob));
  }
  if (blob.Has(prefix + "odometry/time_s"))
    return DeadReckoned(FieldsIn<kinds::Log::Odometry>(prefix + "odometry/", blob));
  throw InputError("there are neither poses nor odometry of the robot in it");
}

Scores MakeScores(const RelationScore& score) {
  Scores scores;
  scores.Add("relations.translation_m", score.translation_m, " on average");
  scores.Add("relations.rotation_deg", score.rotation_deg, " on average");
  scores.Add("relations.translation_rms_m", score.translation_rms_m);
  scores.Add("relations.rotation_rms_deg", score.rotation_rms_deg);
  scores.Add("relations.scored", score.scored);
  scores.Add("relations.outside", score.outside, ", outside the time of the poses");
  return scores;
}

}  // namespace cairn::datasets
