#include "datasets/evaluate/evaluate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "datasets/common/made_from.h"
#include "datasets/evaluate/landmarks.h"
#include "datasets/evaluate/matching/align.h"
#include "datasets/evaluate/matching/associations.h"
#include "datasets/evaluate/track.h"
#include "datasets/verdicts/landmark_map_verdict.h"
#include "schema/kinds/provenance.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

class Evaluator {
 public:
  Evaluator(const Blob& result, const Blob& log, const ReferencePoint& point)
      : result_blob_(result),
        log_blob_(log),
        point_(point),
        result_(Read<kinds::LandmarkMap>(result)),
        log_(Read<kinds::Log>(log)) {}

  Evaluation Run() {
    Check();
    ReadLandmarks();
    ReadAssociations();
    ReadTracks();
    Align();
    ScoreTrajectories();
    FindOtherFrames();
    if (has_landmarks_) ScoreLandmarks();
    ScoreCalibration();
    if (truth_associations_) {
      const TopologyScore topology =
          ScoreTopology(map_associations_, ReadLookedAt(result_, map_associations_),
                        ReadContacts(log_, map_associations_), *truth_associations_, extracted_.size());
      out_.topology_correct = topology.correct;
      out_.observations = topology.observations;
      out_.unused = topology.unused;
      out_.associations = topology.associations;
      out_.wrong = topology.wrong;
    }
    out_.iterations = static_cast<std::int64_t>(result_.history.log_likelihood.size());
    if (RefinementRefused(result_blob_)) out_.refinement_refused = NotRefined(result_blob_);
    out_.seconds = kinds::Provenance::In(result_blob_).seconds_s.Optional();
    return out_;
  }

 private:
  void Check() const {
    if (log_blob_.Sub("truth/").fields().empty()) {
      throw InputError("the log has no truth: nothing to evaluate against");
    }
    for (const char* name : {"robots", "map/landmark_x_m", "map/landmark_y_m", "history/log_likelihood"}) {
      if (!result_blob_.Has(name))
        throw InputError(std::string("not a landmark_map: '") + name + "' is missing");
    }
    const std::vector<std::string>&robots = result_.robots, &expected = log_.robots;
    if (robots != expected) {
      throw InputError("the result's robots (" + NameList(robots) + ") are not the log's (" +
                       NameList(expected) + "): was it made from this log?");
    }
    CheckMadeFrom(result_blob_, log_blob_);
  }

  // A path lies within the robot's controls; where it stood still at the end the path may end before them.
  void CheckTimes(std::size_t robot, const std::vector<double>& times_s) const {
    const auto controls_s = log_.robot[robot].odometry.time_s.OrNone();
    constexpr double kSlack_s = 1.1;  // observations may be up to 1 s outside the controls
    if (times_s.empty() || controls_s.empty() ||
        (times_s.back() >= controls_s.front() - kSlack_s && times_s.back() <= controls_s.back() + kSlack_s)) {
      return;
    }
    throw InputError("the result's poses of robot '" + log_.robots[robot] +
                     "' do not have the log's times: was it made from this log?");
  }

  void ReadLandmarks() {
    extracted_ = PointsOf(result_.map.landmark_x_m, result_.map.landmark_y_m);
    const kinds::Log::Landmarks& truth = log_.truth.landmarks;
    has_landmarks_ = static_cast<bool>(truth.x_m);
    if (has_landmarks_) all_true_ = PointsOf(truth.x_m, truth.y_m);
    identity_ = MapIdentities(result_, log_);
  }

  // The true landmarks that count come first to be known here: associations name them by their index among
  // all.
  void ReadAssociations() {
    map_associations_ = ReadMapAssociations(result_, log_, extracted_.size());
    if (!has_landmarks_) return;
    truth_associations_ = ReadTrueAssociations(log_, all_true_.size());
    const std::vector<bool> observed = ObservedLandmarks(log_);
    for (std::size_t t = 0; t < all_true_.size(); ++t) {
      if (!observed[t]) continue;
      true_index_.push_back(t);
      true_.push_back(all_true_[t]);
    }
  }

  void ReadTracks() {
    for (std::size_t r = 0; r < log_.robot.size(); ++r) {
      const kinds::LandmarkMap::RobotPoses& poses = result_.robot[r].poses;
      if (!poses.mode_x_m) throw InputError("not a landmark_map: '" + poses.mode_x_m.name() + "' is missing");
      Track estimate{poses.time_s.OrNone().empty() ? std::vector<double>() : poses.time_s.vector(), {}};
      for (std::size_t i = 0; i < estimate.time_s.size(); ++i) estimate.poses.push_back(poses.Mode(i));
      CheckTimes(r, estimate.time_s);
      const Track truth = r < log_.truth.robot.size() ? TrackOf(log_.truth.robot[r].poses) : Track();
      std::vector<std::pair<Pose, Pose>> pairs;
      for (std::size_t i = 0; i < estimate.time_s.size(); ++i) {
        const auto at = PoseAt(truth, estimate.time_s[i]);
        if (at) pairs.emplace_back(estimate.poses[i], *at);
      }
      pose_pairs_.push_back(std::move(pairs));
      tracks_.push_back({std::move(estimate), truth});
      out_.robots.push_back({.name = log_.robots[r], .rmse_m = {}, .heading_rmse_rad = {}, .poses = 0});
    }
  }

  std::vector<PointPair> PairsOfPoses() const {
    std::vector<PointPair> positions;
    for (const auto& robot : pose_pairs_) {
      for (const auto& [ours, theirs] : robot) {
        positions.push_back({{ours.x_m, ours.y_m}, {theirs.x_m, theirs.y_m}});
      }
    }
    return positions;
  }

  void Align() {
    const std::vector<PointPair> positions = PairsOfPoses();
    const bool both = !extracted_.empty() && !true_.empty();
    if (!positions.empty() && !(both && InOnePlace(positions))) {
      out_.aligned_on = "poses";
      out_.alignment = FitRigid(positions);
    } else if (both) {
      out_.aligned_on = "landmarks";
      out_.alignment = AlignOnLandmarks();
    } else {
      out_.aligned_on = "nothing";
    }
  }

  // Whether the robots' true places lie so close together, seen from their mean beside the true landmarks,
  // that the least error of theirs would turn the map: robots that turn on the spot.
  bool InOnePlace(const std::vector<PointPair>& positions) const {
    constexpr double kLeastSpread = 0.05;
    const auto count = static_cast<double>(positions.size());
    Point mean;
    for (const PointPair& pair : positions) {
      mean.x_m += pair.to.x_m / count;
      mean.y_m += pair.to.y_m / count;
    }
    const auto square = [&](Point at) { return std::pow(DistanceM(at, mean), 2); };
    double places = 0, landmarks = 0;
    for (const PointPair& pair : positions) places += square(pair.to) / count;
    for (const Point& at : true_) landmarks += square(at) / static_cast<double>(true_.size());
    return places < kLeastSpread * kLeastSpread * landmarks;
  }

  // Landmarks whose identities are known, as indices into true_.
  IndexPairs KnownPairs() const {
    IndexPairs known;
    for (std::size_t k = 0; k < extracted_.size(); ++k) {
      const auto it =
          std::find(true_index_.begin(), true_index_.end(), static_cast<std::size_t>(identity_[k]));
      if (identity_[k] != kNoTruth && it != true_index_.end()) {
        known.emplace_back(k, static_cast<std::size_t>(it - true_index_.begin()));
      }
    }
    return known;
  }

  Similarity AlignOnLandmarks() const {
    const IndexPairs known = KnownPairs();
    if (known.size() >= 2) return FitRigid(PairUp(extracted_, true_, known));
    return SearchRigid(extracted_, true_, MayMatchIdentity(), Guess());
  }

  void FindOtherFrames() {
    out_.other_frame = FindOtherFrame(PairsOfPoses());
    out_.other_landmark_frame = FindOtherFrame(PairUp(extracted_, true_, KnownPairs()));
  }

  // From the associations, as indices into true_.
  IndexPairs Guess() const {
    IndexPairs guess;
    if (!truth_associations_) return guess;
    for (const auto& [k, t] : MajorityPairs(map_associations_, *truth_associations_, extracted_.size())) {
      const auto it = std::find(true_index_.begin(), true_index_.end(), t);
      guess.emplace_back(k, static_cast<std::size_t>(it - true_index_.begin()));
    }
    return guess;
  }

  MayMatch MayMatchIdentity() const {
    return [this](std::size_t k, std::size_t t) {
      return identity_[k] == kNoTruth || static_cast<std::size_t>(identity_[k]) == true_index_[t];
    };
  }

  PointMatch Match() const {
    std::vector<Point> moved;
    moved.reserve(extracted_.size());
    for (const Point& point : extracted_) moved.push_back(out_.alignment(point));
    return MatchPoints(moved, true_, MayMatchIdentity());
  }

  void ScoreTrajectories() {
    for (std::size_t r = 0; r < pose_pairs_.size(); ++r) {
      const auto& pairs = pose_pairs_[r];
      RobotScore& score = out_.robots[r];
      score.poses = static_cast<std::int64_t>(pairs.size());
      if (pairs.empty()) continue;
      double squares = 0, heading_squares = 0;
      for (const auto& [ours, theirs] : pairs) {
        const Pose moved = out_.alignment(ours);
        const double distance = DistanceM({moved.x_m, moved.y_m}, {theirs.x_m, theirs.y_m});
        const double turn = WrapAngle(moved.heading_rad - theirs.heading_rad);
        squares += distance * distance;
        heading_squares += turn * turn;
      }
      score.rmse_m = std::sqrt(squares / static_cast<double>(pairs.size()));
      score.heading_rmse_rad = std::sqrt(heading_squares / static_cast<double>(pairs.size()));
      out_.trajectory_rmse_m = std::max(out_.trajectory_rmse_m.value_or(0), *score.rmse_m);
    }
    out_.other_clock = FindOtherClock(tracks_);
    if (out_.trajectory_rmse_m) return;
    const bool known = std::ranges::any_of(log_.truth.robot, [](const kinds::Log::TrueRobot& robot) {
      return !robot.poses.time_s.OrNone().empty();
    });
    out_.no_trajectory = known ? "no true pose is of a time at which the robot drove: is it another clock?"
                               : "the truth has no poses";
  }

  void ScoreLandmarks() {
    const PointMatch match = Match();
    LandmarkScore score;
    score.found = score.within_3m = static_cast<std::int64_t>(match.pairs.size());
    score.missed = static_cast<std::int64_t>(true_.size()) - score.found;
    score.spurious = static_cast<std::int64_t>(extracted_.size()) - score.found;
    score.gospa_m = match.gospa_m;
    if (!match.pairs.empty()) {
      const std::vector<PointPair> points = PairUp(extracted_, true_, match.pairs);
      score.rmse_m = RmseM(points, out_.alignment);
      const Similarity scaled = FitSimilarity(points);
      score.rmse_similarity_m = RmseM(points, scaled);
      out_.scale = scaled.scale;
    }
    for (const auto& [k, t] : match.pairs) out_.pairs.emplace_back(k, true_index_[t]);
    out_.landmarks = score;
  }

  void ScoreCalibration() {
    std::vector<std::pair<std::size_t, Point>> matched;
    for (const auto& [k, t] : out_.pairs)
      matched.emplace_back(static_cast<std::size_t>(k), all_true_[static_cast<std::size_t>(t)]);
    std::vector<Track> truth;
    for (const auto& robot : log_.truth.robot) truth.push_back(TrackOf(robot.poses));
    out_.calibration = Calibrate(result_, matched, truth, point_);
    if (point_.estimated && !out_.calibration.reference)
      throw InputError(
          "the true poses do not tell of which point of the robot they are: there are too few of them, or "
          "a robot never turns");
  }

  const Blob& result_blob_;
  const Blob& log_blob_;
  const ReferencePoint point_;
  const kinds::LandmarkMap result_;
  const kinds::Log log_;
  Evaluation out_;
  bool has_landmarks_ = false;
  std::vector<Point> extracted_, all_true_, true_;
  std::vector<std::size_t> true_index_;  // of true_, into all_true_
  std::vector<std::int32_t> identity_;   // of extracted_, into all_true_; kNoTruth
  Associations map_associations_;
  std::optional<Associations> truth_associations_;
  std::vector<std::vector<std::pair<Pose, Pose>>> pose_pairs_;  // of each robot: estimate, truth
  std::vector<TrackAndTruth> tracks_;                           // of each robot
};

// Later observations count as false ones: a result of a prefix is held against what the prefix shows.
Blob TruthUntil(const Blob& log, double until_s) {
  Blob cut = log;
  const auto parts = Read<kinds::Log>(log);
  for (std::size_t r = 0; r < parts.truth.robot.size(); ++r) {
    const Column<std::int32_t>& truth = parts.truth.robot[r].landmark;
    if (!truth) continue;
    const std::span<const double> time_s = parts.robot[r].observations.time_s;
    std::vector<std::int32_t> landmark = truth.vector();
    for (std::size_t i = 0; i < std::min(landmark.size(), time_s.size()); ++i) {
      if (time_s[i] > until_s) landmark[i] = kNoTruth;
    }
    cut.PutVector(truth.name(), landmark);
  }
  return cut;
}

void AddLandmarks(const std::optional<LandmarkScore>& score, const std::optional<OtherFrame>& frame,
                  Scores* scores) {
  if (!score) {
    for (const char* name :
         {"found", "missed", "spurious", "within_3m", "rmse_m", "rmse_similarity_m", "gospa_m"})
      scores->AddForPrograms(std::string("landmarks.") + name, {});
    AddFrame("landmarks", frame, scores);
    scores->AddForPeople("landmarks", "unknown: the truth has none");
    return;
  }
  scores->Add("landmarks.found", score->found, fmt::format(" of {} observed", score->found + score->missed));
  scores->Add("landmarks.missed", score->missed);
  scores->Add("landmarks.spurious", score->spurious);
  scores->Add("landmarks.within_3m", score->within_3m);
  scores->Add("landmarks.rmse_m", OrNone(score->rmse_m));
  scores->Add("landmarks.rmse_similarity_m", OrNone(score->rmse_similarity_m));
  scores->Add("landmarks.gospa_m", score->gospa_m);
  AddFrame("landmarks", frame, scores);
}

void AddTrajectories(const Evaluation& evaluation, Scores* scores) {
  scores->Add("trajectory.rmse_m", OrNone(evaluation.trajectory_rmse_m),
              evaluation.trajectory_rmse_m ? ", the worst robot" : "unknown: " + evaluation.no_trajectory);
  AddClock(evaluation.other_clock, scores);
  AddFrame("trajectory", evaluation.other_frame, scores);
  constexpr std::size_t kMostShown = 20;
  std::vector<Scores> robots;
  for (const RobotScore& robot : evaluation.robots) {
    Scores& row = robots.emplace_back();
    if (robots.size() > kMostShown) row.LeaveToPrograms();
    row.Add("name", robot.name);
    row.Add("rmse_m", OrNone(robot.rmse_m));
    row.Add("heading_rmse_rad", OrNone(robot.heading_rmse_rad));
    row.Add("poses", robot.poses);
  }
  const std::size_t all = robots.size();
  scores->AddRows("trajectory.robots", std::move(robots));
  if (all > kMostShown)
    scores->AddForPeople("trajectory.more_robots", fmt::format("{}; --json has all", all - kMostShown));
}

void AddTopology(const Evaluation& evaluation, Scores* scores) {
  const bool known = evaluation.topology_correct.has_value();
  const auto count = [&](std::int64_t n) { return known ? ScoreValue(n) : ScoreValue(); };
  const auto add = [&](const char* name, std::int64_t n, const char* all_name, std::int64_t all,
                       const char* of) {
    const std::string path = std::string("topology.") + name;
    const ScoreValue share = known ? ShareOf(n, all) : ScoreValue();
    scores->AddForPrograms(std::string("topology.") + all_name, count(all));
    scores->AddForPrograms(path, count(n));
    scores->AddForPrograms(path + "_share", share);
    if (!known) return;
    std::string words = fmt::format("{} of {} {}", n, all, of);
    if (all > 0) words += fmt::format(" ({:.1f}%)", 100 * std::get<Share>(share).value);
    scores->AddForPeople(path, words);
  };
  scores->Add("topology.correct", OrNone(evaluation.topology_correct));
  add("wrong", evaluation.wrong, "associations", evaluation.associations, "associations");
  add("unused", evaluation.unused, "observations", evaluation.observations, "observations of landmarks");
}

}  // namespace

Evaluation Evaluate(const Blob& result, const Blob& truth_log, const ReferencePoint& point) {
  if (!result.Has("until_s")) return Evaluator(result, truth_log, point).Run();
  return Evaluator(result, TruthUntil(truth_log, result.Scalar<double>("until_s")), point).Run();
}

Scores MakeScores(const Evaluation& evaluation) {
  Scores scores;
  AddLandmarks(evaluation.landmarks, evaluation.other_landmark_frame, &scores);
  AddTrajectories(evaluation, &scores);
  AddTopology(evaluation, &scores);
  AddCalibration(evaluation.calibration, &scores);
  scores.Add("iterations", evaluation.iterations);
  scores.Add("seconds", OrNone(evaluation.seconds));
  if (!evaluation.refinement_refused.empty()) scores.Add("refinement", evaluation.refinement_refused);
  scores.Add("alignment.on", evaluation.aligned_on);
  scores.AddForPrograms("alignment.angle_rad", evaluation.alignment.angle_rad);
  scores.AddForPrograms("alignment.x_m", evaluation.alignment.x_m);
  scores.AddForPrograms("alignment.y_m", evaluation.alignment.y_m);
  scores.AddForPrograms("alignment.scale_if_fitted", evaluation.scale);
  return scores;
}

}  // namespace cairn::datasets
