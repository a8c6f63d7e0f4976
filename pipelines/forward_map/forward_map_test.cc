#include "pipelines/forward_map/forward_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pipelines/forward_map/result.h"
#include "pipelines/forward_map/state.h"
#include "pipelines/forward_map/testing.h"
#include "pipelines/forward_map/weigh.h"
#include "pipelines/testing/in_process.h"

namespace cairn::forward_map {
namespace {

BlobPtr MapOf(const Blob& log, const Options& options) {
  return RunInProcess(ForwardMap(options, 1), {{"log", std::make_shared<const Blob>(log)}});
}

Options At(double cell_m) {
  Options options;
  options.grid.cell_m = cell_m;
  return options;
}

GridBox BoxOf(const Blob& result) {
  const Shape& shape = result.at("map/grid/occupied").shape();
  return {result.Scalar<double>("map/grid/origin_x_m"), result.Scalar<double>("map/grid/origin_y_m"),
          result.Scalar<double>("map/grid/cell_m"), shape[1], shape[0]};
}

// An occupied cell within `within_m` of a place.
bool Occupied(const Blob& result, double x_m, double y_m, double within_m) {
  const GridBox box = BoxOf(result);
  const auto occupied = result.Get<std::uint8_t>("map/grid/occupied");
  for (std::size_t cell = 0; cell < occupied.size(); ++cell) {
    const auto at = static_cast<std::int64_t>(cell);
    const double dx = box.CentreX(at % box.columns) - x_m, dy = box.CentreY(at / box.columns) - y_m;
    if (occupied[cell] != 0 && std::hypot(dx, dy) <= within_m) return true;
  }
  return false;
}

// Of the cells of the room's inside, 0.3 m from all walls, those that are held to be occupied.
int FalseObstacles(const Blob& result, const Room& room) {
  const GridBox box = BoxOf(result);
  const auto occupied = result.Get<std::uint8_t>("map/grid/occupied");
  int count = 0;
  for (std::size_t cell = 0; cell < occupied.size(); ++cell) {
    const auto at = static_cast<std::int64_t>(cell);
    const double x = box.CentreX(at % box.columns), y = box.CentreY(at / box.columns);
    const bool inside = x > 0.3 && x < room.width_m - 0.3 && y > 0.3 && y < room.depth_m - 0.3;
    const bool box_of_room = x > 1.7 && x < 3.3 && y > 1.7 && y < 3.3;
    count += inside && !box_of_room ? occupied[cell] : 0;
  }
  return count;
}

TEST(ForwardMap, FindsTheWallsOfARoomByRaysAndByCones) {
  for (const double opening_rad : {0.0, 0.26}) {
    const Room room{.scans = 60, .beams = 36, .opening_rad = opening_rad};
    const BlobPtr result = MapOf(room.Log(), At(0.1));
    int walls = 0;
    for (double along = 0.5; along < 5; along += 0.5) {
      walls += Occupied(*result, along, 0, 0.16) ? 1 : 0;
      walls += Occupied(*result, along, room.depth_m, 0.16) ? 1 : 0;
    }
    EXPECT_GE(walls, 17) << opening_rad;  // of 18
    EXPECT_TRUE(Occupied(*result, 2.5, 2, 0.15)) << opening_rad;
    EXPECT_LE(FalseObstacles(*result, room), 20) << opening_rad;
  }
}

// The promise of EM, here of every round: maps and parameters are taken over only where they gain.
TEST(ForwardMap, TheTargetNeverFalls) {
  Options options = At(0.1);
  options.tile_mcrossings = 0.01;
  options.smoothness = 0.2;
  options.prior = 0.2;
  const BlobPtr result = MapOf(Room{.random_share = 0.1}.Log(), options);
  const auto target = result->Get<double>("history/target");
  ASSERT_GT(target.size(), 5U);
  for (std::size_t i = 1; i < target.size(); ++i) EXPECT_GT(target[i], target[i - 1]);
}

TEST(ForwardMap, ShowsItsMapAsItComesIntoBeing) {
  const auto log = std::make_shared<const Blob>(Room{}.Log());
  const ForwardMap pipeline(At(0.1), 1);
  const std::vector<BlobPtr> maps = MapsSoFar(pipeline, {{"log", log}});
  ASSERT_GT(maps.size(), 1U);
  const auto count = [](const Blob& map, const char* name) {
    const auto occupied = map.Get<std::uint8_t>(name);
    return std::ranges::count(occupied, 1);
  };
  EXPECT_EQ(count(*maps.front(), "so_far/map/grid/occupied"), 0) << "it begins with nothing";
  const BlobPtr result = RunInProcess(pipeline, {{"log", log}});
  EXPECT_EQ(count(*maps.back(), "so_far/map/grid/occupied"), count(*result, "map/grid/occupied"));
  EXPECT_EQ(maps.back()->Scalar<double>("so_far/map/grid/cell_m"), 0.1);
}

// Each of its maps comes of the one before by the cells that changed, the first of an empty one.
TEST(ForwardMap, ItsHistoryHasEachMapThatItTookOver) {
  const auto log = std::make_shared<const Blob>(Room{}.Log());
  const ForwardMap pipeline(At(0.1), 1);
  const std::vector<BlobPtr> maps = MapsSoFar(pipeline, {{"log", log}});
  const BlobPtr result = RunInProcess(pipeline, {{"log", log}});
  const auto iteration = result->Get<std::int64_t>("history/changed_iteration"),
             cell = result->Get<std::int64_t>("history/changed_cell"),
             occupied = result->Get<std::int64_t>("history/occupied");
  ASSERT_EQ(maps.size(), occupied.size());
  std::vector<std::uint8_t> map(static_cast<std::size_t>(result->at("map/grid/occupied").size()));
  std::size_t next = 0;
  for (std::size_t i = 0; i < occupied.size(); ++i) {
    for (; next < iteration.size() && iteration[next] == static_cast<std::int64_t>(i); ++next)
      map[static_cast<std::size_t>(cell[next])] ^= 1;
    const auto shown = maps[i]->Get<std::uint8_t>("so_far/map/grid/occupied");
    EXPECT_EQ(map, std::vector<std::uint8_t>(shown.begin(), shown.end())) << i;
    EXPECT_EQ(std::ranges::count(map, 1), occupied[i]);
  }
  EXPECT_EQ(next, iteration.size());
  EXPECT_GT(next, 0U);
}

// By the model as it is written in forward_model.h, on the map and with the parameters of the result.
TEST(ForwardMap, ItsLogLikelihoodIsThatOfItsMap) {
  const Room room{.opening_rad = 0.26};
  const BlobPtr result = MapOf(room.Log(), At(0.1));
  const std::string name = "robot/0/sonar/";
  const SensorModel model{
      result->Scalar<double>(name + "p_hit"),           result->Scalar<double>(name + "p_rand"),
      result->Scalar<double>(name + "p_lost"),          result->Scalar<double>(name + "sigma_m"),
      result->Scalar<double>(name + "no_echo_sigma_m"), result->Scalar<double>(name + "z_max_m")};
  const std::vector<RangeScans> sensors = SensorsOf(room);
  NoProgress progress;
  const Evidence evidence = Weigh(sensors[0], 0, sensors[0].scans(), BoxOf(*result),
                                  result->Get<std::uint8_t>("map/grid/occupied"), model, true, progress);
  const auto log_likelihood = result->Get<double>("history/log_likelihood");
  const auto expected = result->Get<double>("history/expected_log_likelihood");
  EXPECT_NEAR(log_likelihood.back(), evidence.log_likelihood, 1e-9 * std::abs(evidence.log_likelihood));
  EXPECT_NEAR(expected.back(), evidence.log_likelihood - evidence.entropy,
              1e-9 * std::abs(evidence.log_likelihood));
}

// Section 3.4: where the search has ended, the difference has the sign of the cell's state, and its logistic
// is the cell's probability. Cells that no reading tells of have none.
TEST(ForwardMap, TheDifferenceAgreesWithTheMap) {
  const BlobPtr result = MapOf(Room{}.Log(), At(0.1));
  const auto difference = result->Get<double>("map/grid/log_odds_difference");
  const auto probability = result->Get<double>("map/grid/probability");
  const auto occupied = result->Get<std::uint8_t>("map/grid/occupied");
  int seen = 0, unseen = 0, against = 0;
  for (std::size_t cell = 0; cell < occupied.size(); ++cell) {
    if (std::isnan(difference[cell])) {
      EXPECT_TRUE(std::isnan(probability[cell]));
      EXPECT_EQ(occupied[cell], 0);
      ++unseen;
      continue;
    }
    ++seen;
    EXPECT_NEAR(probability[cell], 1 / (1 + std::exp(-difference[cell])), 1e-12);
    against += (difference[cell] > 0) != (occupied[cell] != 0) && std::abs(difference[cell]) > 0.01 ? 1 : 0;
  }
  EXPECT_GT(seen, 1000);
  EXPECT_GT(unseen, 100);
  EXPECT_EQ(against, 0);
  EXPECT_EQ(ProbabilityOf(0, 0.2), 0.2);
}

TEST(ForwardMap, OfRobotsWithoutACommonFrameItTakesOne) {
  const Room room, other{.width_m = 9, .seed = 2};
  const Blob log = LogOfTwoRovers(room, other), paths = LocalPathsOf(log);
  const auto map = [&](const std::string& robots) {
    Options options = At(0.1);
    options.grid.robots = robots;
    return RunInProcess(ForwardMap(options, 1), {{"log", std::make_shared<const Blob>(log)},
                                                 {"poses", std::make_shared<const Blob>(paths)}});
  };
  ExpectTwoFramesAreRefused(map);
  const BlobPtr chosen = map("rover"), alone = MapOf(room.Log(), At(0.1));
  for (const auto& [name, array] : alone->fields()) {
    if (name != "robots" && name != "log_hash") {
      EXPECT_TRUE(chosen->at(name) == array) << name;
    }
  }
  EXPECT_FALSE(chosen->Has("robot/1/laser/time_s"));
}

TEST(ForwardMap, ManyTilesEndAsHighAsOne) {
  const Blob log = Room{}.Log();
  Options tiles = At(0.1);
  tiles.tile_mcrossings = 0.01;
  int cut = 0;
  const BlobPtr many = RunInProcess(ForwardMap(tiles, 1), {{"log", std::make_shared<const Blob>(log)}},
                                    [&](const proto::Step& step) { cut = std::max(cut, step.tasks_size()); });
  EXPECT_GE(cut, 4);
  const double one = MapOf(log, At(0.1))->Get<double>("history/log_likelihood").back();
  EXPECT_NEAR(many->Get<double>("history/log_likelihood").back(), one, 0.01 * std::abs(one));
}

// Where the searches that are allowed were not enough the result says so, and the note.
TEST(ForwardMap, SaysThatItWasCutShort) {
  const Blob log = Room{}.Log();
  for (const bool estimate : {true, false}) {
    for (const std::int64_t rounds : {1, 12}) {
      Options options = At(0.1);
      options.estimate = estimate;
      options.rounds = rounds;
      std::string note;
      const BlobPtr result =
          RunInProcess(ForwardMap(options, 1), {{"log", std::make_shared<const Blob>(log)}},
                       [&](const proto::Step& step) { note = step.note(); });
      EXPECT_EQ(result->Scalar<std::uint8_t>("search/cut_short"), rounds == 1 ? 1 : 0);
      EXPECT_EQ(note.find("cut short after 1 searches") != std::string::npos, rounds == 1) << note;
      EXPECT_LE(result->Scalar<std::int64_t>("search/searches"), rounds);
    }
  }
}

// Cells are 0.1 m, so that a range is off by a quarter of one even where the sensor is exact.
TEST(ForwardMap, EstimatesWhatTheSensorIsLike) {
  for (const double random_share : {0.02, 0.15}) {
    const Room room{.scans = 80, .beams = 36, .sigma_m = 0.03, .random_share = random_share};
    Options options = At(0.1);
    options.prior = 0.05;
    const BlobPtr result = MapOf(room.Log(), options);
    EXPECT_NEAR(result->Scalar<double>("robot/0/laser/p_rand"), random_share, 0.35 * random_share + 0.005);
    EXPECT_NEAR(result->Scalar<double>("robot/0/laser/sigma_m"), 0.04, 0.015);
    EXPECT_GT(result->Scalar<double>("robot/0/laser/p_hit"), 0.6);
  }
  Options given = At(0.1);
  given.estimate = false;
  given.p_hit = 0.55;
  given.sigma_m = 0.06;
  const BlobPtr result = MapOf(Room{}.Log(), given);
  EXPECT_EQ(result->Scalar<double>("robot/0/laser/p_hit"), 0.55);
  EXPECT_EQ(result->Scalar<double>("robot/0/laser/sigma_m"), 0.06);
}

// Figures 4 and 5: somebody stands in the room for a while.
TEST(ForwardMap, MarksWhoCameAndWent) {
  for (const int until : {0, 10}) {
    const Room room{.scans = 80, .beams = 72, .random_share = 0, .person_from = 0, .person_until = until};
    const BlobPtr result = MapOf(room.Log(), At(0.1));
    const GridBox box = BoxOf(*result);
    const auto dynamic = result->Get<std::uint8_t>("map/grid/dynamic");
    int near_person = 0, elsewhere = 0;
    for (std::size_t cell = 0; cell < dynamic.size(); ++cell) {
      const auto at = static_cast<std::int64_t>(cell);
      const double dx = box.CentreX(at % box.columns) - 4.5, dy = box.CentreY(at / box.columns) - 1;
      (std::hypot(dx, dy) < 0.4 ? near_person : elsewhere) += dynamic[cell] != kStays ? 1 : 0;
    }
    if (until > 0) {
      EXPECT_GE(near_person, 3);
    } else {
      EXPECT_EQ(near_person, 0);
    }
    EXPECT_LE(elsewhere, 5);
  }
}

// A cone that met somebody for a moment says so of its arc; without anybody there is nothing to say.
TEST(ForwardMap, MarksTheArcsOnWhichSomebodyPassedASonar) {
  for (const int until : {0, 3}) {
    const Room room{.scans = 120,
                    .beams = 36,
                    .opening_rad = 0.26,
                    .random_share = 0,
                    .person_from = 0,
                    .person_until = until};
    const BlobPtr result = MapOf(room.Log(), At(0.1));
    const GridBox box = BoxOf(*result);
    const auto dynamic = result->Get<std::uint8_t>("map/grid/dynamic");
    int near_person = 0, elsewhere = 0;
    for (std::size_t cell = 0; cell < dynamic.size(); ++cell) {
      const auto at = static_cast<std::int64_t>(cell);
      const double dx = box.CentreX(at % box.columns) - 4.5, dy = box.CentreY(at / box.columns) - 1;
      (std::hypot(dx, dy) < 0.5 ? near_person : elsewhere) += dynamic[cell] == kPassed ? 1 : 0;
    }
    EXPECT_EQ(near_person >= 5, until > 0) << near_person;
    EXPECT_LE(elsewhere, 3);
  }
}

TEST(ForwardMap, SaysWhatExplainsEachReading) {
  Options options = At(0.1);
  options.grid.heldout = 0.2;
  const Room room{.scans = 50};
  const BlobPtr result = MapOf(room.Log(), options);
  const auto cause = result->Get<std::int32_t>("robot/0/laser/cause");
  const auto held_out = result->Get<std::uint8_t>("robot/0/laser/held_out");
  const auto occupied = result->Get<std::uint8_t>("map/grid/occupied");
  const Blob log = room.Log();
  const auto range = log.Get<double>("robot/0/laser/range_m");
  ASSERT_EQ(cause.size(), range.size());
  int explained = 0, not_used = 0, no_echo = 0;
  for (std::size_t i = 0; i < cause.size(); ++i) {
    EXPECT_EQ(cause[i] == kNotUsed, held_out[i / static_cast<std::size_t>(room.beams)] != 0);
    not_used += cause[i] == kNotUsed ? 1 : 0;
    no_echo += cause[i] == kNoEchoCause ? 1 : 0;
    if (cause[i] < 0) continue;
    ++explained;
    EXPECT_EQ(occupied[static_cast<std::size_t>(cause[i])], 1);
  }
  EXPECT_EQ(not_used, 10 * room.beams);
  EXPECT_GT(explained, 800);
  EXPECT_GT(no_echo, 20);
}

// Nothing in reach: no obstacles, and all that the beams crossed is free.
// In place of a second search: each cell as the other readings have it, all others as in the map.
TEST(ForwardMap, IsCheckedAlmostAsAMapThatIsMadeWithoutThoseReadings) {
  Options options = At(0.1);
  options.grid.box_m = "-1,-1,7,6";
  for (const double opening_rad : {0.0, 0.26}) {
    const Room room{.scans = 200, .opening_rad = opening_rad};
    options.grid.heldout = 0;
    const BlobPtr whole = MapOf(room.Log(), options);
    options.grid.heldout = 0.1;
    const BlobPtr without = MapOf(room.Log(), options);
    EXPECT_EQ(whole->Scalar<std::int64_t>("fit/checked_readings"), 20 * room.beams);
    EXPECT_NEAR(whole->Scalar<double>("fit/checked_nats"), without->Scalar<double>("fit/checked_nats"), 0.15);
    EXPECT_GT(whole->Scalar<double>("fit/checked_nats"), whole->Scalar<double>("fit/ignorant_nats") + 0.5);
  }
}

TEST(ForwardMap, OfReadingsWithoutEchoIsFree) {
  const BlobPtr result = MapOf(Room{.max_range_m = 0.3, .random_share = 0}.Log(), At(0.1));
  int free = 0;
  for (const double p : result->Get<double>("map/grid/probability")) free += p < 0.5 ? 1 : 0;
  EXPECT_GT(free, 100);
  for (const std::uint8_t cell : result->Get<std::uint8_t>("map/grid/occupied")) EXPECT_EQ(cell, 0);
  for (const std::int32_t cause : result->Get<std::int32_t>("robot/0/laser/cause"))
    EXPECT_EQ(cause, kNoEchoCause);
}

// They say nothing where they are not used: no reading is left, and nothing is known.
TEST(ForwardMap, OfNoReadingsKnowsNothing) {
  Options options = At(0.1);
  options.no_echo = false;
  const BlobPtr result = MapOf(Room{.max_range_m = 0.3, .random_share = 0}.Log(), options);
  const auto probability = result->Get<double>("map/grid/probability");
  ASSERT_GT(probability.size(), 100U);
  for (const double p : probability) EXPECT_TRUE(std::isnan(p));
}

// A box that leaves out two walls: the readings that end behind it say that the way there is free.
TEST(ForwardMap, OfReadingsThatEndBeyondTheBoxTheWayInsideIsFree) {
  for (const double opening_rad : {0.0, 0.26}) {
    const Room room{.scans = 60, .beams = 72, .opening_rad = opening_rad, .random_share = 0};
    Options options = At(0.1);
    options.grid.box_m = "-0.5,-0.5,5.5,4.5";
    const BlobPtr result = MapOf(room.Log(), options);
    const GridBox box = BoxOf(*result);
    const auto probability = result->Get<double>("map/grid/probability");
    int at_border = 0;
    for (double y = 0.55; y < 4; y += 0.1) {
      const auto cell = static_cast<std::size_t>(box.RowOf(y) * box.columns + box.ColumnOf(5.45));
      EXPECT_LT(probability[cell], 0.05) << opening_rad << ", " << y;
      ++at_border;
    }
    EXPECT_GT(at_border, 30);
    int beyond = 0, random = 0;
    const std::string cause = opening_rad > 0 ? "robot/0/sonar/cause" : "robot/0/laser/cause";
    for (const std::int32_t of : result->Get<std::int32_t>(cause)) {
      beyond += of == kBeyondCause ? 1 : 0;
      random += of == kRandomCause ? 1 : 0;
    }
    EXPECT_GT(beyond, 500);
    EXPECT_LT(random, 50);
  }
}

// Two robots with a sensor each, another kind each: one map, parameters of their own.
TEST(ForwardMap, PutsSeveralRobotsAndSensorsIntoOneMap) {
  Blob log = Room{}.Log();
  log.Put("robots", Array::Texts({"rover", "dog"}));
  const Blob second = Room{.opening_rad = 0.26, .sigma_m = 0.05, .seed = 2}.Log();
  for (const auto& [name, array] : second.fields()) {
    if (name.starts_with("robot/0/")) log.Put("robot/1/" + name.substr(8), array);
  }
  const BlobPtr result = MapOf(log, At(0.1));
  EXPECT_TRUE(result->Has("robot/0/laser/cause"));
  EXPECT_TRUE(result->Has("robot/1/sonar/cause"));
  EXPECT_NE(result->Scalar<double>("robot/0/laser/sigma_m"), result->Scalar<double>("robot/1/sonar/sigma_m"));
  Options laser = At(0.1);
  laser.grid.sensors = "laser";
  EXPECT_FALSE(MapOf(log, laser)->Has("robot/1/sonar/cause"));
}

std::string Complaint(const Blob& log, const Options& options) {
  try {
    ForwardMap(options, 1).Start(MapInputs({{"log", std::make_shared<const Blob>(log)}}));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ForwardMap, SaysWhatIsWrongWithItsInput) {
  const Blob log = Room{}.Log();
  EXPECT_EQ(Complaint(log, At(0.1)), "");
  Options small = At(0.1);
  small.grid.box_m = "0,0,2,2";
  EXPECT_NE(Complaint(log, small).find("the box is too small for the trajectory"), std::string::npos);
  Options fine = At(0.001);
  fine.grid.memory_mb = 500;
  EXPECT_NE(Complaint(log, fine).find("memory_mb allows"), std::string::npos);
  Options greedy = At(0.1);
  greedy.tile_mcrossings = 1000;
  EXPECT_EQ(Complaint(log, greedy),
            "a task of tile_mcrossings = 1000 million takes 30517 MiB, and memory_mb allows 2048");
  Options failing = At(0.1);
  failing.p_rand = 0.7;
  failing.p_lost = 0.4;
  EXPECT_EQ(Complaint(log, failing), "p_rand = 0.7 and p_lost = 0.4 together are more than 0.95");
  Blob bad = log;
  std::vector<double> range(log.Get<double>("robot/0/laser/range_m").begin(),
                            log.Get<double>("robot/0/laser/range_m").end());
  range[3] = -1;
  bad.Put("robot/0/laser/range_m", Array::Of<double>(log.at("robot/0/laser/range_m").shape(), range));
  EXPECT_NE(Complaint(bad, At(0.1)).find("negative"), std::string::npos);
  EXPECT_NE(Complaint(log.Without("robot/0/laser/"), At(0.1)).find("no range scans"), std::string::npos);
}

}  // namespace
}  // namespace cairn::forward_map
