#include "datasets/evaluate/calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <nlohmann/json.hpp>

#include "datasets/evaluate/matching/similarity.h"
#include "datasets/testing.h"
#include "schema/rng.h"

namespace cairn::datasets {
namespace {

TEST(ChiSquareQuantile, IsTheTables) {
  EXPECT_NEAR(ChiSquareQuantile(0.95, 1), 3.84146, 1e-4);
  EXPECT_NEAR(ChiSquareQuantile(0.5, 2), 2 * std::log(2.0), 1e-9);
  EXPECT_NEAR(ChiSquareQuantile(0.95, 2), 5.99146, 1e-4);
  EXPECT_NEAR(ChiSquareQuantile(0.005, 3), 0.0717218, 1e-6);
  EXPECT_NEAR(ChiSquareQuantile(0.995, 3), 12.8382, 1e-3);
  EXPECT_NEAR(ChiSquareQuantile(0.995, 100), 140.169, 1e-2);
  EXPECT_NEAR(ChiSquareQuantile(0.005, 100), 67.3276, 1e-2);
  EXPECT_NEAR(ChiSquareQuantile(0.5, 5000), 5000 * std::pow(1 - 2.0 / 45000, 3), 1e-2);
}

// A map with landmarks and poses that err as told.
struct MadeUp {
  std::vector<Point> landmarks;
  std::vector<double> landmark_covariance_m2, landmark_joint_covariance_m2;
  std::vector<std::pair<std::size_t, Point>> matched;
  struct Path {
    Track track;
    std::vector<double> covariance;
  };
  std::vector<Path> paths;
  std::vector<Track> truth;

  kinds::LandmarkMap Map() const {
    kinds::LandmarkMap map;
    map.map.landmark_x_m = ColumnOf(landmarks, &Point::x_m);
    map.map.landmark_y_m = ColumnOf(landmarks, &Point::y_m);
    if (!landmark_covariance_m2.empty()) map.map.landmark_covariance_m2 = landmark_covariance_m2;
    if (!landmark_joint_covariance_m2.empty())
      map.map.landmark_joint_covariance_m2 = landmark_joint_covariance_m2;
    map.refinement_done = std::uint8_t{1};
    for (const Path& path : paths) {
      auto& robot = map.robot.emplace_back();
      robot.poses.Set(path.track.time_s, path.track.poses);
      robot.poses.covariance = path.covariance;
    }
    return map;
  }
  Calibration Calibrated(const ReferencePoint& point = {}) const {
    return Calibrate(Map(), matched, truth, point);
  }
};

std::vector<double> RowMajor(const Eigen::MatrixXd& matrix) {
  std::vector<double> values;
  for (const auto& row : matrix.rowwise()) values.insert(values.end(), row.begin(), row.end());
  return values;
}

Eigen::VectorXd Normals(Eigen::Index count, Rng& rng) {
  return Eigen::VectorXd::NullaryExpr(count, [&](Eigen::Index) { return rng.Normal(); });
}

// A factor of a covariance, of about this standard deviation.
Eigen::MatrixXd SomeFactor(Eigen::Index size, double sigma, Rng& rng) {
  Eigen::MatrixXd factor = Eigen::MatrixXd::Identity(size, size) * sigma;
  for (Eigen::Index k = 0; k < size * size; ++k) factor(k / size, k % size) += 0.4 * sigma * rng.Normal();
  return factor;
}

// Landmarks about 30 m apart, their errors drawn each from a covariance of its own; what is stated are the
// covariances in the frame in which they together neither shift nor turn.
MadeUp MadeUpLandmarks(int count, double times, Rng& rng) {
  MadeUp made;
  Eigen::MatrixXd motion(2 * count, 3), factor = Eigen::MatrixXd::Zero(2 * count, 2 * count);
  for (int l = 0; l < count; ++l) {
    const Point truth{30 * rng.Normal(), 30 * rng.Normal()};
    made.matched.emplace_back(l, truth);
    motion.middleRows<2>(2 * l) << 1, 0, -truth.y_m, 0, 1, truth.x_m;
    factor.block<2, 2>(2 * l, 2 * l) = SomeFactor(2, 0.1, rng);
  }
  const Eigen::MatrixXd freed = Eigen::MatrixXd::Identity(2 * count, 2 * count) -
                                motion * (motion.transpose() * motion).inverse() * motion.transpose();
  const Eigen::MatrixXd covariance = freed * factor * factor.transpose() * freed.transpose();
  const Eigen::VectorXd errors = times * factor * Normals(2 * count, rng);
  const Similarity elsewhere{1, 2.5, -70, 12};
  Eigen::Matrix2d turn;
  turn << std::cos(2.5), -std::sin(2.5), std::sin(2.5), std::cos(2.5);
  for (int l = 0; l < count; ++l) {
    const Point truth = made.matched[static_cast<std::size_t>(l)].second;
    made.landmarks.push_back(elsewhere(Point{truth.x_m + errors[2 * l], truth.y_m + errors[2 * l + 1]}));
    for (const double value : RowMajor(turn * covariance.block<2, 2>(2 * l, 2 * l) * turn.transpose()))
      made.landmark_covariance_m2.push_back(value);
  }
  return made;
}

// Paths whose poses err each for itself, as their covariances say, but for the very first one, among
// landmarks that are where they are said to be; the truth lies in another frame.
MadeUp MadeUpPaths(int robots, int poses, double times, Rng& rng) {
  MadeUp made;
  const Similarity elsewhere{1, -1.2, 400, 3};
  for (const Point landmark : {Point{0, 0}, Point{9, 1}, Point{-3, 7}}) {
    made.matched.emplace_back(made.landmarks.size(), elsewhere(landmark));
    made.landmarks.push_back(landmark);
  }
  for (int r = 0; r < robots; ++r) {
    auto& [track, covariance] = made.paths.emplace_back();
    Track truth;
    for (int i = 0; i < poses; ++i) {
      const Pose at{20 * rng.Normal(), 20 * rng.Normal(), rng.Normal()};
      const bool is_certain = r + i == 0;
      const Eigen::MatrixXd factor = is_certain ? Eigen::MatrixXd::Zero(3, 3) : SomeFactor(3, 0.05, rng);
      const Eigen::Vector3d error = times * factor * Normals(3, rng);
      track.time_s.push_back(i);
      track.poses.push_back({at.x_m + error[0], at.y_m + error[1], at.heading_rad + error[2]});
      for (const double value : RowMajor(factor * factor.transpose())) covariance.push_back(value);
      truth.time_s.push_back(i);
      truth.poses.push_back(elsewhere(at));
    }
    made.truth.push_back(truth);
  }
  return made;
}

bool Contains(const std::optional<Interval>& interval, double value) {
  return interval && interval->low <= value && value <= interval->high;
}

struct Tally {
  double count = 0, within_50 = 0, within_95 = 0, worlds = 0, contained = 0, nees = 0;
  void Add(const CalibrationScore& score) {
    count += static_cast<double>(score.count);
    within_50 += static_cast<double>(score.within_50);
    within_95 += static_cast<double>(score.within_95);
    nees += score.nees_per_dof.value();
    contained += Contains(score.nees_99, score.nees_per_dof.value());
    ++worlds;
  }
};

TEST(Calibration, LandmarksThatErrAsStatedAreCoveredAsStated) {
  for (const int landmarks : {4, 20}) {
    Tally right, doubled;
    Rng rng(11);
    for (int world = 0; world < 400; ++world) {
      right.Add(*MadeUpLandmarks(landmarks, 1, rng).Calibrated().landmarks);
      doubled.Add(*MadeUpLandmarks(landmarks, 2, rng).Calibrated().landmarks);
    }
    EXPECT_NEAR(right.within_50 / right.count, 0.5, 0.03) << landmarks;
    EXPECT_NEAR(right.within_95 / right.count, 0.95, 0.015) << landmarks;
    EXPECT_NEAR(right.nees / right.worlds, 1, 0.05) << landmarks;
    EXPECT_GT(right.contained / right.worlds, 0.97) << landmarks;
    EXPECT_NEAR(doubled.nees / doubled.worlds, 4, 0.2) << landmarks;
    EXPECT_NEAR(doubled.within_95 / doubled.count, 0.53, 0.03) << landmarks;  // 1 - 0.05^(1/4)
    EXPECT_LT(doubled.contained / doubled.worlds, landmarks == 20 ? 0.01 : 0.9);
  }
}

// A map that is too large or too small by what is not known, and that is all but all that is wrong with it:
// one draw, however many its landmarks. Every other world errs by twice as much as stated.
TEST(Calibration, LandmarksThatErrTogetherAreAsManyDrawsAsTheJointCovarianceSays) {
  constexpr int kLandmarks = 15;
  constexpr double kScaleSigma = 0.02, kOwnSigma = 0.02;
  Tally right, doubled;
  double alone = 0;
  Rng rng(19);
  for (int world = 0; world < 1600; ++world) {
    const double times = world % 2 == 0 ? 1 : 2;
    MadeUp made;
    Eigen::VectorXd lever(2 * kLandmarks);
    const double scale = times * kScaleSigma * rng.Normal();
    const Similarity elsewhere{1, 0.7, 30, -20};
    for (std::size_t l = 0; l < kLandmarks; ++l) {
      const Point at{20 * rng.Normal(), 20 * rng.Normal()};
      made.matched.emplace_back(l, elsewhere(at));
      made.landmarks.push_back({at.x_m * (1 + scale) + times * kOwnSigma * rng.Normal(),
                                at.y_m * (1 + scale) + times * kOwnSigma * rng.Normal()});
      lever.segment<2>(2 * static_cast<Eigen::Index>(l)) << at.x_m, at.y_m;
    }
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();  // in their own frame it does not move
    for (Eigen::Index l = 0; l < kLandmarks; ++l) middle += lever.segment<2>(2 * l) / kLandmarks;
    for (Eigen::Index l = 0; l < kLandmarks; ++l) lever.segment<2>(2 * l) -= middle;
    const Eigen::MatrixXd joint =
        kScaleSigma * kScaleSigma * lever * lever.transpose() +
        kOwnSigma * kOwnSigma * Eigen::MatrixXd::Identity(2 * kLandmarks, 2 * kLandmarks);
    for (Eigen::Index l = 0; l < kLandmarks; ++l)
      for (const double value : RowMajor(joint.block<2, 2>(2 * l, 2 * l)))
        made.landmark_covariance_m2.push_back(value);
    alone += !Contains(made.Calibrated().landmarks->nees_99, *made.Calibrated().landmarks->nees_per_dof) &&
             times == 1;
    made.landmark_joint_covariance_m2 = RowMajor(joint);
    (times == 1 ? right : doubled).Add(made.Calibrated().landmarks.value());
  }
  EXPECT_NEAR(right.nees / right.worlds, 1, 0.1);
  EXPECT_GT(right.contained / right.worlds, 0.98);
  EXPECT_LT(right.contained / right.worlds, 0.999);
  EXPECT_GT(alone / right.worlds, 0.1) << "as if each landmark erred by itself";
  EXPECT_LT(doubled.contained / doubled.worlds, right.contained / right.worlds - 0.05);
}

TEST(Calibration, PosesThatErrAsStatedAreCoveredAsStated) {
  Rng rng(12);
  const Calibration right = MadeUpPaths(8, 400, 1, rng).Calibrated();
  EXPECT_FALSE(right.landmarks);
  ASSERT_TRUE(right.poses);
  EXPECT_EQ(right.poses->frame.on, "landmarks");
  EXPECT_TRUE(right.poses->frame.is_own);
  EXPECT_EQ(right.poses->count, 3200);
  EXPECT_EQ(right.poses->certain, 1);
  EXPECT_NEAR(static_cast<double>(right.poses->within_50) / 3200, 0.5, 0.03);
  EXPECT_NEAR(static_cast<double>(right.poses->within_95) / 3200, 0.95, 0.015);
  EXPECT_NEAR(*right.poses->nees_per_dof, 1, 0.05);
  EXPECT_TRUE(Contains(right.poses->nees_99, *right.poses->nees_per_dof));

  const Calibration doubled = MadeUpPaths(8, 400, 2, rng).Calibrated();
  EXPECT_NEAR(*doubled.poses->nees_per_dof, 4, 0.2);
  EXPECT_FALSE(Contains(doubled.poses->nees_99, *doubled.poses->nees_per_dof));
  EXPECT_LT(static_cast<double>(doubled.poses->within_95) / 3200, 0.7);
}

double ShareWithin95(const CalibrationScore& score) {
  return static_cast<double>(score.within_95) / static_cast<double>(score.count);
}

TEST(Calibration, PositionsAreHeldAgainstTheTruthWithoutItsHeadings) {
  Rng rng(17);
  MadeUp made = MadeUpPaths(2, 400, 1, rng);
  EXPECT_NEAR(ShareWithin95(*made.Calibrated().positions), 0.95, 0.02);
  for (Pose& truth : made.truth[1].poses) truth.heading_rad += 0.3;
  const Calibration turned = made.Calibrated();
  EXPECT_LT(ShareWithin95(*turned.poses), 0.6);
  EXPECT_NEAR(ShareWithin95(*turned.positions), 0.95, 0.02);
  EXPECT_NEAR(*turned.positions->nees_per_dof, 1, 0.15);
  EXPECT_EQ(turned.positions->count, 800);
}

// The truth is of another point of each robot, stated or not, and in a frame of a scale of its own.
TEST(Calibration, TruePosesMayBeOfAnotherPoint) {
  Rng rng(18);
  MadeUp made = MadeUpPaths(2, 400, 1, rng);
  for (Track& track : made.truth)
    for (Pose& pose : track.poses) pose = Compose(pose, {0.5, -0.2, 0});
  EXPECT_LT(ShareWithin95(*made.Calibrated().positions), 0.1);
  const Calibration stated = made.Calibrated({false, {0.5, -0.2}});
  EXPECT_FALSE(stated.reference);
  EXPECT_NEAR(ShareWithin95(*stated.poses), 0.95, 0.02);
  EXPECT_NEAR(ShareWithin95(*stated.positions), 0.95, 0.02);
  EXPECT_TRUE(stated.positions->frame.is_own);

  const Similarity larger{1.1, 0.3, -2, 5};
  for (Track& track : made.truth)
    for (Pose& pose : track.poses) pose = larger(pose);
  EXPECT_LT(ShareWithin95(*made.Calibrated({false, {0.5, -0.2}}).positions), 0.1);
  const Calibration found = made.Calibrated({true, {}});
  ASSERT_TRUE(found.reference);
  EXPECT_NEAR(found.reference->to_map.scale, 1 / 1.1, 1e-3);
  for (const Point& point : found.reference->point) {
    EXPECT_NEAR(point.x_m, 0.5, 0.02);
    EXPECT_NEAR(point.y_m, -0.2, 0.02);
  }
  EXPECT_NEAR(ShareWithin95(*found.positions), 0.95, 0.02);
  EXPECT_EQ(found.positions->frame.on, "reference");
  EXPECT_EQ(found.positions->frame.points, 800);
  EXPECT_EQ(found.positions->frame.dof, 8);
  EXPECT_FALSE(found.positions->nees_99);  // two paths are four draws, and all of them are taken
}

// Poses of one path err together: of one robot the interval is that of one draw of three degrees of freedom,
// however many poses there are.
TEST(Calibration, APathIsOneDraw) {
  Rng rng(13);
  for (const int poses : {10, 500}) {
    const auto score = MadeUpPaths(1, poses, 1, rng).Calibrated().poses;
    EXPECT_NEAR(score->nees_99->low, 0.0717218 / 3, 1e-6);
    EXPECT_NEAR(score->nees_99->high, 12.8382 / 3, 1e-4);
  }
}

TEST(Calibration, ByHand) {
  MadeUp made;
  made.paths.push_back({{{0, 1, 2}, {{0, 0, 0}, {7, 1, 0.5}, {9, 0, 0}}}, std::vector<double>(27, 0.0)});
  for (const auto& [at, value] : {std::pair{9, 4.0}, {13, 1.0}, {17, 0.25}})
    made.paths[0].covariance[at] = value;
  made.truth.push_back({{0, 1, 2}, {{0, 0, 0}, {5, 0, 0}, {9, 0.5, 0}}});
  for (const Point landmark : {Point{0, 0}, Point{9, 1}, Point{-3, 7}}) {
    made.matched.emplace_back(made.landmarks.size(), landmark);
    made.landmarks.push_back(landmark);
  }
  const CalibrationScore score = made.Calibrated().poses.value();
  EXPECT_EQ(score.count, 3);
  EXPECT_EQ(score.certain, 2);  // the second of them is wrong
  EXPECT_EQ(score.within_50, 1);
  EXPECT_EQ(score.within_95, 2);
  EXPECT_NEAR(*score.nees_per_dof, 1, 1e-12);  // 2, 1 and 0.5 are a sigma each
}

// Contact detections' landmarks are reckoned from the first pose: what its heading is off by turns them all.
TEST(Calibration, LandmarksThatCountFromTheFirstPose) {
  constexpr double kTurnSigma = 0.02, kOwnSigma = 0.1;
  Tally right, doubled;
  Rng rng(16);
  for (int world = 0; world < 800; ++world) {
    const double times = world % 2 == 0 ? 1 : 2, turn = times * kTurnSigma * rng.Normal();
    MadeUp made;
    made.paths.push_back({{{0}, {{0, 0, 0}}}, std::vector<double>(9, 0.0)});
    made.truth.push_back({{0}, {{3, 4, 1}}});
    const Similarity elsewhere{1, 1, 3, 4};
    for (std::size_t l = 0; l < 15; ++l) {
      const Point at{20 * rng.Normal(), 20 * rng.Normal()};
      made.matched.emplace_back(l, elsewhere(at));
      made.landmarks.push_back({at.x_m - turn * at.y_m + times * kOwnSigma * rng.Normal(),
                                at.y_m + turn * at.x_m + times * kOwnSigma * rng.Normal()});
      const Eigen::Vector2d lever(-at.y_m, at.x_m);
      const Eigen::Matrix2d covariance = kTurnSigma * kTurnSigma * lever * lever.transpose() +
                                         kOwnSigma * kOwnSigma * Eigen::Matrix2d::Identity();
      for (const double value : RowMajor(covariance)) made.landmark_covariance_m2.push_back(value);
    }
    const CalibrationScore score = made.Calibrated().landmarks.value();
    EXPECT_EQ(score.frame.on, "first pose");
    EXPECT_EQ(score.frame.dof, 0);
    EXPECT_TRUE(score.frame.is_own);
    (times == 1 ? right : doubled).Add(score);
  }
  EXPECT_NEAR(right.within_50 / right.count, 0.5, 0.03);
  EXPECT_NEAR(right.within_95 / right.count, 0.95, 0.015);
  EXPECT_NEAR(right.nees / right.worlds, 1, 0.1);
  EXPECT_GT(right.contained / right.worlds, 0.985);
  EXPECT_NEAR(doubled.within_95 / doubled.count, 0.53, 0.03);
}

// Two landmarks err along the line between them alone, in the frame in which they neither shift nor turn. In
// that of poses, which truth tells, this says nothing of where they are.
TEST(Calibration, ASingularCovarianceOfAnotherFrameIsUnknown) {
  Rng rng(17);
  MadeUp made = MadeUpPaths(1, 40, 1, rng);
  made.landmarks.clear();
  made.matched.clear();
  for (const Point at : {Point{0, 0}, Point{4, 0}}) {
    made.matched.emplace_back(made.landmarks.size(), Point{at.x_m + 0.01, at.y_m});
    made.landmarks.push_back(at);
    for (const double value : {0.0025, 0.0, 0.0, 0.0}) made.landmark_covariance_m2.push_back(value);
  }
  made.truth[0].time_s[0] = 0.25;   // the first pose is not known,
  made.paths[0].covariance[0] = 1;  // and nothing counts from it
  const Calibration calibration = made.Calibrated();
  ASSERT_FALSE(calibration.landmarks->frame.is_own);
  EXPECT_EQ(calibration.landmarks->certain, 2);
  Scores scores;
  AddCalibration(calibration, &scores);
  const std::string json = scores.ToJson(-1);
  EXPECT_NE(json.find(R"("landmarks":{"count":2,"certain":2,"within_50":null,"within_95":null,"nees":null)"),
            std::string::npos)
      << json;
}

TEST(Calibration, SaysInWhichFrameItMeasures) {
  Rng rng(14);
  MadeUp made = MadeUpPaths(1, 40, 1, rng);
  const MadeUp landmarks = MadeUpLandmarks(5, 1, rng);
  made.landmarks = landmarks.landmarks;
  made.landmark_covariance_m2 = landmarks.landmark_covariance_m2;
  made.matched = landmarks.matched;
  EXPECT_EQ(made.Calibrated().landmarks->frame.on, "first pose");
  made.truth[0].time_s[0] = 0.25;  // the first pose is not known
  Calibration calibration = made.Calibrated();
  EXPECT_EQ(calibration.landmarks->frame.on, "landmarks");
  EXPECT_EQ(calibration.landmarks->frame.points, 5);
  EXPECT_EQ(calibration.landmarks->frame.dof, 3);
  EXPECT_FALSE(calibration.landmarks->frame.is_own);
  EXPECT_EQ(calibration.poses->frame.on, "landmarks");
  EXPECT_TRUE(calibration.poses->frame.is_own);
  made.paths[0].covariance[0] = 1;  // nothing counts from the first pose
  EXPECT_TRUE(made.Calibrated().landmarks->frame.is_own);
  made.matched.resize(2);
  calibration = made.Calibrated();
  EXPECT_EQ(calibration.landmarks->frame.on, "poses");
  EXPECT_FALSE(calibration.landmarks->frame.is_own);
  EXPECT_EQ(calibration.poses->frame.on, "poses");
  EXPECT_FALSE(calibration.poses->frame.is_own);
  EXPECT_FALSE(calibration.poses->nees_99);  // the alignment takes the only draw
  made.truth.clear();
  EXPECT_FALSE(made.Calibrated().landmarks);
  EXPECT_FALSE(made.Calibrated().poses);
}

TEST(Calibration, IsScoresForPeopleAndForPrograms) {
  Rng rng(15);
  Scores scores;
  AddCalibration(MadeUpLandmarks(20, 4, rng).Calibrated(), &scores);
  const auto json = nlohmann::json::parse(scores.ToJson()).at("calibration");
  EXPECT_EQ(json.at("landmarks").at("count"), 20);
  EXPECT_LT(json.at("landmarks").at("within_95"), 0.7);
  EXPECT_GT(json.at("landmarks").at("nees"), 4);
  EXPECT_NEAR(json.at("landmarks").at("nees_99").at(1).get<double>(), ChiSquareQuantile(0.995, 37) / 37,
              1e-9);
  EXPECT_TRUE(json.at("poses").is_null());
  EXPECT_TRUE(json.at("positions").is_null());
  EXPECT_FALSE(json.contains("reference"));
  EXPECT_EQ(json.at("landmarks").at("frame").at("on"), "landmarks");
  EXPECT_EQ(json.at("landmarks").at("frame").at("dof"), 3);
  ExpectContains(scores.ToText(), "the covariances are too small");
  ExpectContains(scores.ToText(), "where 95% are expected");
  ExpectContains(scores.ToText(),
                 "landmarks: a rigid motion found from 20 of them, which takes 3 degrees of freedom");

  Scores of_reference;
  AddCalibration(MadeUpPaths(1, 40, 1, rng).Calibrated({true, {}}), &of_reference);
  const auto reference = nlohmann::json::parse(of_reference.ToJson()).at("calibration").at("reference");
  EXPECT_NEAR(reference.at("scale"), 1, 0.01);
  EXPECT_NEAR(reference.at("points").at(0).at("ahead_m"), 0, 0.05);
  ExpectContains(of_reference.ToText(),
                 "reference: a similarity found from 40 of them, which takes 6 degrees of freedom");
}

}  // namespace
}  // namespace cairn::datasets
