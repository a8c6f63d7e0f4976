#include "datasets/reproduce/occupancy/study.h"

#include <limits>
#include <numbers>

#include "datasets/reproduce/study_inputs.h"
#include "datasets/simulate/hall/hall.h"
#include "datasets/simulate/loop.h"

namespace cairn::datasets {
namespace {

constexpr double kHeldOut = 0.1;
constexpr double kLoopCellM = 0.25;

// Figure 1: a long reading whose cone is free up to its end, and a short one from the side whose end lies
// half in that cone.
Blob CrossingLog() {
  Blob log;
  log.Put("robots", Array::Texts({"robot 0"}));
  log.PutVector<double>("robot/0/poses/time_s", {1, 2});
  log.PutVector<double>("robot/0/poses/x_m", {0, 2.4});
  log.PutVector<double>("robot/0/poses/y_m", {0, 0});
  log.PutVector<double>("robot/0/poses/heading_rad", {std::numbers::pi / 4, 3 * std::numbers::pi / 4});
  log.PutVector<double>("robot/0/sonar/time_s", {1, 2});
  log.Put("robot/0/sonar/range_m", Array::Of<double>({2, 1}, std::vector<double>{2.6, 1.2}));
  for (const char* name : {"beam_x_m", "beam_y_m", "beam_heading_rad"})
    log.PutVector<double>(std::string("robot/0/sonar/") + name, {0});
  log.PutScalar("robot/0/sonar/opening_rad", 0.6);
  log.PutScalar("robot/0/sonar/max_range_m", 6.0);
  return log;
}

class StudyMaker {
 public:
  explicit StudyMaker(OccupancyStudy* study) : study_(study) {}

  proto::Stage& Add(const std::string& name, const char* pipeline, const std::string& log,
                    double heldout = 0) {
    proto::Stage& stage = *study_->job.add_stages();
    stage.set_name(name);
    stage.set_pipeline(pipeline);
    (*stage.mutable_inputs())["log"] = log;
    if (heldout > 0) (*stage.mutable_options())["heldout"].set_d(heldout);
    return stage;
  }

  void AddEvidence(const std::string& name, const std::string& log, const InverseSonar& sonar,
                   double heldout = 0) {
    auto& options = *Add(name, "evidence_map", log, heldout).mutable_options();
    options["sonar_p_occupied"].set_d(sonar.p_occupied);
    options["sonar_p_free"].set_d(sonar.p_free);
    options["graded"].set_b(sonar.graded);
    options["wall_m"].set_d(sonar.wall_m);
  }

  void AddBoth(const std::string& name, const std::string& log, double heldout = 0) {
    AddEvidence(name + "_evidence", log, ChosenInverseSonar(), heldout);
    Add(name + "_default", "evidence_map", log, heldout);
    Add(name + "_forward", "forward_map", log, heldout);
  }

  void AddSettings(const std::string& log) {
    const std::vector<InverseSonar> settings = InverseSonars();
    for (std::size_t k = 0; k < settings.size(); ++k)
      AddEvidence(log + "_setting_" + std::to_string(k), log, settings[k]);
  }

  // The papers' chain: poses by landmark_map, maps at them, and one at those of odometry alone.
  void AddChain() {
    Add("loop_landmarks", "landmark_map", "loop");
    for (const char* name : {"loop_raw", "loop_evidence", "loop_forward"}) {
      proto::Stage& stage =
          Add(name, name == std::string("loop_forward") ? "forward_map" : "evidence_map", "loop");
      (*stage.mutable_options())["cell_m"].set_d(kLoopCellM);
      if (name != std::string("loop_raw")) (*stage.mutable_inputs())["poses"] = "loop_landmarks";
    }
  }

  void AddHalls(std::uint64_t seed, int seeds) {
    for (int k = 0; k < seeds; ++k) {
      for (const int readings : {1, 3, 16}) {
        for (const bool closed : {false, true}) {
          HallCase hall{"", readings, closed, seed + static_cast<std::uint64_t>(k)};
          hall.name = "hall_" + std::to_string(hall.seed) + "_" + std::to_string(readings) +
                      (closed ? "_closed" : "_open");
          study_->inputs[hall.name] =
              SimulateHallway({.door_readings = readings, .closed = closed, .seed = hall.seed});
          study_->halls.push_back(std::move(hall));
        }
      }
    }
  }

  void Finish(const std::string& name, std::uint64_t seed) {
    study_->job.set_name(name);
    study_->job.set_seed(seed);
    NameInputs(study_->inputs, &study_->job);
  }

 private:
  OccupancyStudy* study_;
};

}  // namespace

std::vector<InverseSonar> InverseSonars() {
  std::vector<InverseSonar> settings;
  struct Shape {
    bool graded;
    double wall_m;
  };
  for (const Shape& shape : {Shape{true, 0.1}, {false, 0.1}, {false, 0.03}}) {
    for (const double p : {0.502, 0.505, 0.51, 0.525, 0.55, 0.6, 0.7})
      settings.push_back({p, 0.45, shape.graded, shape.wall_m});
  }
  return settings;
}

InverseSonar ChosenInverseSonar() { return {0.51, 0.45, false, 0.03}; }

OccupancyStudy MakeOccupancyStudy(std::uint64_t seed, int seeds, const Blob* log) {
  OccupancyStudy study;
  StudyMaker make(&study);
  study.inputs["crossing"] = CrossingLog();
  study.inputs["doors"] = SimulateNarrowDoors(seed);
  study.inputs["smooth"] = SimulateSmoothWall(seed);
  if (log != nullptr) study.inputs["log"] = *log;
  study.inputs["loop"] = SimulateLoop({.difficulty = "paper", .seed = seed, .sonar = true});
  make.AddHalls(seed, seeds);
  make.AddBoth("crossing", "crossing");
  for (const HallCase& hall : study.halls) make.AddBoth(hall.name, hall.name);
  for (const char* name : {"doors", "smooth"}) {
    make.AddBoth(name, name);
    make.AddBoth(name + std::string("_heldout"), name, kHeldOut);
  }
  make.AddSettings("smooth");
  make.AddChain();
  if (log != nullptr) make.AddBoth("log", "log", kHeldOut);
  make.Finish("reproduce-occupancy", seed);
  return study;
}

OccupancyStudy MakeCurveStudy(std::uint64_t seed, int seeds) {
  OccupancyStudy study;
  StudyMaker make(&study);
  make.AddHalls(seed, seeds);
  for (const HallCase& hall : study.halls) make.AddSettings(hall.name);
  make.Finish("reproduce-occupancy-curve", seed);
  return study;
}

}  // namespace cairn::datasets
