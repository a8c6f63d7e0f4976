// The whole pipeline on logs made by hand.
#include "pipelines/landmark_map/landmark_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "pipelines/landmark_map/testing.h"
#include "pipelines/testing/in_process.h"
#include "schema/step_limits.h"

namespace cairn::landmark_map {
namespace {

BlobPtr Map(const Blob& log, const Options& options, int* rounds = nullptr, int* tasks = nullptr) {
  const LandmarkMap pipeline(options);
  return RunInProcess(pipeline, {{"log", std::make_shared<const Blob>(log)}}, [&](const proto::Step& step) {
    if (rounds != nullptr) ++*rounds;
    if (tasks != nullptr) *tasks = std::max(*tasks, step.tasks_size());
  });
}

// The corners of a square, whatever its place and heading: six distances, sorted.
std::vector<double> Distances(const Blob& result) {
  const auto x = result.Get<double>("map/landmark_x_m"), y = result.Get<double>("map/landmark_y_m");
  std::vector<double> distances;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) distances.push_back(std::hypot(x[i] - x[k], y[i] - y[k]));
  }
  std::ranges::sort(distances);
  return distances;
}

void ExpectSquare(const Blob& result, double side_m, double tolerance_m) {
  ASSERT_EQ(result.Get<double>("map/landmark_x_m").size(), 4U);
  const std::vector<double> distances = Distances(result);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(distances[i], side_m, tolerance_m);
  for (int i = 4; i < 6; ++i) EXPECT_NEAR(distances[i], side_m * std::sqrt(2.0), tolerance_m);
}

TEST(LandmarkMap, FindsTheCornersFromContactsThatLookAlike) {
  SquareLog log{.laps = 4, .side_m = 20.0, .drift_rad_per_m = 0.002};
  const BlobPtr result = Map(log.Make(), {.cell_m = 0.5});
  ExpectSquare(*result, 20.0, 0.7);
  const auto landmark = result->Get<std::int32_t>("robot/0/observations/map_landmark");
  for (std::size_t i = 4; i < landmark.size(); ++i) EXPECT_EQ(landmark[i], landmark[i - 4]) << i;
  EXPECT_NEAR(result->Scalar<double>("robot/0/heading_drift_rad_per_m"), 0.002, 0.001);
}

TEST(LandmarkMap, FindsTheCornersFromRangeAndBearingWithIdentities) {
  SquareLog log{.laps = 4, .ranged = true, .identified = true};
  const BlobPtr result = Map(log.Make(), {});
  ExpectSquare(*result, 10.0, 0.5);
  const auto identity = result->Get<std::int32_t>("map/landmark_identity");
  EXPECT_EQ(std::vector<std::int32_t>(identity.begin(), identity.end()),
            (std::vector<std::int32_t>{0, 1, 2, 3}));
}

TEST(LandmarkMap, FindsTheCornersFromRangeAndBearingWithoutIdentities) {
  SquareLog log{.laps = 4, .side_m = 20.0, .ranged = true};
  const BlobPtr result = Map(log.Make(), {.cell_m = 0.5, .radius_m = 5.0});
  ExpectSquare(*result, 20.0, 1.0);
}

// The walk and the drift that made the log, to 30%, from noise parameters two and a half times too small and
// too large. Every motion increment has one corner, so that the turns' error must be known (there is none)
// for the walk's to show; and no room is left for an unknown drift (drift_length_m), which would take the
// walk's place.
// A map from ranges that are all 0.4 m too long would be too large; ranges without such an error are left
// alone.
TEST(LandmarkMap, FindsWhatAllRangesAreTooLongBy) {
  for (const double offset_m : {0.0, 0.4, -0.2}) {
    const BlobPtr result = Map(
        PostsLog{.drift_rad_per_m = 0.002, .range_offset_m = offset_m, .named = true, .times = 4}.Make(), {});
    const auto x = result->Get<double>("map/landmark_x_m"), y = result->Get<double>("map/landmark_y_m");
    ASSERT_EQ(x.size(), 6U);
    EXPECT_NEAR(std::hypot(x[5] - x[0], y[5] - y[0]), std::hypot(6.0, 16.0), 0.1) << offset_m;
    ASSERT_EQ(result->Has("robot/0/range_offset_m"), offset_m != 0.0);
    if (offset_m == 0.0) continue;
    EXPECT_NEAR(result->Scalar<double>("robot/0/range_offset_m"), offset_m, 0.05);
  }
}

// EM starts from widths three times as wide where a log states none; what the least squares expects is the
// same.
TEST(LandmarkMap, TheLeastSquaresExpectsNoWiderOdometryForWhereEmStarts) {
  const Blob silent = PostsLog{.drift_rad_per_m = 0.002, .named = true, .times = 4}.Make();
  Blob stated = silent;
  stated.PutScalar<double>("noise/heading_walk_rad_per_sqrt_m", 0.7 * std::numbers::pi / 180.0);
  stated.PutScalar<double>("noise/turn_ratio", 0.02);
  const BlobPtr one = Map(silent, {}), other = Map(stated, {});
  for (const char* width : {"odometry_walk_rad_per_sqrt_m", "odometry_turn_rad_per_sqrt_rad"}) {
    const std::string name = std::string("robot/0/") + width;
    EXPECT_NEAR(one->Scalar<double>(name) / other->Scalar<double>(name), 1.0, 0.1) << width;
  }
}

TEST(LandmarkMap, FindsTheWalkAndTheDriftThatTheLogsNoiseGetsWrong) {
  constexpr double kWalk = 0.02, kDrift = 0.005;
  const double drift_sd = kWalk / std::sqrt(480.0);  // of the mean drift, by the walk alone
  for (const double wrong : {0.4, 2.5}) {
    SquareLog square{.laps = 12, .ranged = true, .identified = true, .drift_rad_per_m = kDrift};
    square.walk_rad_per_sqrt_m = kWalk;
    Blob log = square.Make();
    log.PutScalar<double>("noise/heading_walk_rad_per_sqrt_m", wrong * kWalk);
    log.PutScalar<double>("noise/heading_drift_rad_per_m", wrong * kDrift);
    log.PutScalar<double>("noise/turn_ratio", 0.0);
    const BlobPtr result = Map(log, {.drift_length_m = 0.01});
    EXPECT_NEAR(result->Scalar<double>("robot/0/heading_walk_rad_per_sqrt_m"), kWalk, 0.3 * kWalk) << wrong;
    EXPECT_NEAR(result->Scalar<double>("robot/0/heading_drift_rad_per_m"), kDrift, 2.0 * drift_sd) << wrong;
  }
}

// Each post is seen once: nothing confirms what a search supposes of the odometry.
TEST(LandmarkMap, WhereASearchFindsNoLandmarkThePathIsOdometrys) {
  constexpr int kGap_m = 10, kPosts = 8;
  Rng rng(1);
  std::vector<double> time, turn, forward, seen_s, range, bearing;
  for (int k = 1; k <= kGap_m * (kPosts + 1); ++k) {
    time.push_back(k);
    turn.push_back(0.01 + 0.005 * rng.Normal());
    forward.push_back(1.0 + 0.01 * rng.Normal());
    if (k % kGap_m != kGap_m - 3 || k > kGap_m * kPosts) continue;
    const double beside_m = rng.Uniform(-3, 3);
    seen_s.push_back(k);
    range.push_back(std::hypot(3.0, beside_m));
    bearing.push_back(std::atan2(beside_m, 3.0));
  }
  Blob log = PostsLog{}.Make();
  log.PutVector("robot/0/odometry/time_s", time);
  log.PutVector("robot/0/odometry/turn_rad", turn);
  log.PutVector("robot/0/odometry/forward_m", forward);
  log.PutVector("robot/0/observations/landmark", std::vector<std::int32_t>(seen_s.size(), -1));
  log.PutVector("robot/0/observations/time_s", seen_s);
  log.PutVector("robot/0/observations/range_m", range);
  log.PutVector("robot/0/observations/bearing_rad", bearing);
  const BlobPtr result = Map(log, {});
  ASSERT_TRUE(result->Has("search/support"));
  ASSERT_TRUE(result->Get<double>("map/landmark_x_m").empty());
  EXPECT_EQ(result->Scalar<double>("robot/0/heading_drift_rad_per_m"), 0.0);
  double x_m = 0, y_m = 0, heading_rad = 0;
  for (std::size_t k = 0; k < turn.size(); ++k) {
    heading_rad += turn[k];
    x_m += forward[k] * std::cos(heading_rad);
    y_m += forward[k] * std::sin(heading_rad);
  }
  const auto x = result->Get<double>("robot/0/poses/x_m"), y = result->Get<double>("robot/0/poses/y_m");
  EXPECT_NEAR(x.back() - x.front(), x_m, 0.01);
  EXPECT_NEAR(y.back() - y.front(), y_m, 0.01);
}

TEST(LandmarkMap, TheTriangularErrorOfThePaperWorksToo) {
  SquareLog log{.laps = 4, .side_m = 20.0};
  ExpectSquare(*Map(log.Make(), {.cell_m = 0.5, .motion_error = "triangular"}), 20.0, 0.7);
}

// EM's promise holds for the exact model, with nothing pruned and the motion model left alone.
TEST(LandmarkMap, TheLikelihoodNeverFallsUnderTheExactModel) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const Blob log = SquareLog{.laps = 3, .side_m = 8.0, .seed = seed}.Make();
    const BlobPtr result = Map(log, {.cell_m = 1.0,
                                     .heading_deg = 10.0,
                                     .iterations = 12,
                                     .tolerance = 0.0,
                                     .calibrate = false,
                                     .model = "exact",
                                     .prune = 0.0});
    const auto history = result->Get<double>("history/log_likelihood");
    ASSERT_GE(history.size(), 12U);
    for (std::size_t i = 2; i < history.size(); ++i) EXPECT_GE(history[i], history[i - 1] - 1e-9) << i;
    EXPECT_GT(history.back(), history[1] + 1.0);
  }
}

// Who looks at them sees the map come into being: the last is what refinement began with.
TEST(LandmarkMap, KeepsTheLandmarksOfEachIteration) {
  SquareLog log{.laps = 4, .side_m = 20.0, .drift_rad_per_m = 0.002};
  const BlobPtr result = Map(log.Make(), {.cell_m = 0.5, .refine = false});
  const auto iteration = result->Get<std::int64_t>("history/landmark_iteration");
  const auto x = result->Get<double>("history/landmark_x_m"), map_x = result->Get<double>("map/landmark_x_m");
  ASSERT_FALSE(iteration.empty());
  EXPECT_TRUE(std::ranges::is_sorted(iteration));
  EXPECT_EQ(iteration.front(), 0);
  EXPECT_LT(iteration.back(), result->at("history/log_likelihood").size());
  ASSERT_EQ(std::ranges::count(iteration, iteration.back()), std::ssize(map_x));
  for (std::size_t k = 0; k < map_x.size(); ++k) EXPECT_EQ(x[x.size() - map_x.size() + k], map_x[k]);
}

TEST(LandmarkMap, StopsWhereTheLikelihoodNoLongerChanges) {
  const Blob log = SquareLog{.laps = 3, .side_m = 20.0}.Make();
  int some = 0, all = 0;
  Map(log, {.iterations = 30, .tolerance = 0.01, .starts = 1}, &some);
  Map(log, {.iterations = 30, .tolerance = 0.0, .starts = 1}, &all);
  EXPECT_LT(some, all);
  EXPECT_EQ(all,
            30 + 3);  // planning, thirty E-steps, and those for the summary, before the refinement and after
}

// The second robot is the first one's log begun a lap later: it must find itself in the first one's map.
TEST(LandmarkMap, ASecondRobotIsPlacedInTheFirstOnesMapAndTimesIncrease) {
  Blob log = SquareLog{.laps = 4, .ranged = true, .identified = true}.Make();
  const Blob second = SquareLog{.laps = 2, .ranged = true, .identified = true, .seed = 2}.Make();
  log.Put("robots", Array::Texts({"one", "two"}));
  log.PutAll("robot/1/", second.Sub("robot/0/"));
  const BlobPtr result = Map(log, {.cell_m = 1.0, .heading_deg = 10.0});
  ExpectSquare(*result, 10.0, 0.5);
  for (const char* robot : {"robot/0/", "robot/1/"}) {
    const auto time = result->Get<double>(std::string(robot) + "poses/time_s");
    for (std::size_t i = 1; i < time.size(); ++i) ASSERT_GT(time[i], time[i - 1]) << robot << i;
  }
  // Both drove the same square from the same corner: their paths must lie on each other.
  const auto x = result->Get<double>("robot/1/poses/mode_x_m"),
             y = result->Get<double>("robot/1/poses/mode_y_m");
  EXPECT_NEAR(x.front(), 0.0, 0.8);
  EXPECT_NEAR(y.front(), 0.0, 0.8);
}

// After they have joined, robots whose landmarks have no names are looked up for some iterations in the map
// of the others, which is not the one that the first robot is looked up in.
TEST(LandmarkMap, RobotsThatJoinedAreFoundInTheMapOfTheOthersForSomeIterations) {
  Blob log = PostsLog{.drift_rad_per_m = 0.0}.Make();
  log.Put("robots", Array::Texts({"one", "two"}));
  log.PutAll("robot/1/", PostsLog{.drift_rad_per_m = 0.0, .seed = 2}.Make().Sub("robot/0/"));
  std::vector<bool> apart;  // of each round of both
  const LandmarkMap pipeline({.starts = 1});
  RunInProcess(pipeline, {{"log", std::make_shared<const Blob>(log)}}, [&](const proto::Step& step) {
    std::map<std::int64_t, std::string> map_of;  // robot -> hash
    for (const Task& task : step.tasks())
      for (const proto::InputRef& input : task.inputs())
        if (input.name() == "perception") map_of[task.params().at("robot").i()] = input.blob();
    if (map_of.size() == 2) apart.push_back(map_of[0] != map_of[1]);
  });
  ASSERT_GE(apart.size(), 8U);
  EXPECT_FALSE(apart.front());
  for (std::size_t i = 1; i <= 5; ++i) EXPECT_TRUE(apart[i]) << i;
  EXPECT_EQ(std::ranges::count(apart, true), 5);
}

// Once it has joined, a robot that may start anywhere must not search a larger box in every round.
TEST(LandmarkMap, ARobotThatStartsAnywhereGetsNoDearerFromRoundToRound) {
  Blob log = SquareLog{.laps = 3, .side_m = 20.0}.Make();
  log.Put("robots", Array::Texts({"one", "two"}));
  log.PutAll("robot/1/", SquareLog{.laps = 3, .side_m = 20.0, .seed = 2}.Make().Sub("robot/0/"));
  std::vector<double> work;
  const LandmarkMap pipeline({.cell_m = 1.0, .heading_deg = 10.0, .iterations = 6, .tolerance = 0.0});
  RunInProcess(pipeline, {{"log", std::make_shared<const Blob>(log)}}, [&](const proto::Step& step) {
    const auto& scalars = step.state().scalars();
    if (scalars.contains("robots") && scalars.at("robots").i() == 2) work.push_back(scalars.at("work/1").d());
  });
  ASSERT_EQ(work.size(), 8U);  // expected of six rounds and the summary; the first is a guess
  for (std::size_t i = 2; i < work.size(); ++i) EXPECT_LE(work[i], 1.2 * work[1]) << i;
}

TEST(LandmarkMap, TheExactModelIsForContactsOnly) {
  EXPECT_THROW(Map(SquareLog{.ranged = true}.Make(), {.model = "exact"}), InputError);
}

TEST(LandmarkMap, AGridThatWouldNeedTooMuchMemorySaysHowMuch) {
  try {
    Map(SquareLog{}.Make(), {.cell_m = 0.001, .memory_mb = 100});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("would need about"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("memory_mb = 100"), std::string::npos) << e.what();
  }
}

TEST(LandmarkMap, ALogWithControlsOnlyIsRefused) {
  Blob log = SquareLog{}.Make();
  log.Put("robot/0/observations/time_s", Array::Vector<double>({}));
  log.Put("robot/0/observations/landmark", Array::Vector<std::int32_t>({}));
  log.Put("robot/0/observations/range_m", Array::Vector<double>({}));
  log.Put("robot/0/observations/bearing_rad", Array::Vector<double>({}));
  EXPECT_THROW(Map(log, {}), InputError);
}

TEST(LandmarkMap, NoiseThatIsNoSensibleFigureIsRefused) {
  for (const double wrong : {-1.0, 1e200, std::nan("")}) {
    Blob log = SquareLog{}.Make();
    log.PutScalar<double>("noise/turn_ratio", wrong);
    EXPECT_THROW(Map(log, {}), InputError) << wrong;
  }
}

TEST(LandmarkMap, MoreStartsThanAStateHoldsAreRefusedAtTheStart) {
  const Blob log = SquareLog{.laps = 2}.Make();
  try {
    Map(log, {.iterations = 10000, .starts = 1000});
    FAIL() << "it was begun";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find("starts=1000 are more than can be searched side by side"), 0U)
        << error.what();
  }
  const auto steps_of = [&](std::int64_t starts) {
    return LandmarkMap({.starts = starts}).Start(MapInputs({{"log", std::make_shared<const Blob>(log)}}));
  };
  EXPECT_LT(steps_of(250).plan.state().scalars().size(), kMostFigures);
}

TEST(LandmarkMap, ABoxTooSmallForTheTrajectoryIsRefused) {
  EXPECT_THROW(Map(SquareLog{.side_m = 20.0}.Make(), {.box_m = 10.0}), InputError);
}

// The rows of robot 0 up to a time.
Blob CutAt(const Blob& log, double until_s) {
  Blob cut = log;
  for (const char* group : {"robot/0/odometry/", "robot/0/observations/"}) {
    const auto time_s = log.Get<double>(group + std::string("time_s"));
    const auto rows = std::ranges::upper_bound(time_s, until_s) - time_s.begin();
    const Blob columns = log.Sub(group);
    for (const auto& [name, array] : columns.fields()) cut.Put(group + name, array.Rows(0, rows));
  }
  return cut;
}

TEST(LandmarkMap, APrefixGivesTheMapOfALogThatEndsThere) {
  const Blob log = SquareLog{.laps = 3, .side_m = 20.0, .drift_rad_per_m = 0.001}.Make();
  const double until_s = log.Get<double>("robot/0/observations/time_s")[5];
  Options options{.cell_m = 1.0, .starts = 1};
  const BlobPtr cut = Map(CutAt(log, until_s), options);
  options.prefix_observations = 6;
  const BlobPtr prefix = Map(log, options);
  EXPECT_EQ(prefix->Scalar<double>("until_s"), until_s);
  EXPECT_EQ(prefix->Scalar<std::int64_t>("until_observations"), 6);
  for (const char* name : {"map/landmark_x_m", "map/grid/probability", "robot/0/poses/time_s",
                           "robot/0/poses/mode_x_m", "history/log_likelihood"}) {
    EXPECT_TRUE(prefix->at(name) == cut->at(name)) << name;
  }
  const auto landmark = prefix->Get<std::int32_t>("robot/0/observations/map_landmark");
  ASSERT_EQ(landmark.size(), 12U);
  EXPECT_NE(landmark[5], -1);
  EXPECT_EQ(landmark[6], -1);
}

double LargestVariance(const Blob& result, std::size_t poses) {
  const auto covariance = result.Get<double>("robot/0/poses/covariance");
  double largest = 0.0;
  for (std::size_t i = 0; i < poses; ++i)
    largest = std::max(largest, covariance[9 * i] + covariance[9 * i + 4]);
  return largest;
}

// Round the first lap nothing is seen twice: only what comes later tells where the robot was.
TEST(LandmarkMap, WithoutRevisionTheFirstLapStaysAsUncertainAsOdometryIs) {
  const Blob log = SquareLog{.laps = 3, .side_m = 20.0, .walk_rad_per_sqrt_m = 0.02}.Make();
  Options options{.cell_m = 1.0, .refine = false, .starts = 1};
  const double revised = LargestVariance(*Map(log, options), 60);
  options.revise = false;
  const double forward = LargestVariance(*Map(log, options), 60);
  EXPECT_GT(forward, 2.0 * revised);
}

// Contact detections do not tell the scale of the odometry's distances: among the landmarks a corner may be
// as far out as the log says that they err.
TEST(LandmarkMap, ContactsLandmarksAreAsUncertainAsTheScaleOfDistances) {
  for (const double ratio : {0.05, 0.1}) {
    Blob log = SquareLog{.laps = 4, .side_m = 20.0}.Make();
    log.PutScalar<double>("noise/forward_ratio", ratio);
    const BlobPtr result = Map(log, {.cell_m = 1.0, .starts = 1});
    const auto covariance = result->Get<double>("map/landmark_covariance_m2");
    ASSERT_EQ(covariance.size(), 16U);
    const Array& joint = result->at("map/landmark_joint_covariance_m2");
    ASSERT_EQ(joint.shape(), (Shape{4, 2, 4, 2}));
    const auto together = result->Get<double>("map/landmark_joint_covariance_m2");
    for (std::size_t l = 0; l < 4; ++l) {
      for (std::size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(together[(2 * l + i / 2) * 8 + 2 * l + i % 2], covariance[4 * l + i], 1e-9);
      const double variance_m2 = covariance[4 * l] + covariance[4 * l + 3];
      EXPECT_NEAR(std::sqrt(variance_m2), ratio * std::hypot(10.0, 10.0), 0.25 * ratio * 14.0) << ratio;
    }
  }
}

TEST(LandmarkMap, BeliefsAreThoseOfThePoses) {
  const Blob log = SquareLog{.laps = 2, .side_m = 20.0}.Make();
  const BlobPtr result =
      Map(log, {.cell_m = 1.0, .refine = false, .beliefs = true, .starts = 1, .slice_mcells = 0.1});
  const LayeredGrid beliefs = LayeredGrid::Load("robot/0/beliefs/", *result);
  const auto step_s = result->Get<double>("robot/0/beliefs/time_s");
  const auto pose_s = result->Get<double>("robot/0/poses/time_s");
  const auto x = result->Get<double>("robot/0/poses/x_m"), y = result->Get<double>("robot/0/poses/y_m");
  ASSERT_EQ(beliefs.layers.size(), step_s.size());
  ASSERT_GT(step_s.size(), 8U);
  for (std::size_t s = 0; s < step_s.size(); ++s) {
    const Layer& belief = beliefs.layers[s];
    EXPECT_NEAR(belief.Sum(), 1.0, 1e-9);
    double mean_x = 0.0, mean_y = 0.0;
    for (int j = belief.box.y0; j < belief.box.y0 + belief.box.ny; ++j) {
      for (int i = belief.box.x0; i < belief.box.x0 + belief.box.nx; ++i) {
        mean_x += i * belief.Row(j)[i];
        mean_y += j * belief.Row(j)[i];
      }
    }
    const auto row = static_cast<std::size_t>(std::ranges::lower_bound(pose_s, step_s[s]) - pose_s.begin());
    ASSERT_EQ(pose_s[row], step_s[s]);
    EXPECT_NEAR(mean_x, x[row], 1e-6);
    EXPECT_NEAR(mean_y, y[row], 1e-6);
  }
}

// Of each iteration its landmarks, beside those of all before it.
TEST(LandmarkMap, ShowsItsMapAsItComesIntoBeing) {
  SquareLog log{.laps = 4, .ranged = true, .identified = true};
  const auto input = std::make_shared<const Blob>(log.Make());
  const std::vector<BlobPtr> maps = MapsSoFar(LandmarkMap({}), {{"log", input}});
  ASSERT_GT(maps.size(), 2U);
  std::size_t iterations = 0;
  for (const BlobPtr& map : maps) {
    const std::size_t now = map->Get<double>("so_far/history/log_likelihood").size();
    EXPECT_GE(now, iterations);
    iterations = now;
    EXPECT_TRUE(map->Text("so_far/what").starts_with("iteration ")) << map->Text("so_far/what");
  }
  EXPECT_GT(iterations, 2U);
  const auto x = maps.back()->Get<double>("so_far/map/landmark_x_m");
  EXPECT_EQ(x.size(), 4U);
  const auto identity = maps.back()->Get<std::int32_t>("so_far/map/landmark_identity");
  EXPECT_EQ(std::vector<std::int32_t>(identity.begin(), identity.end()),
            (std::vector<std::int32_t>{0, 1, 2, 3}));
}

// The last of them is the result's, but for what refinement moves.
TEST(LandmarkMap, ShowsWhereTheRobotIsAsItsMapComesIntoBeing) {
  SquareLog log{.laps = 4, .ranged = true, .identified = true};
  const auto input = std::make_shared<const Blob>(log.Make());
  const LandmarkMap pipeline({.slice_mcells = 0.1});
  const std::vector<BlobPtr> maps = MapsSoFar(pipeline, {{"log", input}});
  const BlobPtr result = RunInProcess(pipeline, {{"log", input}});
  ASSERT_GT(maps.size(), 2U);
  EXPECT_EQ(maps.back()->Texts("so_far/robots"), input->Texts("robots"));
  const std::string name = "so_far/robot/0/poses/";
  const auto time = maps.back()->Get<double>(name + "time_s"), x = maps.back()->Get<double>(name + "x_m"),
             y = maps.back()->Get<double>(name + "y_m");
  const auto result_s = result->Get<double>("robot/0/poses/time_s"),
             result_x = result->Get<double>("robot/0/poses/x_m"),
             result_y = result->Get<double>("robot/0/poses/y_m");
  ASSERT_GT(time.size(), 20U);
  EXPECT_GE(time.back(), 0.9 * result_s.back());
  for (std::size_t i = 0; i < time.size(); ++i) {
    const auto at = static_cast<std::size_t>(std::ranges::lower_bound(result_s, time[i]) - result_s.begin());
    ASSERT_LT(at, result_s.size());
    ASSERT_EQ(result_s[at], time[i]);
    EXPECT_LT(std::hypot(x[i] - result_x[at], y[i] - result_y[at]), 1.0) << time[i];
  }
}

TEST(LandmarkMap, OfSeveralStartsItShowsTheLikeliest) {
  SquareLog log{.laps = 4, .side_m = 20.0, .drift_rad_per_m = 0.002};
  const auto input = std::make_shared<const Blob>(log.Make());
  const std::vector<BlobPtr> maps = MapsSoFar(LandmarkMap({.cell_m = 0.5, .starts = 3}), {{"log", input}});
  ASSERT_GT(maps.size(), 2U);
  EXPECT_TRUE(maps.front()->Text("so_far/what").starts_with("start ")) << maps.front()->Text("so_far/what");
  EXPECT_EQ(maps.back()->Get<double>("so_far/map/landmark_x_m").size(), 4U);
}

}  // namespace
}  // namespace cairn::landmark_map
