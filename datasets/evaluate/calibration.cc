#include "datasets/evaluate/calibration.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <ranges>
#include <span>

#include "datasets/evaluate/matching/similarity.h"

namespace cairn::datasets {
namespace {

// M. Abramowitz and I. A. Stegun, Handbook of mathematical functions, 26.4.4 and 26.4.5.
double ChiSquareAbove(double x, int degrees) {
  const double half = x / 2;
  const bool is_odd = degrees % 2 == 1;
  double above = is_odd ? std::erfc(std::sqrt(half)) : std::exp(-half);
  for (double a = is_odd ? 0.5 : 1.0; a < degrees / 2.0; a += 1)
    above += std::exp(a * std::log(half) - half - std::lgamma(a + 1));
  return above;
}

// e' C^-1 e by C's Cholesky factor; none where C is singular.
template <std::size_t kSize>
std::optional<double> SquaredInSigmas(const std::array<double, kSize>& error,
                                      std::span<const double> covariance) {
  constexpr double kLeastVariance = 1e-12;  // of a micrometre, a microradian
  double factor[kSize][kSize] = {}, squares = 0;
  std::array<double, kSize> solved{};
  for (std::size_t i = 0; i < kSize; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double rest = covariance[kSize * i + j];
      for (std::size_t k = 0; k < j; ++k) rest -= factor[i][k] * factor[j][k];
      if (i == j && !(rest > kLeastVariance)) return std::nullopt;
      factor[i][j] = i == j ? std::sqrt(rest) : rest / factor[j][j];
    }
    double rest = error[i];
    for (std::size_t k = 0; k < i; ++k) rest -= factor[i][k] * solved[k];
    solved[i] = rest / factor[i][i];
    squares += solved[i] * solved[i];
  }
  return squares;
}

// Adds up errors of so many dimensions.
template <std::size_t kSize>
class ErrorsInSigmas {
 public:
  void Add(const std::array<double, kSize>& error, std::span<const double> covariance) {
    constexpr double kRight = 1e-6;
    const std::optional<double> squares = SquaredInSigmas(error, covariance);
    ++score_.count;
    if (!squares) {
      ++score_.certain;
      certain_and_right_ += std::ranges::all_of(error, [](double e) { return std::abs(e) < kRight; });
      return;
    }
    score_.within_50 += *squares < bound_50_;
    score_.within_95 += *squares < bound_95_;
    sum_ += *squares;
  }

  // `draws`: so many degrees of freedom are independent; 0: none are. `mean`: of the NEES, where covariances
  // are right.
  std::optional<CalibrationScore> Score(const CalibrationFrame& frame, std::int64_t draws,
                                        std::string interval_takes, double mean = 1) const {
    if (score_.count == 0) return std::nullopt;
    CalibrationScore score = score_;
    score.frame = frame;
    score.interval_takes = std::move(interval_takes);
    if (frame.is_own) {
      score.within_50 += certain_and_right_;
      score.within_95 += certain_and_right_;
    }
    if (score.count == score.certain) return score;
    score.nees_per_dof = sum_ / static_cast<double>(kSize) / static_cast<double>(score.count - score.certain);
    if (draws < 1) return score;
    const auto quantile = [&](double p) {
      return mean * ChiSquareQuantile(p, static_cast<int>(draws)) / static_cast<double>(draws);
    };
    score.nees_99 = Interval{quantile(0.005), quantile(0.995)};
    return score;
  }

 private:
  double bound_50_ = ChiSquareQuantile(0.5, kSize), bound_95_ = ChiSquareQuantile(0.95, kSize);
  CalibrationScore score_;
  std::int64_t certain_and_right_ = 0;
  double sum_ = 0;
};

class Calibrator {
 public:
  Calibrator(const kinds::LandmarkMap& map, const std::vector<std::pair<std::size_t, Point>>& matched,
             const std::vector<Track>& truth, const ReferencePoint& point)
      : map_(map), matched_(matched), truth_(truth), points_(map.robot.size(), point.at) {
    if (!point.estimated) return;
    std::vector<PosesAndPositions> robots(map.robot.size());
    ForEachPose([&](std::size_t r, const Pose& ours, const Pose& theirs, std::span<const double>) {
      robots[r].push_back({ours, {theirs.x_m, theirs.y_m}});
    });
    reference_ = FitReference(robots);
    if (reference_) points_ = reference_->point;
  }

  const std::optional<Reference>& reference() const { return reference_; }

  std::optional<CalibrationScore> Landmarks() const {
    const std::span<const double> covariance = map_.map.landmark_covariance_m2.OrNone();
    const std::optional<Frame> frame = FrameOfLandmarks();
    if (covariance.empty() || !frame) return std::nullopt;
    const Similarity back = Inverse(frame->to_truth);
    ErrorsInSigmas<2> errors;
    for (const auto& [k, truth] : matched_) {
      const Point ours = Landmark(k), theirs = back(truth);
      errors.Add({ours.x_m - theirs.x_m, ours.y_m - theirs.y_m}, covariance.subspan(4 * k, 4));
    }
    if (const auto together = ErrTogether())
      return errors.Score(*frame, std::max<std::int64_t>(1, std::llround(std::floor(together->draws))),
                          "landmarks err together as the result says", together->mean);
    const std::int64_t all = 2 * static_cast<std::int64_t>(matched_.size());
    if (frame->on == "first pose")
      return errors.Score(*frame, 2,
                          "all landmarks are one draw, as an error of the first heading turns them together");
    if (frame->on == "landmarks")
      return errors.Score(*frame, all - frame->dof,
                          "landmarks err independently, but for the 3 degrees of freedom of the alignment");
    return errors.Score(*frame, all, "landmarks err independently");
  }

  // The first so many of x, y and heading.
  template <std::size_t kSize>
  std::optional<CalibrationScore> Poses() const {
    const std::optional<Frame> frame = FrameOfPoses();
    if (!frame) return std::nullopt;
    const Similarity back = Inverse(frame->to_truth);
    ErrorsInSigmas<kSize> errors;
    const std::int64_t robots =
        ForEachPose([&](std::size_t r, const Pose& at, const Pose& truth, std::span<const double> stated) {
          const Pose ours = Compose(at, {points_[r].x_m, points_[r].y_m, 0}), theirs = back(truth);
          const std::array<double, 3> error = {ours.x_m - theirs.x_m, ours.y_m - theirs.y_m,
                                               WrapAngle(ours.heading_rad - theirs.heading_rad)};
          // How the point moves with the heading.
          const double by[] = {at.y_m - ours.y_m, ours.x_m - at.x_m, 0};
          std::array<double, kSize> of;
          std::array<double, kSize * kSize> covariance;
          for (std::size_t i = 0; i < kSize; ++i) {
            of[i] = error[i];
            for (std::size_t j = 0; j < kSize; ++j)
              covariance[kSize * i + j] = stated[3 * i + j] + by[i] * stated[6 + j] +
                                          stated[3 * i + 2] * by[j] + by[i] * stated[8] * by[j];
          }
          errors.Add(of, covariance);
        });
    const auto dof = static_cast<std::int64_t>(kSize) * robots;
    if (!frame->is_own)
      return errors.Score(
          *frame, dof - frame->dof,
          "each robot's path is one draw, as its poses err together, and the alignment takes one");
    return errors.Score(*frame, dof, "each robot's path is one draw, as its poses err together");
  }

 private:
  struct Frame : CalibrationFrame {
    Similarity to_truth;
  };

  // Squares of the errors in units of each landmark's own covariance, added up, go about as a multiple of a
  // chi-square of so many degrees of freedom (F. E. Satterthwaite, An approximate distribution of estimates
  // of variance components, 1946).
  struct Together {
    double mean = 1, draws = 0;
  };
  // By the result's joint covariance, of the matched landmarks laid over the true ones. None where it has
  // none, or where one of them is certain.
  std::optional<Together> ErrTogether() const {
    const auto all = static_cast<Eigen::Index>(2 * map_.map.landmark_x_m.size());
    const std::span<const double> joint = map_.map.landmark_joint_covariance_m2.OrNone();
    if (joint.empty() || matched_.size() < 3) return std::nullopt;
    const Eigen::Map<const Eigen::MatrixXd> stated(joint.data(), all, all);
    const auto size = 2 * static_cast<Eigen::Index>(matched_.size());
    std::vector<Eigen::Index> axes;
    Eigen::MatrixXd motion(size, 3);  // what a small rigid motion does to each
    Eigen::MatrixXd to_sigmas = Eigen::MatrixXd::Zero(size, size);
    for (const std::size_t k : std::views::keys(matched_)) {
      const auto at = static_cast<Eigen::Index>(axes.size()), axis = static_cast<Eigen::Index>(2 * k);
      axes.insert(axes.end(), {axis, axis + 1});
      const Point place = Landmark(k);
      motion.middleRows<2>(at) << 1, 0, -place.y_m, 0, 1, place.x_m;
      const Eigen::LLT<Eigen::Matrix2d> own(stated.block<2, 2>(axis, axis));
      if (own.info() != Eigen::Success) return std::nullopt;
      to_sigmas.block<2, 2>(at, at) = own.matrixL().solve(Eigen::Matrix2d::Identity());
    }
    const Eigen::LLT<Eigen::Matrix3d> squares(motion.transpose() * motion);
    if (squares.info() != Eigen::Success) return std::nullopt;
    const Eigen::MatrixXd laid =
        Eigen::MatrixXd::Identity(size, size) - motion * squares.solve(motion.transpose());
    const Eigen::MatrixXd by = to_sigmas * laid, sigmas = by * stated(axes, axes) * by.transpose();
    const double trace = sigmas.trace();
    return Together{trace / static_cast<double>(size), trace * trace / sigmas.squaredNorm()};
  }

  Point Landmark(std::size_t k) const { return {map_.map.landmark_x_m[k], map_.map.landmark_y_m[k]}; }

  std::optional<Frame> FrameOfLandmarks() const {
    const std::optional<std::size_t> first = RobotCertainOfItsFirstPose();
    const bool from_first = first && map_.refinement_done.Or(0) != 0;
    std::optional<Frame> frame = from_first ? FromFirstPose(*first) : OnLandmarks();
    if (frame) return frame;
    frame = from_first ? OnLandmarks() : std::nullopt;
    if (!frame) frame = OnPoses();
    if (frame) frame->is_own = false;
    return frame;
  }

  std::optional<std::size_t> RobotCertainOfItsFirstPose() const {
    for (std::size_t r = 0; r < map_.robot.size(); ++r) {
      const std::span<const double> covariance = map_.robot[r].poses.covariance.OrNone();
      if (!covariance.empty() && std::ranges::all_of(covariance.first(9), [](double c) { return c == 0; }))
        return r;
    }
    return std::nullopt;
  }

  std::optional<Frame> FromFirstPose(std::size_t robot) const {
    const kinds::PoseTable& poses = map_.robot[robot].poses;
    const auto truth = robot < truth_.size() ? PoseAt(truth_[robot], poses.time_s[0]) : std::nullopt;
    if (!truth) return std::nullopt;
    Frame frame{{"first pose", 1, 0, true}, {.angle_rad = truth->heading_rad - poses[0].heading_rad}};
    const Pose turned = frame.to_truth(poses[0]);
    frame.to_truth.x_m = truth->x_m - turned.x_m;
    frame.to_truth.y_m = truth->y_m - turned.y_m;
    return frame;
  }

  std::optional<Frame> FrameOfPoses() const {
    if (reference_) {
      Frame frame{{"reference", 0, 4, false}, Inverse(reference_->to_map)};
      frame.dof += 2 * ForEachPose([&](std::size_t, const Pose&, const Pose&, std::span<const double>) {
                     ++frame.points;
                   });
      return frame;
    }
    const std::optional<Frame> frame = OnLandmarks();
    return frame ? frame : OnPoses();
  }

  // Two landmarks leave one degree of freedom, their distance.
  std::optional<Frame> OnLandmarks() const {
    if (matched_.size() < 3) return std::nullopt;
    std::vector<PointPair> points;
    for (const auto& [k, truth] : matched_) points.push_back({Landmark(k), truth});
    return Frame{{"landmarks", static_cast<std::int64_t>(points.size()), 3, true}, FitRigid(points)};
  }

  std::optional<Frame> OnPoses() const {
    std::vector<PointPair> points;
    ForEachPose([&](std::size_t r, const Pose& at, const Pose& theirs, std::span<const double>) {
      const Pose ours = Compose(at, {points_[r].x_m, points_[r].y_m, 0});
      points.push_back({{ours.x_m, ours.y_m}, {theirs.x_m, theirs.y_m}});
    });
    if (points.size() < 2) return std::nullopt;
    return Frame{{"poses", static_cast<std::int64_t>(points.size()), 3, false}, FitRigid(points)};
  }

  // Where covariance and truth are known. Returns of how many robots.
  template <class Take>
  std::int64_t ForEachPose(const Take& take) const {
    std::int64_t robots = 0;
    for (std::size_t r = 0; r < std::min(map_.robot.size(), truth_.size()); ++r) {
      const kinds::LandmarkMap::RobotPoses& poses = map_.robot[r].poses;
      const std::span<const double> covariance = poses.covariance.OrNone();
      bool any = false;
      for (std::size_t i = 0; 9 * i < covariance.size(); ++i) {
        const auto truth = PoseAt(truth_[r], poses.time_s[i]);
        if (truth) take(r, poses[i], *truth, covariance.subspan(9 * i, 9));
        any = any || truth;
      }
      robots += any;
    }
    return robots;
  }

  const kinds::LandmarkMap& map_;
  const std::vector<std::pair<std::size_t, Point>>& matched_;
  const std::vector<Track>& truth_;
  std::vector<Point> points_;  // of each robot, of which its true poses are
  std::optional<Reference> reference_;
};

const char* MotionOf(const CalibrationFrame& frame) {
  return frame.on == "reference" ? "similarity" : "rigid motion";
}

std::string FrameText(const CalibrationFrame& frame) {
  std::string text = frame.on == "first pose"
                         ? " of a robot, laid on the true one there"
                         : fmt::format(": a {} found from {} of them, which takes {} degrees of freedom",
                                       MotionOf(frame), frame.points, frame.dof);
  if (!frame.is_own && frame.on != "reference")
    text += "; the covariances are stated in another frame, which truth does not tell";
  return text;
}

void AddErrorsInSigmas(const std::string& name, const std::optional<CalibrationScore>& score,
                       Scores* scores) {
  if (!score) {
    scores->AddForPrograms(name, {});
    return;
  }
  Scores group;
  group.Add("count", score->count,
            score->certain > 0 ? fmt::format(", {} of them with a singular covariance", score->certain) : "");
  group.AddForPrograms("certain", score->certain);
  const std::int64_t judged = score->frame.is_own ? score->count : score->count - score->certain;
  group.Add("within_50", ShareOf(score->within_50, judged), ", where 50% are expected");
  group.Add("within_95", ShareOf(score->within_95, judged), ", where 95% are expected");
  std::string words = score->nees_per_dof ? " per degree of freedom" : "";
  if (score->nees_99 && score->nees_per_dof) {
    if (*score->nees_per_dof > score->nees_99->high) words += ": the covariances are too small";
    if (*score->nees_per_dof < score->nees_99->low) words += ": the covariances are too large";
  }
  group.Add("nees", OrNone(score->nees_per_dof), words);
  if (score->nees_99)
    group.Add("nees_99", *score->nees_99, ", if " + score->interval_takes);
  else
    group.Add("nees_99", {}, "none: " + score->interval_takes);
  group.AddForPrograms("interval_takes", score->interval_takes);
  group.Add("frame.on", score->frame.on, FrameText(score->frame));
  group.AddForPrograms("frame.motion", score->frame.on == "reference" ? "similarity" : "rigid");
  group.AddForPrograms("frame.points", score->frame.points);
  group.AddForPrograms("frame.dof", score->frame.dof);
  group.AddForPrograms("frame.is_own", score->frame.is_own);
  scores->AddGroup(name, group);
}

}  // namespace

double ChiSquareQuantile(double p, int degrees) {
  double low = 0, high = degrees + 20 * std::sqrt(2.0 * degrees) + 100;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (ChiSquareAbove(middle, degrees) > 1 - p ? low : high) = middle;
  }
  return (low + high) / 2;
}

Calibration Calibrate(const kinds::LandmarkMap& map,
                      const std::vector<std::pair<std::size_t, Point>>& matched,
                      const std::vector<Track>& truth, const ReferencePoint& point) {
  const Calibrator calibrator(map, matched, truth, point);
  return {calibrator.Landmarks(), calibrator.Poses<3>(), calibrator.Poses<2>(), calibrator.reference()};
}

void AddCalibration(const Calibration& calibration, Scores* scores) {
  AddErrorsInSigmas("calibration.landmarks", calibration.landmarks, scores);
  AddErrorsInSigmas("calibration.poses", calibration.poses, scores);
  AddErrorsInSigmas("calibration.positions", calibration.positions, scores);
  if (!calibration.reference) return;
  scores->Add("calibration.reference.scale", 1 / calibration.reference->to_map.scale,
              ": by which the true positions are divided");
  scores->Add("calibration.reference.rmse_m", calibration.reference->rmse_m);
  std::vector<Scores> points;
  for (const Point& point : calibration.reference->point) {
    points.emplace_back().Add("ahead_m", point.x_m);
    points.back().Add("left_m", point.y_m);
  }
  scores->AddRows("calibration.reference.points", std::move(points));
}

}  // namespace cairn::datasets
