#include "tests/conformance/cases.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "pipelines/common/testing_room.h"
#include "pipelines/landmark_learning/testing.h"
#include "pipelines/localization/testing.h"
#include "pipelines/testing/in_process.h"
#include "schema/rng.h"
#include "worker/testing/toy_pipeline.h"

namespace cairn::conformance {
namespace {

constexpr int kSide = 6;  // controls of 1 m along a side of the square that is driven
constexpr double kCornerX_m[] = {6, 6, 0, 0};
constexpr double kCornerY_m[] = {0, 6, 6, 0};

enum class Sensor { kButton, kRangeBearing };

struct Columns {
  std::vector<double> time_s, turn_rad, forward_m;   // odometry
  std::vector<double> seen_s, range_m, bearing_rad;  // observations
  std::vector<std::int32_t> landmark, true_landmark;
  std::vector<double> x_m, y_m, heading_rad;  // truth
};

void Observe(Sensor sensor, double x, double y, double heading, Rng& rng, Columns& c) {
  for (int corner = 0; corner < 4; ++corner) {
    const double dx = kCornerX_m[corner] - x;
    const double dy = kCornerY_m[corner] - y;
    const double range = std::hypot(dx, dy);
    const bool button = sensor == Sensor::kButton;
    if (button ? range > 0.5 : range < 0.5 || range > 4) continue;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    c.seen_s.push_back(c.time_s.back());
    c.landmark.push_back(button ? -1 : corner);
    c.true_landmark.push_back(corner);
    c.range_m.push_back(button ? nan : range + 0.1 * rng.Normal());
    c.bearing_rad.push_back(
        button ? nan : std::remainder(std::atan2(dy, dx) - heading + 0.03 * rng.Normal(), 2 * M_PI));
  }
}

// A robot that drives a square `laps` times from its lower left corner, with odometry that drifts.
Columns Drive(Sensor sensor, std::uint64_t robot, int laps) {
  Rng rng(4, robot);
  Columns c;
  double x = 0, y = 0, heading = 0;
  for (int i = 0; i < 4 * kSide * laps; ++i) {
    const double turn = i > 0 && i % kSide == 0 ? M_PI / 2 : 0;
    heading += turn;
    x += std::cos(heading);
    y += std::sin(heading);
    c.time_s.push_back(i + 1);
    c.turn_rad.push_back(turn + 0.004 + 0.005 * rng.Normal());
    c.forward_m.push_back(1 + 0.02 * rng.Normal());
    c.x_m.push_back(x);
    c.y_m.push_back(y);
    c.heading_rad.push_back(std::remainder(heading, 2 * M_PI));
    Observe(sensor, x, y, heading, rng, c);
  }
  return c;
}

void AddRobot(const Columns& c, int robot, Blob& log) {
  const std::string own = "robot/" + std::to_string(robot) + "/";
  log.PutVector(own + "odometry/time_s", c.time_s);
  log.PutVector(own + "odometry/turn_rad", c.turn_rad);
  log.PutVector(own + "odometry/forward_m", c.forward_m);
  log.PutVector(own + "observations/time_s", c.seen_s);
  log.PutVector(own + "observations/landmark", c.landmark);
  log.PutVector(own + "observations/range_m", c.range_m);
  log.PutVector(own + "observations/bearing_rad", c.bearing_rad);
  log.PutVector("truth/" + own + "poses/time_s", c.time_s);
  log.PutVector("truth/" + own + "poses/x_m", c.x_m);
  log.PutVector("truth/" + own + "poses/y_m", c.y_m);
  log.PutVector("truth/" + own + "poses/heading_rad", c.heading_rad);
  log.PutVector("truth/" + own + "observations/landmark", c.true_landmark);
}

// With its truth inside, so that a pipeline that reads it can be found out.
Blob SquareLog(Sensor sensor, int robots, int laps) {
  Blob log;
  const std::vector<std::string> corners = {"a", "b", "c", "d"};
  std::vector<std::string> names;
  for (int robot = 0; robot < robots; ++robot) {
    AddRobot(Drive(sensor, static_cast<std::uint64_t>(robot), laps), robot, log);
    names.push_back("robot " + std::to_string(robot));
  }
  log.Put("robots", Array::Texts(names));
  log.Put("landmarks", Array::Texts(sensor == Sensor::kButton ? std::vector<std::string>() : corners));
  log.PutScalar("noise/heading_drift_rad_per_m", 0.005);
  log.PutScalar("noise/heading_walk_rad_per_sqrt_m", 0.01);
  log.PutScalar("noise/forward_ratio", 0.02);
  log.PutScalar("noise/turn_ratio", 0.02);
  log.PutScalar("noise/contact_m", 0.3);
  log.PutScalar("noise/range_m", 0.1);
  log.PutScalar("noise/bearing_rad", 0.03);
  log.PutScalar("sensor/max_range_m", 4.0);
  log.Put("truth/landmarks/name", Array::Texts(corners));
  log.PutVector<double>("truth/landmarks/x_m", {std::begin(kCornerX_m), std::end(kCornerX_m)});
  log.PutVector<double>("truth/landmarks/y_m", {std::begin(kCornerY_m), std::end(kCornerY_m)});
  return log;
}

BlobPtr Share(Blob blob) { return std::make_shared<const Blob>(std::move(blob)); }

void Set(proto::Stage& stage, const std::string& option, double value) {
  (*stage.mutable_options())[option].set_d(value);
}
void SetInteger(proto::Stage& stage, const std::string& option, std::int64_t value) {
  (*stage.mutable_options())[option].set_i(value);
}

Case LandmarkMap(const std::string& name, Sensor sensor, int robots, int laps = 3) {
  Case c{.name = name, .stage = {}, .inputs = {{"log", Share(SquareLog(sensor, robots, laps))}}};
  Set(c.stage, "cell_m", 0.5);
  Set(c.stage, "heading_deg", 10);
  SetInteger(c.stage, "iterations", 3);
  Set(c.stage, "slice_mcells", 0.2);
  return c;
}

// Starts from the map that the same log gave, the robot anywhere in it.
Case LandmarkMapFromAMap() {
  Case c = LandmarkMap("landmark_map_from_map", Sensor::kButton, 1);
  SetInteger(c.stage, "starts", 1);
  proto::Stage first = c.stage;
  first.set_name("first");
  first.set_pipeline("landmark_map");
  c.inputs["map"] =
      RunInProcess(*MakePipeline(first, 0), {{"log", Share(c.inputs.at("log")->Without("truth/"))}});
  (*c.stage.mutable_options())["start"].set_s("anywhere");
  (*c.stage.mutable_options())["beliefs"].set_b(true);
  return c;
}

Case LandmarkMapIncremental() {
  Case c = LandmarkMap("landmark_map_incremental", Sensor::kButton, 1);
  (*c.stage.mutable_options())["incremental"].set_b(true);
  (*c.stage.mutable_options())["beliefs"].set_b(true);
  c.rounds = 1;  // the pass
  c.tasks = 1;   // each observation waits for the map of those before it
  return c;
}

// Slices that are long enough to be guessed, which begins after two iterations.
Case LandmarkMapSideBySide() {
  Case c = LandmarkMap("landmark_map_side_by_side", Sensor::kButton, 1, 50);
  SetInteger(c.stage, "starts", 1);
  SetInteger(c.stage, "iterations", 6);
  Set(c.stage, "slice_mcells", 0.6);
  Set(c.stage, "tolerance", 0);
  return c;
}

Case LandmarkLearning(const std::string& name, double window_m, bool both_ways = false) {
  Blob samples = landmark_learning::CorridorSamples{.samples = 700, .both_ways = both_ways}.Make();
  for (const char* name : {"x_m", "y_m"})
    samples.PutVector(std::string("truth/run/0/") + name, std::vector<double>(700, 1.0));
  Case c{.name = name, .stage = {}, .inputs = {{"samples", Share(std::move(samples))}}};
  Set(c.stage, "window_m", window_m);
  SetInteger(c.stage, "networks", 5);
  SetInteger(c.stage, "steps", 4);
  SetInteger(c.stage, "validate_every", 2);
  (*c.stage.mutable_options())["holdout"].set_s("run 1");
  return c;
}

// There and back, by a robot that knows which way it faces.
Case LandmarkLearningBothWays() {
  Case c = LandmarkLearning("landmark_learning_both_ways", 5.0, true);
  Set(c.stage, "heading_window_deg", 90.0);
  return c;
}

// So many features that a step is cut into rounds of outputs, pairs and weights.
Case LandmarkLearningInPhases() {
  Case c = LandmarkLearning("landmark_learning_phases", 0.0);
  Set(c.stage, "input_noise", 0.5);
  SetInteger(c.stage, "networks", 8);
  SetInteger(c.stage, "steps", 2);
  return c;
}

// Images of noise, of two runs; the first is more than a task.
Case ImageFeatures() {
  Blob samples;
  samples.Put("runs", Array::Texts({"out", "home"}));
  samples.Put("input_name", Array::Texts({}));
  Rng rng(5);
  for (const std::int64_t run : {0, 1}) {
    const std::int64_t count = run == 0 ? 60 : 5;
    // Eight bytes at a time: each test of the suite, a process of its own, makes all fixtures.
    std::vector<std::uint64_t> noise(static_cast<std::size_t>(count * 240 * 200 * 3 / 8));
    std::ranges::generate(noise, [&rng] { return rng.Bits64(); });
    const auto bytes = std::as_bytes(std::span(noise));
    const std::span image(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    const std::string prefix = "run/" + std::to_string(run) + "/";
    samples.Put(prefix + "image", Array::Of<std::uint8_t>({count, 240, 200, 3}, image));
    samples.Put(prefix + "input", Array::Of({count, 0}, std::vector<float>()));
    for (const char* name : {"time_s", "x_m", "y_m"})
      samples.PutVector(prefix + name, std::vector<double>(static_cast<std::size_t>(count), 0.0));
  }
  for (const char* name : {"x_m", "y_m"})
    samples.PutVector<double>(std::string("truth/run/1/") + name, {1, 2, 3, 4, 5});
  return {.name = "image_features",
          .stage = {},
          .inputs = {{"samples", Share(std::move(samples))}},
          .rounds = 1};  // the method has no more
}

Case Localization(const std::string& name, const char* sensing, const char* belief) {
  Blob samples = localization::CorridorWithFeatures().Make();
  for (const char* name : {"x_m", "y_m"})
    samples.PutVector(std::string("truth/run/0/") + name,
                      std::vector<double>(samples.Get<double>("run/0/time_s").size(), 1.0));
  Case c{.name = name, .stage = {}, .inputs = {{"samples", Share(std::move(samples))}}};
  SetInteger(c.stage, "traverses", 9);
  Set(c.stage, "travelled_m", 5.0);
  (*c.stage.mutable_options())["runs"].set_s("run 1");
  (*c.stage.mutable_options())["sensing"].set_s(sensing);
  (*c.stage.mutable_options())["belief"].set_s(belief);
  return c;
}

// There and back, by a robot that does not know which way it faces.
Case LocalizationBothWays() {
  Case c = Localization("localization_both_ways", "soft", "grid");
  Blob samples = localization::CorridorWithFeatures{.runs = 4, .both_ways = true}.Make();
  samples.PutVector("truth/run/0/heading_rad",
                    std::vector<double>(samples.Get<double>("run/0/time_s").size(), 1.0));
  c.inputs["samples"] = Share(std::move(samples));
  (*c.stage.mutable_options())["heading"].set_s("unknown");
  return c;
}

Case Training(const std::string& method, std::int64_t batch, bool sequential) {
  Case c = LandmarkLearning("landmark_learning_" + (sequential  ? "sequential"
                                                    : batch > 0 ? "batch"
                                                                : method),
                            5.0);
  (*c.stage.mutable_options())["method"].set_s(method);
  (*c.stage.mutable_options())["sequential"].set_b(sequential);
  SetInteger(c.stage, "batch", batch);
  if (batch > 0) Set(c.stage, "input_noise", 0.5);
  SetInteger(c.stage, "pattern_steps", 3);
  if (sequential) SetInteger(c.stage, "steps", 10);
  return c;
}

Case TwoHiddenLayers() {
  Case c = LandmarkLearning("landmark_learning_deep", 5.0);
  SetInteger(c.stage, "hidden_2", 7);
  return c;
}

// The rounds of a trial, then those of the one that is chosen.
Case SeveralStarts() {
  Case c = LandmarkLearning("landmark_learning_starts", 5.0);
  SetInteger(c.stage, "starts", 3);
  SetInteger(c.stage, "start_steps", 2);
  Set(c.stage, "input_noise", 0.5);
  return c;
}

// By the path through a map; or by the mass of the belief, on cells.
Case TrainingOn(const std::string& error) {
  Case c = LandmarkLearning("landmark_learning_" + error, 5.0);
  (*c.stage.mutable_options())["error"].set_s(error);
  (*c.stage.mutable_options())["true_positions"].set_s("space");
  if (error == "kl") Set(c.stage, "cell_m", 0.05);
  if (error != "travel") return c;
  constexpr std::int64_t kColumns = 90, kRows = 8;
  Blob map;
  map.Put("map/grid/probability",
          Array::Of<double>({kRows, kColumns}, std::vector<double>(kColumns * kRows, 0.1)));
  map.PutScalar("map/grid/origin_x_m", -1.0);
  map.PutScalar("map/grid/origin_y_m", -2.0);
  map.PutScalar("map/grid/cell_m", 0.5);
  c.inputs["map"] = Share(std::move(map));
  return c;
}

// A room by laser, in several slices, and by sonar.
Case EvidenceMap() {
  Blob log = Room{.scans = 600, .beams = 180}.Log();
  log.PutAll("robot/0/sonar/", Room{.opening_rad = 0.26}.Log().Sub("robot/0/sonar/"));
  for (const char* name : {"x_m", "y_m"})
    log.Put(std::string("truth/walls/") + name, Array::Of<double>({1, 2}, {1.0, 2.0}));
  Case c{.name = "evidence_map", .stage = {}, .inputs = {{"log", Share(std::move(log))}}};
  Set(c.stage, "cell_m", 0.02);
  Set(c.stage, "heldout", 0.1);
  return c;
}

// A room by laser and by sonar, in one tile and in many.
Case ForwardMap(const std::string& name, double tile_mcrossings) {
  Blob log = Room{}.Log();
  log.PutAll("robot/0/sonar/", Room{.opening_rad = 0.26, .seed = 2}.Log().Sub("robot/0/sonar/"));
  for (const char* name : {"x_m", "y_m"})
    log.Put(std::string("truth/walls/") + name, Array::Of<double>({1, 2}, {1.0, 2.0}));
  Case c{.name = name, .stage = {}, .inputs = {{"log", Share(std::move(log))}}};
  Set(c.stage, "cell_m", 0.1);
  Set(c.stage, "heldout", 0.2);
  Set(c.stage, "tile_mcrossings", tile_mcrossings);
  SetInteger(c.stage, "rounds", 5);
  return c;
}

// A room by laser and by sonar, in segments.
Case LocalMap() {
  Blob log = Room{.scans = 300}.Log();
  log.PutAll("robot/0/sonar/", Room{.scans = 300, .opening_rad = 0.26}.Log().Sub("robot/0/sonar/"));
  for (const char* name : {"x_m", "y_m"})
    log.Put(std::string("truth/walls/") + name, Array::Of<double>({1, 2}, {1.0, 2.0}));
  Case c{.name = "local_map", .stage = {}, .inputs = {{"log", Share(std::move(log))}}};
  SetInteger(c.stage, "segment_scans", 100);
  return c;
}

// Of a pipeline that has no branch below: its first input is a log of everything that logs hold, or samples.
Case OfAnyPipeline(const PipelineInfo& info) {
  Case c{.name = info.name, .stage = {}, .inputs = {}, .rounds = 1, .tasks = 1};
  if (info.inputs.front() == "log") {
    Blob log = SquareLog(Sensor::kRangeBearing, 2, 3);
    const Blob room = Room{.scans = 60}.Log();
    for (const char* group : {"robot/0/laser/", "robot/0/poses/"}) log.PutAll(group, room.Sub(group));
    c.inputs["log"] = Share(std::move(log));
  } else if (info.inputs.front() == "samples") {
    c = Localization(info.name, "soft", "grid");
    c.stage.clear_options();
    c.rounds = c.tasks = 1;
  }
  return c;
}

// The cases of a registered pipeline, named after it; one that wants more than OfAnyPipeline adds its branch.
std::vector<Case> FixturesOf(const PipelineInfo& info) {
  const std::string& pipeline = info.name;
  if (pipeline == "toy") {
    Case c{.name = "toy", .stage = {}, .inputs = {{"log", Share(testing::ToyLog(60))}}};
    SetInteger(c.stage, "slices", 6);
    return {c};
  }
  if (pipeline == "landmark_map") {
    return {LandmarkMap("landmark_map_contacts", Sensor::kButton, 1),
            LandmarkMap("landmark_map_ranges", Sensor::kRangeBearing, 2), LandmarkMapFromAMap(),
            LandmarkMapSideBySide(), LandmarkMapIncremental()};
  }
  if (pipeline == "evidence_map") return {EvidenceMap()};
  if (pipeline == "forward_map")
    return {ForwardMap("forward_map_one_tile", 4.0), ForwardMap("forward_map_tiles", 0.02)};
  if (pipeline == "image_features") return {ImageFeatures()};
  if (pipeline == "landmark_learning")
    return {LandmarkLearning("landmark_learning_window", 5.0),
            LandmarkLearning("landmark_learning_global", 0.0),
            LandmarkLearningInPhases(),
            LandmarkLearningBothWays(),
            TwoHiddenLayers(),
            SeveralStarts(),
            Training("conjugate", 0, false),
            Training("pseudo", 0, false),
            Training("momentum", 1300, false),
            Training("adam", 0, true),
            TrainingOn("travel"),
            TrainingOn("kl")};
  if (pipeline == "local_map") return {LocalMap()};
  if (pipeline == "localization")
    return {Localization("localization_samples", "sampled", "samples"),
            Localization("localization_grid", "soft", "grid"), LocalizationBothWays()};
  return {OfAnyPipeline(info)};
}

}  // namespace

Case SquareDrive(const std::string& name, bool ranged, int robots, int laps) {
  Case c = LandmarkMap(name, ranged ? Sensor::kRangeBearing : Sensor::kButton, robots, laps);
  c.stage.set_name("stage");
  c.stage.set_pipeline("landmark_map");
  return c;
}

std::vector<PipelineInfo> ListAll() {
  std::vector<PipelineInfo> infos = ListPipelines();
  infos.push_back(testing::ToyInfo());
  return infos;
}

std::vector<Case> AllCases() {
  std::vector<Case> cases;
  for (const PipelineInfo& info : ListAll()) {
    for (Case& c : FixturesOf(info)) {
      c.stage.set_name("stage");
      c.stage.set_pipeline(info.name);
      for (const auto& [name, blob] : c.inputs) (*c.stage.mutable_inputs())[name] = name;
      cases.push_back(std::move(c));
    }
  }
  return cases;
}

std::unique_ptr<const Pipeline> Make(const proto::Stage& stage, std::uint64_t seed) {
  return stage.pipeline() == "toy" ? testing::MakeToy(stage, seed) : MakePipeline(stage, seed);
}

proto::Job JobOf(const Case& c) {
  proto::Job job;
  job.set_name("conformance");
  job.set_seed(c.seed);
  *job.add_stages() = c.stage;
  for (const auto& [name, blob] : c.inputs) {
    (*job.mutable_inputs())[name] = name + ".h5";
    (*job.mutable_input_blobs())[name] = blob->ContentHash().Binary();
  }
  return job;
}

}  // namespace cairn::conformance
