// A world that is turned, shifted, or told with its robots in another order and under other names gives the
// result that is turned, shifted, reordered and renamed: for every registered pipeline, over the fixtures of
// the conformance suite. A new pipeline adds a line to Promises.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "pipelines/common/testing_room.h"
#include "pipelines/testing/in_process.h"
#include "schema/numerics.h"
#include "tests/conformance/cases.h"
#include "tests/conformance/moved.h"

namespace cairn::conformance {
namespace {

constexpr double kPi = std::numbers::pi;

// How a fixture's result follows its world.
enum class Follows {
  kTurned,      // it turns and shifts with it, by any angle
  kByQuarters,  // the same by quarters and whole cells, whatever the angle to begin with: cells stay cells
  kOwnFrame     // it has a frame of its own, and stays as it is
};

struct Promise {
  Follows follows = Follows::kTurned;
  // What rounding makes of the last digits, unless a reason says otherwise.
  double tolerance = 1e-6;
  double cell_m = 0;
  std::vector<double> angles_rad = {};
  // Names of fields, by their start, that follow in another way.
  std::vector<std::string> but = {};
  std::map<std::string, std::string> options = {};
};

// Cells are cut where beams and borders meet: along an axis every beam would lie on a border.
const std::vector<double> kAnyBeam = {0.4, kPi - 0.05};
const std::vector<double> kAnyAngle = {0.4, kPi / 2, 2.0, kPi - 0.05, kPi - 1e-9, kPi, -kPi + 0.05, -1.1};

// Sums of square roots of what is near zero: there the last digit of ten becomes the fifth (2.5e-5 were
// seen).
const std::vector<std::string> kRoots = {"held_out/agreement_sigmas"};

// A line a fixture. Of landmark_map the others know odometry and observations only, of which nothing is said
// in a frame of the world (see Drive below); of landmark_learning the others take the same way.
const std::map<std::string, Promise>& Promises() {
  // In numbers of 24 bits, which add up in the order in which the method looks through space. Adam divides a
  // slope by its own size, and so makes a step of what rounding leaves of one that is nothing.
  const std::map<std::string, std::string> plain = {{"method", "gradient"}};
  // What labels say of odometry is drawn an axis.
  const std::map<std::string, std::string> exact = {{"odometry_ratio", "0"}};
  static const std::map<std::string, Promise> promises = {
      // Pruning cuts at a threshold, to either side of which rounding may fall.
      {"landmark_map_from_map",
       {.follows = Follows::kByQuarters,
        .cell_m = 0.5,
        .angles_rad = {0},
        .but = {"history/landmark_"},  // in the order in which a search of the cells comes upon them
        .options = {{"prune", "0.000001"}, {"beliefs", "false"}}}},
      {"evidence_map",
       {.follows = Follows::kByQuarters,
        .cell_m = 0.05,
        .angles_rad = kAnyBeam,
        .options = {{"cell_m", "0.05"}}}},
      // Not at any angle: at one in four of 36 a map of a cell more or less is as likely, and rounding
      // decides.
      {"forward_map_one_tile",
       {.follows = Follows::kByQuarters,
        .cell_m = 0.1,
        .angles_rad = {0.4, 3.13},
        .but = {"history/changed_"}}},  // by the numbers of cells
      {"local_map",
       {.follows = Follows::kOwnFrame, .tolerance = 0.01, .angles_rad = kAnyAngle, .but = {"snapshots/"}}},
      {"image_features", {.angles_rad = kAnyAngle}},
      {"landmark_learning_window",
       {.tolerance = 1e-5, .angles_rad = kAnyAngle, .but = kRoots, .options = plain}},
      {"landmark_learning_global",
       {.tolerance = 1e-5, .angles_rad = kAnyAngle, .but = kRoots, .options = plain}},
      {"landmark_learning_both_ways",
       {.tolerance = 1e-5, .angles_rad = kAnyAngle, .but = kRoots, .options = plain}},
      {"landmark_learning_travel",
       {.follows = Follows::kByQuarters, .cell_m = 0.5, .angles_rad = {0}, .but = kRoots, .options = plain}},
      {"landmark_learning_kl",
       {.follows = Follows::kByQuarters,
        .cell_m = 0.05,
        .angles_rad = kAnyBeam,
        .but = kRoots,
        .options = plain}},
      {"localization_samples", {.angles_rad = kAnyAngle, .options = exact}},
      // Places are told in the order of their rows, and the first of those that are equally likely is the
      // mode:
      // before anything is sensed all are. A fiftieth of a cell (0.0016 m were seen).
      {"localization_grid",
       {.follows = Follows::kByQuarters,
        .tolerance = 0.005,
        .cell_m = 0.25,
        .angles_rad = {0.4, kPi - 0.05},
        .but = {"belief/", "position/", "step/mode", "step/entries"},
        .options = exact}},
      {"localization_both_ways",
       {.follows = Follows::kByQuarters,
        .cell_m = 0.25,
        .angles_rad = {kPi / 4, kPi - 0.05},
        .but = {"belief/", "position/", "step/mode"},
        .options = exact}},
  };
  return promises;
}

// Of a pipeline that has no line above: what those of grids promise, on the cells that it makes when nobody
// says otherwise.
Promise OfAnyPipeline(const std::string& pipeline) {
  Promise promise{.follows = Follows::kByQuarters, .cell_m = 0.05, .angles_rad = kAnyBeam};
  for (const PipelineInfo& info : ListPipelines())
    for (const OptionInfo& option : info.options)
      if (info.name == pipeline && option.name == "cell_m") promise.cell_m = option.default_value.d();
  return promise;
}

Promise PromiseOf(const Case& c) {
  const auto known = Promises().find(c.name);
  return known == Promises().end() ? OfAnyPipeline(c.stage.pipeline()) : known->second;
}

Case With(Case c, const std::map<std::string, std::string>& options) {
  for (const auto& [name, text] : options) {
    proto::Value& value = (*c.stage.mutable_options())[name];
    if (text == "true" || text == "false") {
      value.set_b(text == "true");
    } else if (text.find_first_not_of("0123456789.") == std::string::npos) {
      value.set_d(std::stod(text));
    } else {
      value.set_s(text);
    }
  }
  return c;
}

InputMap Moved(const InputMap& inputs, const Motion& motion) {
  InputMap moved;
  for (const auto& [name, blob] : inputs)
    moved[name] = std::make_shared<const Blob>(Moved(blob->Without("truth/"), motion));
  return moved;
}

BlobPtr ResultOf(const Case& c, const InputMap& inputs) {
  return RunInProcess(*Make(c.stage, c.seed), inputs);
}

class Invariance : public ::testing::TestWithParam<Case> {
 protected:
  static void SetUpTestSuite() {
    FixNumericsOfProcess();
    FixNumericsOfThread();
  }
  const Promise promise_ = PromiseOf(GetParam());
  const Case case_ = With(GetParam(), promise_.options);

  void Expect(const Blob& expected, const Blob& found, const std::string& where) const {
    const auto passed_over = [&](const std::string& name) {
      return std::ranges::any_of(promise_.but, [&](const auto& start) { return name.starts_with(start); });
    };
    EXPECT_EQ(Differences(expected, found, promise_.tolerance, passed_over), "") << where;
  }
};

TEST_P(Invariance, AWorldThatIsTurnedAndShiftedGivesTheResultTurnedAndShifted) {
  ASSERT_FALSE(promise_.angles_rad.empty());
  const BlobPtr still =
      promise_.follows == Follows::kByQuarters ? nullptr : ResultOf(case_, Moved(case_.inputs, {}));
  for (const double angle_rad : promise_.angles_rad) {
    const std::string where = std::to_string(angle_rad) + " rad";
    if (promise_.follows == Follows::kByQuarters) {
      const InputMap inputs = Moved(case_.inputs, {.angle_rad = angle_rad});
      const BlobPtr before = ResultOf(case_, inputs);
      for (const int quarters : {1, 2, 3}) {
        const Motion motion{.quarters = quarters, .x_m = 40 * promise_.cell_m, .y_m = -130 * promise_.cell_m};
        Expect(InOrder(Moved(*before, motion)), InOrder(*ResultOf(case_, Moved(inputs, motion))),
               where + " and " + std::to_string(quarters) + " quarters");
      }
      continue;
    }
    const Motion motion{.angle_rad = angle_rad, .x_m = 3.7, .y_m = -12.9};
    const BlobPtr moved = ResultOf(case_, Moved(case_.inputs, motion));
    if (promise_.follows == Follows::kOwnFrame) {
      Expect(InItsOwnFrame(*still), InItsOwnFrame(*moved), where);
    } else {
      Expect(InOrder(Moved(*still, motion)), InOrder(*moved), where);
    }
  }
}

// Each robot has poses of its own: who is told first is nobody's business.
TEST(RangeLogs, RobotsInAnotherOrderGiveTheResultInThatOrder) {
  for (const Case& c : AllCases()) {
    if (c.name != "evidence_map" && c.name != "forward_map_one_tile" && c.name != "local_map") continue;
    const Case coarse = c.name == "evidence_map" ? With(c, {{"cell_m", "0.05"}}) : c;
    Blob log = c.inputs.at("log")->Without("truth/");
    const bool small = c.name == "forward_map_one_tile";
    log.PutAll("robot/1/", Room{.scans = small ? 30 : 300, .seed = 9}.Log().Sub("robot/0/"));
    log.Put("robots", Array::Texts({"first", "second"}));
    const std::vector<std::size_t> order = {1, 0};
    const BlobPtr told = ResultOf(coarse, {{"log", std::make_shared<const Blob>(log)}});
    const BlobPtr otherwise =
        ResultOf(coarse, {{"log", std::make_shared<const Blob>(Reordered(log, "robot", order))}});
    const auto of_pictures = [](const std::string& name) { return name.starts_with("snapshots/"); };
    EXPECT_EQ(Differences(Reordered(*told, "robot", order), *otherwise, 1e-6, of_pictures), "") << c.name;
  }
}

// Of the cells of one map that say something, the share on which another, of the same world turned, says the
// same: an obstacle where there is one within a cell, free where all around is free.
double SharedGround(const Blob& still, const Blob& turned, const Motion& motion) {
  const auto& shape = still.at("map/grid/probability").shape();
  const auto p = still.Get<double>("map/grid/probability"), q = turned.Get<double>("map/grid/probability");
  const std::int64_t rows = turned.at("map/grid/probability").shape()[0],
                     columns = turned.at("map/grid/probability").shape()[1];
  const double cell_m = still.Scalar<double>("map/grid/cell_m");
  const double c = std::cos(motion.angle_rad), s = std::sin(motion.angle_rad);
  const auto around = [](std::span<const double> map, std::int64_t all_rows, std::int64_t all_columns,
                         std::int64_t row, std::int64_t column) {
    double highest = 0;
    for (std::int64_t j = std::max<std::int64_t>(0, row - 1); j <= std::min(all_rows - 1, row + 1); ++j) {
      for (std::int64_t i = std::max<std::int64_t>(0, column - 1); i <= std::min(all_columns - 1, column + 1);
           ++i) {
        const double value = map[static_cast<std::size_t>(j * all_columns + i)];
        highest = std::isnan(value) ? 0.5 : std::max(highest, value);
      }
    }
    return highest;
  };
  double said = 0, shared = 0;
  for (std::int64_t row = 0; row < shape[0]; ++row) {
    for (std::int64_t column = 0; column < shape[1]; ++column) {
      const double here = p[static_cast<std::size_t>(row * shape[1] + column)];
      const bool obstacle = here > 0.5, free = around(p, shape[0], shape[1], row, column) < 0.5;
      if (!obstacle && !free) continue;
      const double x = still.Scalar<double>("map/grid/origin_x_m") +
                       (static_cast<double>(column) + 0.5) * cell_m,
                   y = still.Scalar<double>("map/grid/origin_y_m") +
                       (static_cast<double>(row) + 0.5) * cell_m;
      const auto i = static_cast<std::int64_t>(
          std::floor((c * x - s * y + motion.x_m - turned.Scalar<double>("map/grid/origin_x_m")) / cell_m));
      const auto j = static_cast<std::int64_t>(
          std::floor((s * x + c * y + motion.y_m - turned.Scalar<double>("map/grid/origin_y_m")) / cell_m));
      ++said;
      if (i < 0 || j < 0 || i >= columns || j >= rows) continue;
      shared += obstacle ? around(q, rows, columns, j, i) > 0.5
                         : q[static_cast<std::size_t>(j * columns + i)] < 0.5;
    }
  }
  return said > 0 ? shared / said : 0;
}

// Between quarters a grid cuts the world elsewhere, and many tiles are searched in another order.
TEST(GridMaps, ATurnByAnyAngleChangesNoMoreThanWhereCellsAreCut) {
  for (const Case& c : AllCases()) {
    if (c.stage.pipeline() != "evidence_map" && c.stage.pipeline() != "forward_map") continue;
    const Case coarse = c.stage.pipeline() == "evidence_map" ? With(c, {{"cell_m", "0.05"}}) : c;
    const BlobPtr still = ResultOf(coarse, Moved(coarse.inputs, {.angle_rad = 0.1}));
    for (const double angle_rad : {0.7, kPi / 2, kPi - 0.05, kPi, -1.1}) {
      const Motion motion{.angle_rad = angle_rad, .x_m = 3.73, .y_m = -12.91};
      const BlobPtr turned =
          ResultOf(coarse, Moved(coarse.inputs, {.angle_rad = angle_rad + 0.1, .x_m = 3.73, .y_m = -12.91}));
      EXPECT_GT(SharedGround(*still, *turned, motion), 0.9) << c.name << " at " << angle_rad;
    }
  }
}

// The fixtures that promise something, and those of pipelines none of whose fixtures has a line.
std::vector<Case> WithAFrame() {
  std::set<std::string> known = {"toy"};  // it has no world
  for (const Case& c : AllCases())
    if (Promises().contains(c.name)) known.insert(c.stage.pipeline());
  std::vector<Case> cases;
  for (Case& c : AllCases()) {
    if (Promises().contains(c.name) || !known.contains(c.stage.pipeline())) cases.push_back(std::move(c));
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(AllPipelines, Invariance, ::testing::ValuesIn(WithAFrame()),
                         [](const auto& instance) { return instance.param.name; });

TEST(InvarianceSuite, KnowsEveryPipeline) {
  std::set<std::string> known;
  for (const Case& c : WithAFrame()) known.insert(c.stage.pipeline());
  for (const PipelineInfo& info : ListPipelines()) EXPECT_TRUE(known.contains(info.name)) << info.name;
}

// The same log of a robot that began facing another way: its first turn is another.
Blob FacingAtFirst(const Blob& log, std::size_t robot, double turn_rad) {
  const std::string name = "robot/" + std::to_string(robot) + "/odometry/turn_rad";
  Blob turned = log;
  const auto turn = log.Get<double>(name);
  std::vector<double> turns(turn.begin(), turn.end());
  turns.front() += turn_rad;
  turned.PutVector(name, turns);
  return turned;
}

double FarthestLandmark(const Blob& a, const Blob& b) {
  const auto ax = a.Get<double>("map/landmark_x_m"), ay = a.Get<double>("map/landmark_y_m");
  const auto bx = b.Get<double>("map/landmark_x_m"), by = b.Get<double>("map/landmark_y_m");
  if (ax.size() != bx.size()) return 1e9;
  double farthest_m = 0;
  for (std::size_t k = 0; k < ax.size(); ++k) {
    double nearest_m = 1e9;
    for (std::size_t l = 0; l < bx.size(); ++l)
      nearest_m = std::min(nearest_m, std::hypot(ax[k] - bx[l], ay[k] - by[l]));
    farthest_m = std::max(farthest_m, nearest_m);
  }
  return farthest_m;
}

class Drive : public ::testing::TestWithParam<bool> {
 protected:
  const Case case_ = SquareDrive("drive", GetParam(), 3);
  const Blob log_ = case_.inputs.at("log")->Without("truth/");
  BlobPtr MapOf(const Blob& log) const {
    return ResultOf(case_, {{"log", std::make_shared<const Blob>(log)}});
  }
};

// What the result should then be: where the log begins the robot has not turned yet.
Blob FacedAtFirst(const Blob& result, std::size_t robot, double turn_rad) {
  Blob faced = result;
  for (const char* name : {"heading_rad", "mode_heading_rad"}) {
    const std::string heading = "robot/" + std::to_string(robot) + "/poses/" + name;
    const auto values = result.Get<double>(heading);
    std::vector<double> turned(values.begin(), values.end());
    turned.front() -= turn_rad;
    faced.PutVector(heading, turned);
  }
  return faced;
}

// Without the first pose's heading, and covariance: where turns have a scale that is estimated, a turn of
// another size leads back to another heading, and to another width.
Blob WithoutFirstHeading(const Blob& result, std::size_t robot) {
  Blob without = result;
  const auto clear = [&](const std::string& name, std::size_t count) {
    const auto values = result.Get<double>(name);
    std::vector<double> cleared(values.begin(), values.end());
    std::fill_n(cleared.begin(), count, 0.0);
    without.Put(name, Array::Of<double>(result.at(name).shape(), cleared));
  };
  const std::string poses = "robot/" + std::to_string(robot) + "/poses/";
  clear(poses + "heading_rad", 1);
  clear(poses + "mode_heading_rad", 1);
  clear(poses + "covariance", 9);
  return without;
}

// A robot that joins starts anywhere: by a whole number of heading steps its beliefs change places, and
// nothing else changes.
TEST_P(Drive, WhichWayARobotThatJoinsBeganToFaceChangesNothing) {
  const BlobPtr still = MapOf(log_);
  constexpr double kStep_rad = 10 * kPi / 180;
  for (const int steps : {1, 9, 17, 18, 19, 30}) {
    const BlobPtr turned = MapOf(FacingAtFirst(log_, 1, steps * kStep_rad));
    const Blob expected = FacedAtFirst(*still, 1, steps * kStep_rad);
    EXPECT_EQ(Differences(WithoutFirstHeading(expected, 1), WithoutFirstHeading(*turned, 1), 1e-6), "")
        << steps << " steps";
  }
  // Between two steps headings are cut elsewhere: by a part of a cell, of 0.5 m.
  constexpr double kPartOfACell_m = 0.02;
  for (const double turn_rad : {0.6, kPi - 0.06, kPi - 0.03, kPi, kPi + 0.03, kPi + 0.06, 5.5}) {
    const BlobPtr turned = MapOf(FacingAtFirst(log_, 1, turn_rad));
    EXPECT_EQ(turned->Text("refinement/reason"), still->Text("refinement/reason")) << turn_rad;
    EXPECT_LT(FarthestLandmark(*still, *turned), kPartOfACell_m) << turn_rad;
  }
}

// The first robot sets the frame; the order of the others is nobody's business.
TEST_P(Drive, RobotsInAnotherOrderGiveTheResultInThatOrder) {
  const std::vector<std::size_t> order = {0, 2, 1};
  EXPECT_EQ(
      Differences(Reordered(*MapOf(log_), "robot", order), *MapOf(Reordered(log_, "robot", order)), 1e-6),
      "");
}

TEST_P(Drive, NamesAreNamesOnly) {
  Blob renamed = log_;
  renamed.Put("robots", Array::Texts({"z", "robot 0", "a"}));
  std::vector<std::string> landmarks = log_.Texts("landmarks");
  for (std::string& name : landmarks) name += " of old";
  renamed.Put("landmarks", Array::Texts(landmarks));
  const auto names = [](const std::string& name) { return name == "robots" || name == "landmarks"; };
  EXPECT_EQ(Differences(*MapOf(log_), *MapOf(renamed), 0.0, names), "");
}

INSTANTIATE_TEST_SUITE_P(Landmarks, Drive, ::testing::Bool(),
                         [](const auto& instance) { return instance.param ? "ranges" : "contacts"; });

}  // namespace
}  // namespace cairn::conformance
