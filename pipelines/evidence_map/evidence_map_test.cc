#include "pipelines/evidence_map/evidence_map.h"

#include <gtest/gtest.h>

#include "pipelines/common/testing_room.h"
#include "pipelines/evidence_map/log_odds.h"
#include "pipelines/evidence_map/ray_counts.h"
#include "pipelines/evidence_map/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::evidence_map {
namespace {

struct Outcome {
  BlobPtr result;
  int looks = 0, tasks = 0;  // of the first round, and of the second
};

Outcome Map(const Room& room, const Options& options, const Blob* poses = nullptr) {
  std::map<std::string, BlobPtr> inputs{{"log", std::make_shared<const Blob>(room.Log())}};
  if (poses != nullptr) inputs["poses"] = std::make_shared<const Blob>(*poses);
  Outcome outcome;
  outcome.result = RunInProcess(EvidenceMap(options, 7), inputs, [&](const proto::Step& step) {
    if (step.tasks_size() == 0) return;
    (step.tasks(0).kind() == "look" ? outcome.looks : outcome.tasks) = step.tasks_size();
  });
  return outcome;
}

// The probability of the cell that holds (x, y).
double At(const Blob& result, double x, double y) {
  const double cell_m = result.Scalar<double>("map/grid/cell_m");
  const auto i = static_cast<std::int64_t>((x - result.Scalar<double>("map/grid/origin_x_m")) / cell_m);
  const auto j = static_cast<std::int64_t>((y - result.Scalar<double>("map/grid/origin_y_m")) / cell_m);
  const std::int64_t columns = result.at("map/grid/probability").shape()[1];
  return result.Get<double>("map/grid/probability")[static_cast<std::size_t>(j * columns + i)];
}

TEST(EvidenceMap, OfARoomShowsItsWallsAndTheFloorAndNothingBehindThem) {
  for (const double opening_rad : {0.0, 0.26}) {
    Options options;
    options.grid.cell_m = 0.1;
    const Room exact{.beams = 72, .opening_rad = opening_rad, .sigma_m = 0, .random_share = 0};
    const Outcome outcome = Map(exact, options);
    EXPECT_LT(At(*outcome.result, 4.05, 2.55), 0.1) << opening_rad;
    EXPECT_GT(At(*outcome.result, 6.05, 2.55), 0.9) << opening_rad;
    EXPECT_GT(At(*outcome.result, 4.05, 5.05), 0.9) << opening_rad;
    EXPECT_TRUE(std::isnan(At(*outcome.result, 6.35, 5.35))) << opening_rad;
  }
}

TEST(EvidenceMap, ItsLogOddsAreThoseOfItsProbability) {
  const Outcome outcome = Map({}, {});
  const auto p = outcome.result->Get<double>("map/grid/probability");
  const auto l = outcome.result->Get<float>("map/grid/log_odds");
  std::size_t told = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    ASSERT_EQ(std::isnan(p[k]), std::isnan(l[k]));
    if (std::isnan(p[k])) continue;
    ++told;
    EXPECT_NEAR(std::log(p[k] / (1 - p[k])), l[k], 1e-5 * std::max(1.0F, std::exp(std::abs(l[k]) - 10)));
  }
  EXPECT_GT(told, 4000U);
}

TEST(EvidenceMap, OfManySlicesIsThatOfAllScansAtOnce) {
  Options options;
  options.grid.cell_m = 0.01;  // so that there are several
  const Room room{.scans = 1300, .beams = 180};
  const Outcome sliced = Map(room, options);
  EXPECT_GT(sliced.tasks, 3);
  const PosedScans scans = ReadRangeScans(room.Log(), nullptr, options.grid);
  const GridBox grid = GridOf(scans, options.grid, 1);
  const auto cells = static_cast<std::size_t>(grid.cells());
  Untroubled progress;
  Totals totals{std::vector<std::int64_t>(cells), std::vector<std::int64_t>(cells)};
  AddTo(grid, ToBlob(CountRays(scans.sensors[0], grid, true, progress)), &totals);
  const auto at_once = LogOddsOf({{&totals, options.laser, 1}}, cells, options.prior, options.clamp_nats);
  const auto log_odds = sliced.result->Get<float>("map/grid/log_odds");
  ASSERT_EQ(log_odds.size(), cells);
  for (std::size_t k = 0; k < cells; ++k) {
    ASSERT_TRUE(log_odds[k] == static_cast<float>(at_once[k]) || std::isnan(at_once[k])) << k;
    ASSERT_EQ(std::isnan(log_odds[k]), std::isnan(at_once[k])) << k;
  }
}

// No task has more of the log than the rows that it names, and no others than they together have all.
TEST(EvidenceMap, EachRoundReadsEachRowOfTheLogOnce) {
  const Room room{.scans = 1300, .beams = 180};
  const auto log = std::make_shared<const Blob>(room.Log());
  int rounds = 0;
  RunInProcess(EvidenceMap({}, 7), {{"log", log}}, [&](const proto::Step& step) {
    if (step.tasks_size() == 0) return;
    ++rounds;
    std::int64_t next = 0;
    for (const Task& task : step.tasks()) {
      for (const proto::InputRef& input : task.inputs()) {
        if (input.blob() != log->ContentHash().Binary()) continue;
        ASSERT_TRUE(input.has_part());
        EXPECT_EQ(input.part().first_row(), next);
        next += input.part().row_count();
      }
    }
    EXPECT_EQ(next, room.scans);
  });
  EXPECT_EQ(rounds, 2);
}

// What the scans that the map is checked with had added is taken out of it exactly: the check is that of a
// map which never knew them.
TEST(EvidenceMap, IsCheckedWithReadingsThatItWasMadeWithout) {
  for (const double opening_rad : {0.0, 0.26}) {
    Options options;
    options.grid.box_m = "-1,-1,7,6";
    const Room room{.scans = 200, .opening_rad = opening_rad};
    const BlobPtr whole = Map(room, options).result;
    options.grid.heldout = 0.1;
    const BlobPtr without = Map(room, options).result;
    EXPECT_FALSE(whole->at("map/grid/log_odds") == without->at("map/grid/log_odds"));
    for (const char* name : {"fit/checked_nats", "fit/ignorant_nats"})
      EXPECT_EQ(whole->Scalar<double>(name), without->Scalar<double>(name)) << name;
    EXPECT_EQ(whole->Scalar<std::int64_t>("fit/checked_readings"), 20 * room.beams);
    EXPECT_GT(whole->Scalar<double>("fit/checked_nats"), whole->Scalar<double>("fit/ignorant_nats") + 0.2);
  }
}

TEST(EvidenceMap, PosesGivenMoveTheMap) {
  Blob poses;
  poses.Put("robots", Array::Texts({"rover"}));
  poses.PutVector<double>("robot/0/poses/time_s", {0, 1000});
  poses.PutVector<double>("robot/0/poses/x_m", {15.2, 15.2});  // 10 m, 20 m from where it stood
  poses.PutVector<double>("robot/0/poses/y_m", {22.5, 22.5});
  poses.PutVector<double>("robot/0/poses/heading_rad", {0, 0});
  const Outcome outcome = Map({.drives = false}, {}, &poses);
  EXPECT_GT(At(*outcome.result, 16.02, 22.5), 0.9);
}

// Maps of frames that have nothing to do with each other, laid over each other, look like a map.
TEST(EvidenceMap, OfRobotsWithoutACommonFrameItTakesOne) {
  const Room room, other{.width_m = 9, .seed = 2};
  const Blob log = LogOfTwoRovers(room, other), paths = LocalPathsOf(log);
  const auto map = [&](const std::string& robots) {
    Options options;
    options.grid.robots = robots;
    return RunInProcess(EvidenceMap(options, 7), {{"log", std::make_shared<const Blob>(log)},
                                                  {"poses", std::make_shared<const Blob>(paths)}});
  };
  ExpectTwoFramesAreRefused(map);
  const BlobPtr chosen = map("rover"), alone = Map(room, {}).result;
  for (const auto& [name, array] : alone->fields()) {
    if (name != "robots" && name != "log_hash") {
      EXPECT_TRUE(chosen->at(name) == array) << name;
    }
  }
  EXPECT_FALSE(chosen->Has("robot/1/laser/time_s"));
  EXPECT_FALSE(map("other")->at("map/grid/probability") == alone->at("map/grid/probability"));
}

// As far as the sensor reaches, which may be far beyond the map.
TEST(EvidenceMap, ReadingsWithoutAnAnswerMayTellOfAnyNumberOfCells) {
  Options options;
  options.grid.cell_m = 0.01;
  options.use_no_return = false;
  auto log = std::make_shared<Blob>(Room{.scans = 60, .beams = 72, .opening_rad = 1}.Log());
  const std::string sonar = "robot/0/sonar/";
  const Array& range_m = log->at(sonar + "range_m");
  std::vector<double> unanswered(range_m.As<double>().begin(), range_m.As<double>().end());
  std::fill(unanswered.begin() + std::ssize(unanswered) / 10, unanswered.end(),
            std::numeric_limits<double>::quiet_NaN());
  ASSERT_GT(unanswered.size(), 4000U);
  log->Put(sonar + "range_m", Array::Of(range_m.shape(), unanswered));
  log->PutScalar(sonar + "max_range_m", 1e4);
  EXPECT_TRUE(RunInProcess(EvidenceMap(options, 7), {{"log", log}})->Has("map/grid/probability"));
}

// What tells of an obstacle must be more than is expected anyway.
TEST(EvidenceMap, RefusesAPriorThatReadingsCannotRaiseAndLower) {
  const auto refusal = [](double opening_rad, double prior) -> std::string {
    Options options;
    options.prior = prior;
    try {
      Map({.opening_rad = opening_rad}, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  constexpr double kCone_rad = 0.26;
  for (const double prior : {0.65, 0.6, 0.45, 0.4})
    EXPECT_NE(
        refusal(kCone_rad, prior).find("does not lie between sonar_p_free = 0.45 and sonar_p_occupied = 0.6"),
        std::string::npos)
        << prior << refusal(kCone_rad, prior);
  EXPECT_EQ(refusal(kCone_rad, 0.55), "");
  EXPECT_EQ(refusal(0, 0.65), "") << "within those of a laser";
  EXPECT_NE(refusal(0, 0.7).find("laser_p_occupied"), std::string::npos);
}

TEST(EvidenceMap, RefusesALogWithoutRangeScans) {
  Blob log;
  log.Put("robots", Array::Texts({"ann"}));
  EXPECT_THROW(RunInProcess(EvidenceMap({}, 7), {{"log", std::make_shared<const Blob>(log)}}), InputError);
}

}  // namespace
}  // namespace cairn::evidence_map
