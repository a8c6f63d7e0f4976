#include "pipelines/landmark_map/refinement/refine.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

constexpr std::array<std::array<double, 2>, 4> kCorners{{{20, 0}, {20, 20}, {0, 20}, {0, 0}}};

Settings SomeSettings() {
  Settings settings;
  settings.map.grid = {1.0, 72};
  settings.map.core_m = 2.5;
  settings.noise = {0.01, 0.01, 0.0, 0.02, 0.0};
  return settings;
}

// Laps of a square in motion increments from corner to corner, odometry that errs by a drift and a walk a
// motion increment, and what an E-step that saw cells of a metre would say of it.
AssociatedPath RoundAndRound(double drift_rad_per_m, int laps = 3, double walk_rad = 0.0) {
  Rng rng(3);
  AssociatedPath path;
  RobotSteps& steps = path.steps;
  double x = 0, y = 0, heading = 0;
  for (int s = 0; s <= 4 * laps; ++s) {
    if (s > 0) {
      const double turned = drift_rad_per_m * 20.0 + walk_rad * rng.Normal();
      const double middle = (s - 1) * std::numbers::pi / 2 + heading + 0.5 * turned;
      x += 20.0 * std::cos(middle);
      y += 20.0 * std::sin(middle);
      heading += turned;
    }
    steps.time_s.push_back(s);
    steps.odo_x_m.push_back(x);
    steps.odo_y_m.push_back(y);
    steps.odo_heading_rad.push_back(heading);
    steps.path_m.push_back(s > 0 ? 20.0 : 0.0);
    steps.turn_rad.push_back(0.0);
    steps.first_observation.push_back(s > 0 ? s - 1 : 0);
    const auto& corner = kCorners[static_cast<std::size_t>((s + 3) % 4)];
    path.x_m.push_back(corner[0] + 0.4);
    path.y_m.push_back(corner[1] - 0.3);
    path.correction_rad.push_back(-heading);
    if (s == 0) continue;
    steps.observations.push_back({0, 0.0, 0.0});
    path.associated.landmark.push_back((s + 3) % 4);
    path.associated.probability.push_back(0.9);
  }
  steps.first_observation.push_back(4 * laps);
  path.odometry = OdometryFit::Of(SomeSettings().noise);
  return path;
}

std::vector<Landmark> Corners(double off_m) {
  std::vector<Landmark> landmarks;
  for (const auto& [x, y] : kCorners) landmarks.push_back({x + off_m, y - off_m, {1, 0, 0, 1}, 0, 3.0});
  return landmarks;
}

double Farthest(const std::vector<Landmark>& landmarks) {
  double farthest = 0;
  for (std::size_t k = 0; k < landmarks.size(); ++k)
    farthest =
        std::max(farthest, std::hypot(landmarks[k].x_m - kCorners[k][0], landmarks[k].y_m - kCorners[k][1]));
  return farthest;
}

TEST(RefineMap, OdometryWithoutErrorGivesLandmarksWithoutError) {
  const auto refined = RefineMap({RoundAndRound(0.0)}, SomeSettings(), Corners(0.6));
  ASSERT_EQ(refined.refused, "");
  EXPECT_LT(Farthest(refined.landmarks), 1e-6);
  for (const Landmark& l : refined.landmarks) {
    EXPECT_GT(l.covariance_m2[0], 0.0);
    EXPECT_NEAR(l.covariance_m2[1], l.covariance_m2[2], 1e-12);
  }
  EXPECT_LT(refined.landmarks.back().covariance_m2[0], refined.landmarks[1].covariance_m2[0])
      << "it is nearest to the start";
}

// A robot that stands at the origin and contact detections n times: the landmark's variance is the contact
// detection's over n.
TEST(RefineMap, TheCovarianceIsThatOfTheMean) {
  AssociatedPath path;
  path.steps.time_s = path.steps.odo_x_m = path.steps.odo_y_m = path.steps.odo_heading_rad = {0.0};
  path.steps.path_m = path.steps.turn_rad = {0.0};
  path.x_m = path.y_m = path.correction_rad = {0.0};
  constexpr int kContacts = 5;
  path.steps.first_observation = {0, kContacts};
  path.steps.observations.assign(kContacts, {0, 0.0, 0.0});
  path.associated.landmark.assign(kContacts, 0);
  path.associated.probability.assign(kContacts, 1.0);
  path.odometry = OdometryFit::Of(SomeSettings().noise);
  const auto refined = RefineMap({path}, SomeSettings(), {{0.5, -0.5, {1, 0, 0, 1}, 0, kContacts}});
  ASSERT_EQ(refined.refused, "");
  const double sd = SomeSettings().observation_noise.contact_m;
  const double variance = sd * sd / kContacts;
  EXPECT_NEAR(refined.landmarks[0].covariance_m2[0], variance, 1e-6 * variance);
  EXPECT_NEAR(refined.landmarks[0].covariance_m2[3], variance, 1e-6 * variance);
  EXPECT_NEAR(refined.landmarks[0].covariance_m2[1], 0.0, 1e-6 * variance);
}

// A robot that stands at the origin and sees a landmark at (3, 4): 5 m off, along a ray of slope 4 / 3.
TEST(RefineMap, AnObservationsCovarianceLiesAlongItsRay) {
  Settings settings = SomeSettings();
  settings.observation_noise = {
      .contact_m = 0.3, .range_m = 0.2, .bearing_rad = 0.2};  // 0.2 m along, 1 m across
  AssociatedPath path;
  path.steps.time_s = path.steps.odo_x_m = path.steps.odo_y_m = path.steps.odo_heading_rad = {0.0};
  path.steps.path_m = path.steps.turn_rad = {0.0};
  path.x_m = path.y_m = path.correction_rad = {0.0};
  path.steps.first_observation = {0, 1};
  path.steps.observations = {{0, 3.0, 4.0}};
  path.associated = {{0}, {1.0}};
  path.odometry = OdometryFit::Of(settings.noise);
  const auto refined = RefineMap({path}, settings, {{3.1, 3.9, {1, 0, 0, 1}, 0, 1.0}});
  ASSERT_EQ(refined.refused, "");
  const Landmark& l = refined.landmarks[0];
  EXPECT_NEAR(l.covariance_m2[0], 0.36 * 0.04 + 0.64, 1e-6);
  EXPECT_NEAR(l.covariance_m2[1], 0.48 * (0.04 - 1.0), 1e-6);
  EXPECT_NEAR(l.covariance_m2[3], 0.64 * 0.04 + 0.36, 1e-6);
}

// From the origin it is seen 10 m ahead along y, from (40, 10) 40 m off along x; odometry hardly errs. The
// first range-bearing observation errs by 0.5 m along and 0.5 m across, the second by 0.5 m and 2 m: x is the
// mean of both, y of weights 16 to 1.
TEST(RefineMap, EachObservationCountsByItsOwnCovariance) {
  Settings settings = SomeSettings();
  settings.noise = {0.0, 0.0, 0.0, 0.0, 0.0};
  settings.observation_noise = {.contact_m = 0.3, .range_m = 0.5, .bearing_rad = 0.05};
  AssociatedPath path;
  path.steps.time_s = {0.0, 1.0};
  path.steps.odo_x_m = path.x_m = {0.0, 40.0};
  path.steps.odo_y_m = path.y_m = {0.0, 10.0};
  path.steps.odo_heading_rad = path.correction_rad = path.steps.turn_rad = {0.0, 0.0};
  path.steps.path_m = {0.0, std::hypot(40.0, 10.0)};
  path.steps.first_observation = {0, 1, 2};
  path.steps.observations = {{0, 0.1, 10.1}, {0, -40.1, -0.1}};
  path.associated = {{0, 0}, {1.0, 1.0}};
  path.odometry = OdometryFit::Of(settings.noise);
  const auto refined = RefineMap({path}, settings, {{0.0, 10.0, {1, 0, 0, 1}, 0, 2.0}});
  ASSERT_EQ(refined.refused, "");
  EXPECT_NEAR(refined.landmarks[0].x_m, 0.0, 0.005);
  EXPECT_NEAR(refined.landmarks[0].y_m, (16.0 * 10.1 + 9.9) / 17.0, 0.005);
  EXPECT_NEAR(refined.landmarks[0].covariance_m2[0], 0.25 / 2.0, 0.003);
  EXPECT_NEAR(refined.landmarks[0].covariance_m2[3], 0.25 * 16.0 / 17.0, 0.003);
}

// Two landmarks seen from both ends of a motion increment, from its end much nearer than they can be.
AssociatedPath ObservationsThatContradict(const Settings& settings) {
  AssociatedPath path;
  path.steps.time_s = {0.0, 1.0};
  path.steps.odo_x_m = path.x_m = {0.0, 10.0};
  path.steps.odo_y_m = path.y_m = {0.0, 0.0};
  path.steps.odo_heading_rad = path.correction_rad = path.steps.turn_rad = {0.0, 0.0};
  path.steps.path_m = {0.0, 10.0};
  path.steps.first_observation = {0, 2, 4};
  path.steps.observations = {{0, 6.0, 8.0}, {1, 13.0, -4.0}, {0, -2.0, 6.0}, {1, 1.0, -2.0}};
  path.associated = {{0, 1, 0, 1}, {1.0, 1.0, 1.0, 1.0}};
  path.odometry = OdometryFit::Of(settings.noise);
  return path;
}

// Minus the logarithm of their probability, twice: u is the second pose and the landmarks.
double CostOf(const std::array<double, 7>& u, const AssociatedPath& path, const Settings& settings) {
  const auto squares = [](double along, double across, double along_sd, double across_sd) {
    return along * along / (along_sd * along_sd) + across * across / (across_sd * across_sd);
  };
  const double turn_sd = settings.noise.heading_walk_rad_per_sqrt_m * std::sqrt(10.0);
  const double cosine = std::cos(0.5 * u[2]), sine = std::sin(0.5 * u[2]);
  double cost = squares(u[2], 0.0, turn_sd, 1.0) +
                squares(cosine * u[0] + sine * u[1] - 10.0, cosine * u[1] - sine * u[0],
                        settings.noise.forward_ratio * std::sqrt(10.0), 5.0 * turn_sd);
  for (std::size_t k = 0; k < 4; ++k) {
    const Observation& seen = path.steps.observations[k];
    const bool second = k >= 2;
    const double c = second ? std::cos(u[2]) : 1.0, s = second ? std::sin(u[2]) : 0.0;
    const double dx = u[3 + 2 * (k % 2)] - (second ? u[0] : 0.0),
                 dy = u[4 + 2 * (k % 2)] - (second ? u[1] : 0.0);
    const double x = c * dx + s * dy, y = c * dy - s * dx;  // as the robot has it
    const double range = std::hypot(seen.x_m, seen.y_m);
    const double along = (seen.x_m * x + seen.y_m * y) / range - range;
    const double across = (seen.x_m * y - seen.y_m * x) / range;
    const ObservationWidths sd = settings.observation_noise.At(seen.x_m, seen.y_m);
    cost += 9.0 * std::log1p(squares(along, across, sd.along_m, sd.across_m) / 9.0);
  }
  return cost;
}

// By a search that knows no gradient: an axis at a time, in ever smaller steps.
TEST(RefineMap, FindsTheLeastThatASearchWithoutAGradientFinds) {
  Settings settings = SomeSettings();
  settings.noise = {0.0, 0.1, 0.0, 0.5, 0.0};  // the motion increment errs alike along its way and across
  settings.map.core_m = 10.0;
  settings.observation_noise = {.contact_m = 0.3, .range_m = 1.0, .bearing_rad = 0.4};
  const AssociatedPath path = ObservationsThatContradict(settings);
  const std::vector<Landmark> landmarks{{6.0, 8.0, {1, 0, 0, 1}, 0, 2.0}, {12.0, -4.0, {1, 0, 0, 1}, 1, 2.0}};
  std::array<double, 7> found{10.0, 0.0, 0.0, 6.0, 8.0, 12.0, -4.0};
  double least = CostOf(found, path, settings);
  for (double step = 0.5; step > 1e-7;) {
    bool better = false;
    for (std::size_t k = 0; k < found.size(); ++k) {
      for (const double by : {step, -step}) {
        std::array<double, 7> tried = found;
        tried[k] += by;
        const double cost = CostOf(tried, path, settings);
        if (cost >= least) continue;
        least = cost;
        found = tried;
        better = true;
      }
    }
    if (!better) step *= 0.5;
  }
  const auto refined = RefineMap({path}, settings, landmarks);
  ASSERT_EQ(refined.refused, "");
  for (std::size_t l = 0; l < 2; ++l) {
    EXPECT_NEAR(refined.landmarks[l].x_m, found[3 + 2 * l], 1e-5);
    EXPECT_NEAR(refined.landmarks[l].y_m, found[4 + 2 * l], 1e-5);
  }
}

// A robot that turns on the spot twice, by 1 and by 2 rad, as odometry has it with 5% of error. It sees one
// landmark before and after, `off_rad` off, and in between another one. Least squares shares the misfit among
// the two turns and the two range-bearing observations by their variances: the heading in between, and so
// where the other landmark lies, is off by the first turn's share.
TEST(RefineMap, AMisfitOfTurnsIsSharedByTheirVariances) {
  Settings settings = SomeSettings();
  settings.noise = {0.01, 0.0, 0.0, 0.02, 0.05};
  settings.observation_noise = {.contact_m = 0.3, .range_m = 0.3, .bearing_rad = 0.05};
  constexpr double kOff_rad = 0.005, kRange_m = 100.0;
  AssociatedPath path;
  path.steps.time_s = {0.0, 1.0, 2.0};
  path.steps.odo_x_m = path.x_m = path.steps.odo_y_m = path.y_m = {0.0, 0.0, 0.0};
  path.steps.path_m = path.correction_rad = {0.0, 0.0, 0.0};
  path.steps.turn_rad = {0.0, 1.0, 2.0};
  path.steps.odo_heading_rad = {0.0, 1.0, 3.0};
  path.steps.first_observation = {0, 1, 2, 3};
  path.steps.observations = {{0, kRange_m, 0.0},
                             {1, 0.0, kRange_m},
                             {0, kRange_m * std::cos(kOff_rad), -kRange_m * std::sin(kOff_rad)}};
  path.associated = {{0, 1, 0}, {1.0, 1.0, 1.0}};
  path.odometry = OdometryFit::Of(settings.noise);
  const auto refined = RefineMap(
      {path}, settings, {{kRange_m, 0.0, {1, 0, 0, 1}, 0, 2.0}, {0.0, kRange_m, {1, 0, 0, 1}, 1, 1.0}});
  ASSERT_EQ(refined.refused, "");
  const double first = 0.05 * 0.05, second = 0.1 * 0.1, observation = 0.05 * 0.05;
  const double share = first / (first + second + 2.0 * observation);
  EXPECT_NEAR(refined.landmarks[1].x_m, -share * kOff_rad * kRange_m, 0.01 * share * kOff_rad * kRange_m);
  EXPECT_NEAR(refined.landmarks[0].y_m,
              -observation / (first + second + 2.0 * observation) * kOff_rad * kRange_m,
              0.01 * kOff_rad * kRange_m);
}

// Half of the drift's nominal width: 11 degrees a lap.
TEST(RefineMap, FindsADriftThatIsLeft) {
  const auto refined = RefineMap({RoundAndRound(0.0025)}, SomeSettings(), Corners(0.6));
  ASSERT_EQ(refined.refused, "");
  EXPECT_LT(Farthest(refined.landmarks), 0.1);
}

// All went round the same square; what is left of their drifts differs from robot to robot.
TEST(RefineMap, FindsADriftOfItsOwnForEachRobot) {
  const auto refined =
      RefineMap({RoundAndRound(0.0025), RoundAndRound(-0.0025), RoundAndRound(0.001), RoundAndRound(-0.002)},
                SomeSettings(), Corners(0.6));
  ASSERT_EQ(refined.refused, "");
  EXPECT_LT(Farthest(refined.landmarks), 0.1);
}

TEST(RefineMap, AnObservationThatBelongsElsewhereHardlyCounts) {
  AssociatedPath path = RoundAndRound(0.0);
  path.associated.landmark[6] = 0;  // 20 m off
  const auto refined = RefineMap({path}, SomeSettings(), Corners(0.6));
  ASSERT_EQ(refined.refused, "");
  EXPECT_LT(Farthest(refined.landmarks), 0.3);
  path.associated.landmark[6] = 2;
  path.associated.landmark[7] = 0;
  path.associated.probability[7] = 0.4;  // likelier of something else: not at all
  EXPECT_LT(Farthest(RefineMap({path}, SomeSettings(), Corners(0.6)).landmarks), 1e-6);
}

// By 8 m at most, three times the core: no observation changes its landmark.
TEST(RefineMap, AMapMayTurnAsAWhole) {
  constexpr double kTurn_rad = 0.3;
  AssociatedPath path = RoundAndRound(0.0);
  std::vector<Landmark> landmarks = Corners(0.6);
  const auto turn = [](double* x, double* y) {
    const double before = *x;
    *x = std::cos(kTurn_rad) * before - std::sin(kTurn_rad) * *y;
    *y = std::sin(kTurn_rad) * before + std::cos(kTurn_rad) * *y;
  };
  for (std::size_t s = 0; s < path.x_m.size(); ++s) {
    turn(&path.x_m[s], &path.y_m[s]);
    path.correction_rad[s] += kTurn_rad;
  }
  for (Landmark& l : landmarks) turn(&l.x_m, &l.y_m);
  ASSERT_GT(Farthest(landmarks), 3.0 * SomeSettings().map.core_m);
  const auto refined = RefineMap({path}, SomeSettings(), landmarks);
  ASSERT_EQ(refined.refused, "");
  EXPECT_LT(Farthest(refined.landmarks), 1e-6);
}

// From each corner the next one is seen, at a distance.
AssociatedPath SeeingTheNext(AssociatedPath path) {
  for (std::size_t s = 1; s < path.x_m.size(); ++s) {
    const auto& here = kCorners[(s + 3) % 4];
    const auto& next = kCorners[s % 4];
    const double turned_rad = path.steps.odo_heading_rad[s];
    const double dx = next[0] - here[0], dy = next[1] - here[1];
    path.steps.observations[s - 1] = {0, std::cos(turned_rad) * dx - std::sin(turned_rad) * dy,
                                      std::sin(turned_rad) * dx + std::cos(turned_rad) * dy};
    path.associated.landmark[s - 1] = static_cast<std::int32_t>(s % 4);
  }
  return path;
}

// The same drive, of a robot whose odometry began facing another way, as circular means say it: in (-pi, pi].
AssociatedPath Facing(AssociatedPath path, double turn_rad) {
  RobotSteps& steps = path.steps;
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  const auto turn = [&](double* x, double* y) {
    const double before = *x;
    *x = c * before - s * *y;
    *y = s * before + c * *y;
  };
  for (std::size_t k = 0; k < path.correction_rad.size(); ++k) {
    turn(&steps.odo_x_m[k], &steps.odo_y_m[k]);
    steps.odo_heading_rad[k] += turn_rad;
    path.correction_rad[k] = std::remainder(path.correction_rad[k] - turn_rad, 2.0 * std::numbers::pi);
  }
  for (Observation& seen : steps.observations) turn(&seen.x_m, &seen.y_m);
  return path;
}

// The second robot's estimates go to and fro by 0.02 rad, so that near pi they jump from one end to the
// other.
TEST(RefineMap, WhichWayARobotsOdometryBeganToFaceChangesNothing) {
  for (const bool sees : {false, true}) {
    AssociatedPath second = sees ? SeeingTheNext(RoundAndRound(0.0, 13, 0.05)) : RoundAndRound(0.0, 13, 0.05);
    for (std::size_t k = 0; k < second.correction_rad.size(); ++k)
      second.correction_rad[k] += k % 2 == 0 ? 0.02 : -0.02;
    const auto landmarks = [&](double turn_rad) {
      const auto refined =
          RefineMap({RoundAndRound(0.001), Facing(second, turn_rad)}, SomeSettings(), Corners(0.6));
      EXPECT_EQ(refined.refused, "") << turn_rad;
      return refined.landmarks;
    };
    const std::vector<Landmark> expected = landmarks(0.0);
    constexpr double kPi = std::numbers::pi;
    for (const double turn_rad :
         {0.5, 1.6, -2.9, kPi - 0.05, kPi - 0.01, kPi, kPi + 0.01, kPi + 0.05, 5.0, 9.42}) {
      const std::vector<Landmark> found = landmarks(turn_rad);
      ASSERT_EQ(found.size(), expected.size()) << turn_rad;
      for (std::size_t l = 0; l < found.size(); ++l) {
        EXPECT_NEAR(found[l].x_m, expected[l].x_m, 1e-6) << turn_rad;
        EXPECT_NEAR(found[l].y_m, expected[l].y_m, 1e-6) << turn_rad;
        EXPECT_NEAR(found[l].covariance_m2[0], expected[l].covariance_m2[0], 1e-6) << turn_rad;
      }
    }
  }
}

// Where the frame is the map's, and the first robot's start anywhere in it, the map stays in its frame.
TEST(RefineMap, WhereTheGaugeIsFreeTheFirstPoseStaysWhereItIs) {
  Settings settings = SomeSettings();
  settings.gauge_free = true;
  const auto refined = RefineMap({RoundAndRound(0.0)}, settings, Corners(0.6));
  ASSERT_EQ(refined.refused, "");
  for (std::size_t l = 0; l < kCorners.size(); ++l) {
    EXPECT_NEAR(refined.landmarks[l].x_m, kCorners[l][0] + 0.4, 1e-6);
    EXPECT_NEAR(refined.landmarks[l].y_m, kCorners[l][1] - 0.3, 1e-6);
  }
}

// By odometry the robot went round and round; the E-step has it turn back and forth between two corners.
TEST(RefineMap, WhereObservationsWouldChangeTheirLandmarksThereIsNone) {
  AssociatedPath path = RoundAndRound(0.0);
  for (std::size_t s = 1; s < path.x_m.size(); ++s) {
    const std::size_t corner = s % 2;
    path.x_m[s] = kCorners[corner][0];
    path.y_m[s] = kCorners[corner][1];
    path.associated.landmark[s - 1] = static_cast<std::int32_t>(corner);
  }
  EXPECT_EQ(RefineMap({path}, SomeSettings(), Corners(0.0)).refused,
            "6 of 12 observations would then lie nearer to another landmark than to their own");
}

}  // namespace
}  // namespace cairn::landmark_map
