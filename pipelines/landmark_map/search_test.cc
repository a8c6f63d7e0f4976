#include "pipelines/landmark_map/search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::landmark_map {
namespace {

Landmark At(double x_m, double y_m, int type = 0) { return {x_m, y_m, {1, 0, 0, 1}, type, 3.0}; }

Settings SearchSettings() {
  Settings settings;
  settings.starts = 9;
  settings.places = std::exp(9.0);
  settings.noise.heading_drift_rad_per_m = 0.01;
  return settings;
}

TEST(StartingPoints, DriftsSpreadEvenlyOverTwoStandardDeviationsToEitherSideForEachOfTwoPrefixes) {
  Settings settings = SearchSettings();
  settings.growth_start = 0.5;
  const std::vector<StartingPoint> points = StartingPoints(settings);
  const std::vector<double> drifts = {-0.02, -0.01, 0, 0.01, 0.02, -0.02, -0.01, 0, 0.01};
  ASSERT_EQ(points.size(), drifts.size());
  for (std::size_t k = 0; k < drifts.size(); ++k) {
    EXPECT_NEAR(points[k].drift_rad_per_m, drifts[k], 1e-15);
    EXPECT_NEAR(points[k].prefix, k < 5 ? 0.5 : 0.2, 1e-15);
  }
}

TEST(StartingPoints, OneStartsWhereOdometryIsAndSteadyOdometryLeavesTwo) {
  Settings one = SearchSettings(), steady = SearchSettings();
  one.starts = 1;
  steady.noise.heading_drift_rad_per_m = 0.0;
  ASSERT_EQ(StartingPoints(one).size(), 1U);
  EXPECT_EQ(StartingPoints(one)[0].drift_rad_per_m, 0.0);
  EXPECT_EQ(StartingPoints(one)[0].prefix, one.growth_start);
  ASSERT_EQ(StartingPoints(steady).size(), 2U);
  EXPECT_EQ(StartingPoints(steady)[1].drift_rad_per_m, 0.0);
}

// A candidate with so many landmarks, of which its observations are.
Candidate Found(double log_likelihood, std::size_t landmarks, std::vector<std::int32_t> associations,
                double start_drift_rad_per_m = 0.0) {
  Candidate candidate;
  candidate.start.drift_rad_per_m = start_drift_rad_per_m;
  candidate.log_likelihood = log_likelihood;
  for (std::size_t k = 0; k < landmarks; ++k) candidate.landmarks.push_back(At(10.0 * k, 0.0));
  candidate.associations = std::move(associations);
  return candidate;
}

Candidate Failed(const char* why) {
  Candidate candidate;
  candidate.failure = why;
  return candidate;
}

Candidate RefitOf(int parent, Candidate candidate) {
  candidate.refit_of = parent;
  return candidate;
}

TEST(ScoreOf, ALandmarkCostsTheLogarithmOfThePlacesForIt) {
  EXPECT_NEAR(ScoreOf(Found(-50.0, 2, {}), SearchSettings()), -50.0 - 2 * 9.0, 1e-12);
}

// Three standard deviations under Student's t of four degrees of freedom: (1 + 9 / 4)^-2.5.
TEST(ScoreOf, ADriftCostsWhatItsPriorSays) {
  Candidate candidate = Found(-50.0, 0, {});
  candidate.drift_rad_per_m = -0.03;
  EXPECT_NEAR(ScoreOf(candidate, SearchSettings()), -50.0 - 2.5 * std::log(3.25), 1e-12);
}

constexpr double kAlike = 0.99;

TEST(SameMap, HoldsWhereTheSameObservationsAreOfOneLandmark) {
  const Candidate map = Found(0, 3, {0, 1, 2, 0, -1});
  EXPECT_TRUE(SameMap(map, Found(0, 3, {2, 0, 1, 2, -1}), kAlike));   // other numbers
  EXPECT_FALSE(SameMap(map, Found(0, 4, {0, 1, 2, 3, -1}), kAlike));  // one landmark twice
  EXPECT_FALSE(SameMap(map, Found(0, 2, {0, 1, 1, 0, -1}), kAlike));  // two landmarks in one
  EXPECT_FALSE(SameMap(map, Found(0, 3, {0, 1, 2, 1, -1}), kAlike));  // another one seen again
}

TEST(SameMap, OneObservationInAHundredMayDiffer) {
  std::vector<std::int32_t> of(200);
  for (std::size_t k = 0; k < of.size(); ++k) of[k] = static_cast<std::int32_t>(k % 10);
  std::vector<std::int32_t> two = of, three = of;
  two[0] = two[50] = 7;
  three[0] = three[50] = three[100] = 7;
  EXPECT_TRUE(SameMap(Found(0, 10, of), Found(0, 10, two), kAlike));
  EXPECT_FALSE(SameMap(Found(0, 10, of), Found(0, 10, three), kAlike));
}

TEST(Choose, TakesTheBestScoreAndSaysHowFarAheadOfAnotherMapItIsAndHowManyStartsFoundIt) {
  const std::vector<std::int32_t> two = {0, 1, 0, 1}, three = {0, 1, 2, 1};
  const Choice choice = Choose({Found(-60, 2, two),              // -78
                                Found(-52, 3, three),            // -79
                                Found(-50, 2, {1, 0, 1, 0}),     // -68: the best
                                Found(-45, 3, three),            // -72: the next different one
                                RefitOf(2, Found(-51, 2, two)),  // counts as no start
                                Failed("impossible")},
                               SearchSettings());
  EXPECT_EQ(choice.best, 2);
  ASSERT_TRUE(choice.lead_nats.has_value());
  EXPECT_NEAR(*choice.lead_nats, 4.0, 1e-12);
  EXPECT_EQ(choice.support, 2);
  EXPECT_EQ(choice.starts, 5);
}

TEST(Choose, OfEqualsTheFirstAndNoLeadWhereAllFoundTheSameMap) {
  const Choice choice = Choose({Found(-50, 2, {0, 1, 1}), Found(-50, 2, {1, 0, 0})}, SearchSettings());
  EXPECT_EQ(choice.best, 0);
  EXPECT_FALSE(choice.lead_nats.has_value());
  EXPECT_EQ(choice.support, 2);
}

TEST(Choose, StartsThatAreAllImpossibleSayWhy) {
  try {
    Choose({Failed("step 3: impossible"), Failed("step 4: impossible")}, SearchSettings());
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "step 3: impossible");
  }
}

// Neighbouring starts lie a standard deviation apart.
TEST(ProposalsAround, AreDriftsBetweenThoseTriedAndBeyondThemAndRefitsWithoutTheLeastSeen) {
  Landmark rare = At(10, 0);
  rare.count = 0.9;
  std::vector<Candidate> candidates;
  for (const double drift : {-0.02, -0.01, 0.0, 0.01, 0.02}) {
    candidates.push_back(Found(-60, 3, {}, drift));
    candidates.back().start.prefix = 0.5;
    candidates.back().landmarks[1] = rare;
  }
  const std::vector<Proposal> inside = ProposalsAround(candidates, 2, SearchSettings());
  ASSERT_EQ(inside.size(), 5U);
  EXPECT_NEAR(inside[0].start.drift_rad_per_m, -0.005, 1e-15);
  EXPECT_NEAR(inside[1].start.drift_rad_per_m, 0.005, 1e-15);
  EXPECT_EQ(inside[1].start.prefix, 0.5);
  EXPECT_FALSE(inside[1].without.has_value());
  EXPECT_EQ(inside[2].without, 1U);
  EXPECT_EQ(inside[3].without, 0U);
  const std::vector<Proposal> edge = ProposalsAround(candidates, 4, SearchSettings());
  ASSERT_EQ(edge.size(), 6U);
  EXPECT_NEAR(edge[2].start.drift_rad_per_m, 0.03, 1e-15);
}

// Of 10 starts, whose drifts lie a standard deviation apart and reach to two on either side: beyond those
// three and four, each with both prefixes.
TEST(ProposalsBeyond, AreDriftsUpToTwiceAsFarOnEitherSideForEachOfTwoPrefixes) {
  Settings settings = SearchSettings();
  settings.starts = 10;
  settings.growth_start = 0.5;
  std::vector<Candidate> candidates;
  for (const double drift : {-0.02, 0.0, 0.02}) candidates.push_back(Found(-60, 3, {}, drift));
  const std::vector<Proposal> beyond = ProposalsBeyond(candidates, settings, 5.0);
  const std::vector<std::pair<double, double>> expected = {{-0.03, 0.5}, {0.03, 0.5},  {-0.03, 0.2},
                                                           {0.03, 0.2},  {-0.04, 0.5}, {0.04, 0.5},
                                                           {-0.04, 0.2}, {0.04, 0.2}};
  ASSERT_EQ(beyond.size(), expected.size());
  for (std::size_t k = 0; k < beyond.size(); ++k) {
    EXPECT_NEAR(beyond[k].start.drift_rad_per_m, expected[k].first, 1e-12);
    EXPECT_NEAR(beyond[k].start.prefix, expected[k].second, 1e-12);
    EXPECT_FALSE(beyond[k].without.has_value());
  }
  candidates.push_back(Found(-60, 3, {}, 0.07));
  EXPECT_EQ(ProposalsBeyond(candidates, settings, 5.0).size(), 4U) << "no further than 0.08";
  candidates.pop_back();
  EXPECT_EQ(ProposalsBeyond(candidates, settings, 21.0).size(), 4U) << "0.04 * 21 is above pi / 4";
  settings.noise.heading_drift_rad_per_m = 0.0;
  EXPECT_TRUE(ProposalsBeyond(candidates, settings, 5.0).empty()) << "odometry that does not drift";
}

TEST(ProposalsAtOnce, AreOfAllDataWithDriftsFourTimesAsNearUnlessStartsBeganWithMoreOrItWasTried) {
  Settings settings = SearchSettings();
  settings.growth_start = 0.05;
  std::vector<Candidate> candidates{Found(-60, 3, {}, 0.02)};
  candidates[0].start.prefix = 0.05;
  const std::vector<Proposal> at_once = ProposalsAtOnce(candidates, settings);
  ASSERT_EQ(at_once.size(), 9U);
  for (std::size_t k = 0; k < at_once.size(); ++k) {
    EXPECT_NEAR(at_once[k].start.drift_rad_per_m, 0.0025 * (static_cast<double>(k) - 4.0), 1e-12);
    EXPECT_EQ(at_once[k].start.prefix, 1.0);
    EXPECT_FALSE(at_once[k].without.has_value());
  }
  candidates.push_back(Found(-60, 3, {}, 0.01));
  EXPECT_TRUE(ProposalsAtOnce(candidates, settings).empty()) << "tried";
  candidates.pop_back();
  settings.growth_start = 0.5;
  EXPECT_TRUE(ProposalsAtOnce(candidates, settings).empty()) << "starts began with half of the data";
}

TEST(LooksOpen, WhereNoMoreThanHalfOfTheLandmarksAreSeenAgain) {
  EXPECT_TRUE(LooksOpen(Found(-60, 6, {0, 1, 2, 0, 1, 2, 2, 3, 4, 5, 3, 4, 5})));
  EXPECT_FALSE(LooksOpen(Found(-60, 3, {0, 1, 2, 0, 1, 2, 0, 1, 2})));
}

BlobPtr SearchedMap(const Blob& log, const Options& options) {
  return RunInProcess(LandmarkMap(options), {{"log", std::make_shared<const Blob>(log)}});
}

// Odometry that drifts by 46 degrees a lap, five times what its noise parameter says: from where odometry is
// EM takes corners of one lap for new ones in the next.
TEST(Search, FindsTheCornersWhereOneStartDoesNot) {
  Blob log = SquareLog{.laps = 3, .side_m = 20.0, .drift_rad_per_m = 0.01}.Make();
  log.PutScalar<double>("noise/heading_drift_rad_per_m", 0.002);
  EXPECT_NE(SearchedMap(log, {.cell_m = 1.0, .starts = 1})->Get<double>("map/landmark_x_m").size(), 4U);
  const BlobPtr found = SearchedMap(log, {.cell_m = 1.0, .starts = 10});
  EXPECT_EQ(found->Get<double>("map/landmark_x_m").size(), 4U);
  const auto landmarks = found->Get<std::int32_t>("search/landmarks");
  ASSERT_GT(landmarks.size(), 10U) << "candidates around the best follow the ten";
  EXPECT_EQ(landmarks[static_cast<std::size_t>(found->Scalar<std::int32_t>("search/best"))], 4);
  EXPECT_GT(found->Scalar<double>("search/lead_nats"), 0.0);
}

// With a drift of -0.02 rad/m, more than three nominal standard deviations, a square is nearly a triangle: it
// has the better likelihood for its landmarks.
TEST(Search, ADriftFarOutsideItsPriorMustPay) {
  Blob log = SquareLog{.laps = 3, .side_m = 20.0, .drift_rad_per_m = 0.006}.Make();
  log.PutScalar<double>("noise/heading_drift_rad_per_m", 0.006);
  const BlobPtr found = SearchedMap(log, {.cell_m = 1.0, .starts = 10});
  EXPECT_EQ(found->Get<double>("map/landmark_x_m").size(), 4U);
  const auto landmarks = found->Get<std::int32_t>("search/landmarks");
  const auto score = found->Get<double>("search/score_nats"),
             drift = found->Get<double>("search/drift_rad_per_m");
  const auto unpaid = [&](std::size_t k) {
    return score[k] + 2.5 * std::log1p(drift[k] * drift[k] / (4.0 * 0.006 * 0.006));
  };
  const auto best = static_cast<std::size_t>(found->Scalar<std::int32_t>("search/best"));
  const auto triangle = static_cast<std::size_t>(std::ranges::find(landmarks, 3) - landmarks.begin());
  ASSERT_LT(triangle, landmarks.size());
  EXPECT_GT(unpaid(triangle), unpaid(best));
}

// A robot that goes round among six posts that look alike and sees those near it and ahead. Its odometry
// turns by four degrees a metre too much, and the log says nothing of how it errs.
TEST(Search, SeesAtADistanceWhatOneStartDoesNotFind) {
  constexpr double kDrift_rad_per_m = 4.0 * std::numbers::pi / 180.0;
  const auto log = std::make_shared<const Blob>(PostsLog{.drift_rad_per_m = kDrift_rad_per_m}.Make());
  const BlobPtr once = SearchedMap(*log, {.starts = 1}), searched = SearchedMap(*log, {});
  EXPECT_NE(once->Get<double>("map/landmark_x_m").size(), 6U);
  EXPECT_EQ(searched->Get<double>("map/landmark_x_m").size(), 6U);
  EXPECT_GE(searched->Scalar<std::int32_t>("search/starts"), 10);
  EXPECT_NEAR(searched->Scalar<double>("robot/0/heading_drift_rad_per_m"), kDrift_rad_per_m, 0.003);
  const auto landmark = searched->Get<std::int32_t>("robot/0/observations/map_landmark");
  EXPECT_LT(std::ranges::count(landmark, -1), static_cast<std::ptrdiff_t>(landmark.size() / 20))
      << "images that EM leaves out are told apart too";
}

// Once round: most posts are behind it when it comes to the next ones.
TEST(Search, WhereALoopLooksOpenStartsHaveAllDataAtOnceToo) {
  constexpr double kDrift_rad_per_m = 5.0 * std::numbers::pi / 180.0;
  const BlobPtr found =
      SearchedMap(PostsLog{.drift_rad_per_m = kDrift_rad_per_m, .seed = 4, .times = 1}.Make(), {});
  EXPECT_EQ(found->Get<double>("map/landmark_x_m").size(), 6U);
  const auto prefix = found->Get<double>("search/start_prefix");
  const auto refit_of = found->Get<std::int32_t>("search/refit_of");
  int at_once = 0;
  for (std::size_t k = 0; k < prefix.size(); ++k) at_once += prefix[k] == 1.0 && refit_of[k] < 0;
  EXPECT_EQ(at_once, 9);
  EXPECT_EQ(found->Get<std::uint8_t>("fit/told")[0], 0) << "the log states no errors";
}

TEST(Search, AResultSaysThatEmStartedOnceWhereNoSearchConfirmsWhichLandmarkIsWhich) {
  const BlobPtr unnamed = SearchedMap(SquareLog{}.Make(), {.starts = 1});
  EXPECT_EQ(unnamed->Scalar<std::int32_t>("search/support"), 1);
  EXPECT_EQ(unnamed->Scalar<std::int32_t>("search/starts"), 1);
  EXPECT_EQ(unnamed->Text("search/why"), "as many as were asked for");
  EXPECT_FALSE(unnamed->Has("search/score_nats"));
  EXPECT_FALSE(SearchedMap(SquareLog{.identified = true}.Make(), {})->Has("search/support"));
}

TEST(Search, IsOnTheCoarseGridWhereAFineOneIsAskedFor) {
  const Blob log = SquareLog{.laps = 3, .side_m = 30.0}.Make();
  const Options options{.cell_m = 0.25, .heading_deg = 2.5};
  const std::string coarse = Resolve({}, log).ToBlob().ContentHash().Binary();
  const std::string fine = Resolve(options, log).ToBlob().ContentHash().Binary();
  std::vector<std::string> grids;  // settings of the rounds
  const BlobPtr found = RunInProcess(
      LandmarkMap(options), {{"log", std::make_shared<const Blob>(log)}}, [&](const proto::Step& step) {
        const auto& blobs = step.state().blobs();
        if (blobs.empty()) return;  // the result
        grids.push_back(blobs.contains("settings") ? blobs.at("settings") : blobs.at("start/0/settings"));
      });
  ASSERT_GT(grids.size(), 4U);
  EXPECT_EQ(grids.front(), coarse);
  EXPECT_EQ(grids.back(), fine);
  EXPECT_GT(std::ranges::count(grids, fine), 2) << "EM goes on there";
  EXPECT_EQ(found->Scalar<double>("map/grid/cell_m"), 0.25);
  EXPECT_EQ(found->Get<double>("map/landmark_x_m").size(), 4U);
}

// Turned by 46 degrees more or less at each corner, the way leaves the box; that is no reason to give up.
TEST(Search, AStartWithoutAPathIsLeftOut) {
  Blob log = SquareLog{.laps = 3, .side_m = 20.0}.Make();
  log.PutScalar<double>("noise/heading_drift_rad_per_m", 0.02);
  log.PutScalar<double>("noise/heading_walk_rad_per_sqrt_m", 0.005);
  const BlobPtr found = SearchedMap(log, {.cell_m = 1.0, .starts = 5, .drift_length_m = 0.01, .box_m = 44.0});
  EXPECT_EQ(found->Get<double>("map/landmark_x_m").size(), 4U);
  const auto score = found->Get<double>("search/score_nats");
  EXPECT_TRUE(std::isfinite(score[1]));
  EXPECT_FALSE(std::isfinite(score[0]) && std::isfinite(score[2]));
  EXPECT_EQ(found->Scalar<std::int32_t>("search/best"), 1);
}

}  // namespace
}  // namespace cairn::landmark_map
