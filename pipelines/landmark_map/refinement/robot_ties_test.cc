#include "pipelines/landmark_map/refinement/robot_ties.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <string>

#include "pipelines/landmark_map/refinement/testing.h"

namespace cairn::landmark_map {
namespace {

constexpr double kTieSigma = 0.15;
const std::vector<bool> kNameless(40, false), kNames(40, true);

std::vector<Landmark> Nameless() { return std::vector<Landmark>(40, Landmark{0, 0, {0, 0, 0, 0}, 0, 0}); }

TEST(TiesOfRobots, ThatShareARoomAreTied) {
  const auto ties = TiesOfRobots({DriveThroughRoom(1), DriveThroughRoom(1, 0, 4)}, kNameless, kTieSigma);
  ASSERT_EQ(ties.size(), 2U);
  for (const Tie& tie : ties) {
    EXPECT_EQ(tie.shared, std::int64_t{kSeenInRoom1});
    EXPECT_EQ(tie.one_sided.value(), 0);
    EXPECT_GT(tie.lead_nats.value(), kTiedNats);
  }
}

// The third one is put upon the others', whose room it never saw.
TEST(TiesOfRobots, TheOneThatDoesNotHangTogetherWithTheMostIsLoose) {
  const auto ties = TiesOfRobots({DriveThroughRoom(2, 20), DriveThroughRoom(1), DriveThroughRoom(1, 0, 4)},
                                 kNameless, kTieSigma);
  EXPECT_LT(ties[0].lead_nats.value(), 0);
  EXPECT_EQ(ties[0].shared, 0);
  EXPECT_GE(ties[0].one_sided.value(), 10);
  for (const std::size_t r : {1U, 2U}) EXPECT_GT(ties[r].lead_nats.value(), kTiedNats);
}

TEST(TiesOfRobots, NamesOfTwoLandmarksSayWhereItIs) {
  const auto ties = TiesOfRobots({DriveThroughRoom(1), DriveThroughRoom(1, 0, 4)}, kNames, kTieSigma);
  EXPECT_EQ(ties[1].shared, std::int64_t{kSeenInRoom1});
  EXPECT_FALSE(ties[1].lead_nats.has_value());
}

// The second one drives through another part of the room, where two posts that it sees have the names of two
// of the first one's.
TEST(TiesOfRobots, LandmarksWithoutNamesSayWhereNamesWereExchanged) {
  std::vector<PlacedRow> right = DriveThroughRoom(1), led = DriveThroughRoom(1, 20, 4, {3, -2, 0.7});
  std::vector<bool> named(40, false);
  const auto told = [&](std::vector<PlacedRow>* rows, std::int32_t landmark, std::int32_t as) {
    for (PlacedRow& row : *rows) {
      if (row.landmark != landmark) continue;
      row.landmark = as;
      row.told = true;
    }
    named[static_cast<std::size_t>(as)] = true;
  };
  const std::int32_t first = right.front().landmark, second = right.back().landmark;
  ASSERT_NE(first, second);
  for (const std::int32_t name : {first, second}) told(&right, name, name);
  told(&led, led.front().landmark, first);
  told(&led, led.back().landmark, second);
  const auto ties = TiesOfRobots({right, led}, named, kTieSigma);
  EXPECT_EQ(ties[1].shared, 2);
  ASSERT_TRUE(ties[1].lead_nats.has_value());
  EXPECT_LT(*ties[1].lead_nats, -kTiedNats);
}

// Of two robots that press buttons: both lie to one another as the buttons of the second lie among those of
// the first, which in a square is the same in four ways.
TEST(PutTies, OfContactDetectionsASquareSaysLittle) {
  const auto lead_nats = [](const std::vector<Point>& buttons) {
    kinds::Log log;
    std::vector<RowAssociations> rows(2);
    std::vector<Landmark> landmarks;
    for (const Point& at : buttons) landmarks.push_back({at.x_m, at.y_m, {0.01, 0, 0, 0.01}, 0, 4});
    for (RowAssociations& of : rows) {
      for (std::size_t k = 0; k < 2 * buttons.size(); ++k)
        of.landmark.push_back(static_cast<std::int32_t>(k % buttons.size()));
      of.probability.assign(of.landmark.size(), 1);
      kinds::Log::Robot& robot = log.robot.emplace_back();
      const std::vector<double> none(of.landmark.size(), std::numeric_limits<double>::quiet_NaN());
      std::vector<double> time_s(of.landmark.size());
      std::iota(time_s.begin(), time_s.end(), 0.0);
      robot.observations = {time_s, none, none, std::vector<std::int32_t>(of.landmark.size(), -1), {}};
    }
    log.robots = std::vector<std::string>{"one", "two"};
    Blob result;
    PutTies(BlobOf(log), {}, rows, landmarks, {}, &result);
    EXPECT_EQ(result.Scalar<std::int64_t>("robot/1/shared_landmarks"), std::ssize(buttons));
    return result.Scalar<double>("robot/1/place_lead_nats");
  };
  EXPECT_NEAR(lead_nats({{0, 0}, {10, 0}, {10, 10}, {0, 10}}), 0, 1);
  EXPECT_GT(lead_nats({{0, 0}, {10, 0}, {14, 9}, {-3, 16}}), 6);
}

// What a robot saw is of landmarks with names, but it gave none itself.
TEST(TiesOfRobots, NamesThatOneSideAloneGivesSayNothing) {
  std::vector<PlacedRow> untold = DriveThroughRoom(1, 0, 4);
  for (PlacedRow& row : untold) row.told = false;
  const auto ties = TiesOfRobots({DriveThroughRoom(1), untold}, kNames, kTieSigma);
  EXPECT_GT(ties[1].lead_nats.value(), kTiedNats);
}

TEST(PlacedAnew, ARobotGoesWhereItsLandmarksAgree) {
  const std::vector<PlacedRow> right = DriveThroughRoom(1);
  EXPECT_FALSE(PlacedAnew({right, DriveThroughRoom(1, 0, 4)}, Nameless(), 0, kTieSigma).has_value());
  const auto landmarks =
      PlacedAnew({right, DriveThroughRoom(1, 20, 4, {3, -2, 0.7})}, Nameless(), 0, kTieSigma);
  ASSERT_TRUE(landmarks.has_value());
  const Submap alone = SubmapOf({right});
  ASSERT_EQ(landmarks->size(), kSeenInRoom1) << "what both have seen is one";
  for (std::size_t l = 0; l < kSeenInRoom1; ++l) {
    EXPECT_NEAR((*landmarks)[l].x_m, alone.landmarks[l].x_m, 0.1);
    EXPECT_NEAR((*landmarks)[l].y_m, alone.landmarks[l].y_m, 0.1);
  }
}

TEST(PlacedAnew, ARobotOfAnotherRoomHasNoPlaceToGo) {
  EXPECT_FALSE(
      PlacedAnew({DriveThroughRoom(1), DriveThroughRoom(2, 20)}, Nameless(), 0, kTieSigma).has_value());
}

TEST(TieAcross, TellsWhetherWhatIsSeenAfterIsWhatWasSeenBefore) {
  std::vector<PlacedRow> rows = DriveThroughRoom(1);
  const OdometryHole hole{.begin_s = rows.back().time_s + 1, .length_s = 20};
  const auto then = [&](const std::vector<PlacedRow>& more) {
    std::vector<PlacedRow> all = rows;
    for (PlacedRow row : more) {
      row.time_s += hole.begin_s + hole.length_s;
      all.push_back(row);
    }
    return TieAcross(hole.begin_s + 0.5 * hole.length_s, all, kNameless, kTieSigma);
  };
  EXPECT_GT(then(DriveThroughRoom(1, 0, 4)).lead_nats.value(), kTiedNats);
  EXPECT_LT(then(DriveThroughRoom(2, 20)).lead_nats.value(), 0);
}

}  // namespace
}  // namespace cairn::landmark_map
