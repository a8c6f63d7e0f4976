#include "tests/conformance/cases.h"

#include <cmath>
#include <limits>

#include "schema/rng.h"
#include "worker/testing/toy_pipeline.h"

namespace cairn::conformance {
namespace {

constexpr int kSide = 6;  // controls of 1 m along a side of the square that is driven
constexpr int kLaps = 3;
constexpr int kPressEvery = 6;  // a landmark at each corner

// A robot that drives a square three times and presses its button at each corner. Its odometry drifts; the
// truth is there, so that a pipeline that reads it can be found out.
Blob SquareLog() {
  Rng rng(4);
  std::vector<double> time_s, turn_rad, forward_m, press_s, nan, x_m, y_m, heading_rad;
  std::vector<std::int32_t> unknown, corner;
  double x = 0, y = 0, heading = 0;
  for (int i = 0; i < 4 * kSide * kLaps; ++i) {
    const double turn = i > 0 && i % kSide == 0 ? M_PI / 2 : 0;
    heading += turn;
    x += std::cos(heading);
    y += std::sin(heading);
    time_s.push_back(i + 1);
    turn_rad.push_back(turn + 0.004 + 0.005 * rng.Normal());
    forward_m.push_back(1 + 0.02 * rng.Normal());
    x_m.push_back(x);
    y_m.push_back(y);
    heading_rad.push_back(std::remainder(heading, 2 * M_PI));
    if ((i + 1) % kPressEvery != 0) continue;
    press_s.push_back(i + 1);
    unknown.push_back(-1);
    corner.push_back((i + 1) / kPressEvery % 4);
    nan.push_back(std::numeric_limits<double>::quiet_NaN());
  }
  Blob log;
  log.Put("robots", Array::Texts({"square"}));
  log.Put("landmarks", Array::Texts({}));
  log.PutVector("robot/0/odometry/time_s", time_s);
  log.PutVector("robot/0/odometry/turn_rad", turn_rad);
  log.PutVector("robot/0/odometry/forward_m", forward_m);
  log.PutVector("robot/0/observations/time_s", press_s);
  log.PutVector("robot/0/observations/landmark", unknown);
  log.PutVector("robot/0/observations/range_m", nan);
  log.PutVector("robot/0/observations/bearing_rad", nan);
  log.PutScalar("noise/heading_drift_rad_per_m", 0.005);
  log.PutScalar("noise/heading_walk_rad_per_sqrt_m", 0.01);
  log.PutScalar("noise/forward_ratio", 0.02);
  log.PutScalar("noise/turn_ratio", 0.02);
  log.PutScalar("noise/press_m", 0.3);
  log.PutVector("truth/robot/0/poses/time_s", time_s);
  log.PutVector("truth/robot/0/poses/x_m", x_m);
  log.PutVector("truth/robot/0/poses/y_m", y_m);
  log.PutVector("truth/robot/0/poses/heading_rad", heading_rad);
  log.PutVector("truth/robot/0/observations/landmark", corner);
  log.Put("truth/landmarks/name", Array::Texts({"a", "b", "c", "d"}));
  log.PutVector<double>("truth/landmarks/x_m", {6, 6, 0, 0});
  log.PutVector<double>("truth/landmarks/y_m", {0, 6, 6, 0});
  return log;
}

BlobPtr Share(Blob blob) { return std::make_shared<const Blob>(std::move(blob)); }

void Set(proto::Stage& stage, const std::string& option, double value) {
  (*stage.mutable_options())[option].set_d(value);
}
void SetInteger(proto::Stage& stage, const std::string& option, std::int64_t value) {
  (*stage.mutable_options())[option].set_i(value);
}

// Inputs and options, by the pipeline's name. A new pipeline adds its branch.
void AddFixture(Case& c) {
  if (c.pipeline == "toy") {
    c.inputs["log"] = Share(testing::ToyLog(60));
    SetInteger(c.stage, "slices", 6);
  } else if (c.pipeline == "landmark_map") {
    c.inputs["log"] = Share(SquareLog());
    Set(c.stage, "cell_m", 0.5);
    Set(c.stage, "heading_deg", 10);
    SetInteger(c.stage, "iterations", 3);
    SetInteger(c.stage, "slice_steps", 20);
  }
}

}  // namespace

std::vector<PipelineInfo> ListAll() {
  std::vector<PipelineInfo> infos = ListPipelines();
  infos.push_back(testing::ToyInfo());
  return infos;
}

std::vector<Case> AllCases() {
  std::vector<Case> cases;
  for (const PipelineInfo& info : ListAll()) {
    Case c;
    c.pipeline = info.name;
    c.stage.set_name("stage");
    c.stage.set_pipeline(info.name);
    AddFixture(c);
    for (const auto& [name, blob] : c.inputs) (*c.stage.mutable_inputs())[name] = name;
    cases.push_back(std::move(c));
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
