#include "pipelines/landmark_map/result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/odometry.h"
#include "pipelines/landmark_map/estimate.h"
#include "pipelines/landmark_map/refinement/robot_ties.h"
#include "pipelines/landmark_map/state/given_map.h"
#include "schema/geometry.h"
#include "schema/kinds/constant_observations.h"
#include "schema/kinds/landmark_map.h"
#include "schema/kinds/odometry_steps.h"

namespace cairn::landmark_map {
namespace {

// A pose as the result lists it: mean, covariance, mode.
struct Row {
  double time_s, x_m, y_m, heading_rad, covariance[9], mode_x_m, mode_y_m, mode_heading_rad;
  static void Fields(const auto& field) {
    field("time_s", &Row::time_s);
    field("x_m", &Row::x_m);
    field("y_m", &Row::y_m);
    field("heading_rad", &Row::heading_rad);
    field({"covariance", "P,3,3"}, &Row::covariance);
    field("mode_x_m", &Row::mode_x_m);
    field("mode_y_m", &Row::mode_y_m);
    field("mode_heading_rad", &Row::mode_heading_rad);
  }
};

// Of history/: an iteration.
struct Iteration {
  double log_likelihood, prefix;
  std::int64_t robots, guessed, confirmed;
  static void Fields(const auto& field) {
    field("log_likelihood", &Iteration::log_likelihood);
    field("prefix", &Iteration::prefix);
    field("robots", &Iteration::robots);
    field("guessed", &Iteration::guessed);
    field("confirmed", &Iteration::confirmed);
  }
};

// Of history/: a landmark that stood in the map which an iteration made.
struct EarlierLandmark {
  std::int64_t landmark_iteration;
  double landmark_x_m, landmark_y_m;
  static void Fields(const auto& field) {
    field("landmark_iteration", &EarlierLandmark::landmark_iteration);
    field("landmark_x_m", &EarlierLandmark::landmark_x_m);
    field("landmark_y_m", &EarlierLandmark::landmark_y_m);
  }
};

// A pose and a heading correction at a step.
struct Anchor {
  double x_m, y_m, correction_rad;
};

// Where odometry says `at` is, carried over from step `s` at `anchor`.
Anchor Carry(const RobotSteps& steps, int s, const Anchor& anchor, const OdometricPose& at) {
  const double dx = at.x_m - steps.odo_x_m[s], dy = at.y_m - steps.odo_y_m[s];
  const double cosine = std::cos(anchor.correction_rad), sine = std::sin(anchor.correction_rad);
  return {anchor.x_m + cosine * dx - sine * dy, anchor.y_m + sine * dx + cosine * dy, anchor.correction_rad};
}

// [TBF98] section 5, coarse-grained time: between two steps the position error is interpolated linearly,
// odometry from the earlier one and from the later one, weighed by the distances.
Anchor Between(const RobotSteps& steps, int s, const Anchor& a, const Anchor& b, const OdometricPose& at,
               double part) {
  Anchor middle = a;
  const double turn = WrapAngle(b.correction_rad - a.correction_rad);
  middle.correction_rad = a.correction_rad + part * turn;
  const Anchor from = Carry(steps, s, {a.x_m, a.y_m, a.correction_rad + 0.5 * part * turn}, at);
  const Anchor to = Carry(steps, s + 1, {b.x_m, b.y_m, b.correction_rad - 0.5 * (1.0 - part) * turn}, at);
  middle.x_m = from.x_m + part * (to.x_m - from.x_m);
  middle.y_m = from.y_m + part * (to.y_m - from.y_m);
  return middle;
}

// Where a search found no landmark: what it supposed of the odometry nothing confirms.
std::vector<Blob> DeadReckoned(const RobotSteps& steps, const std::vector<Blob>& summaries) {
  Blob all;
  const std::vector<double> straight(static_cast<std::size_t>(steps.size()), 0.0);
  for (const std::string of : {"pose/", "pose/mode_"}) {
    all.PutVector(of + "x_m", steps.odo_x_m);
    all.PutVector(of + "y_m", steps.odo_y_m);
    all.PutVector(of + "heading_rad", straight);
  }
  all.PutVector("pose/covariance", Joined(summaries, "pose/covariance"));
  return {std::move(all)};
}

// The path of one robot: its steps, and controls between them at least `spacing_m` apart.
class PathWriter {
 public:
  PathWriter(const RobotSteps& steps, const Odometry& odometry, const std::vector<Blob>& summaries,
             double drift_rad_per_m, double spacing_m, double until_s, const RefinedPath* refined)
      : steps_(steps),
        odometry_(odometry),
        drift_rad_per_m_(drift_rad_per_m),
        spacing_m_(spacing_m),
        until_s_(until_s),
        refined_(refined),
        travelled_(steps.DistanceTravelled()),
        path_of_first_(PoseAt(odometry, steps.time_s.front()).path_m),
        mean_{Joined(summaries, "pose/x_m"), Joined(summaries, "pose/y_m"),
              Joined(summaries, "pose/heading_rad")},
        mode_{Joined(summaries, "pose/mode_x_m"), Joined(summaries, "pose/mode_y_m"),
              Joined(summaries, "pose/mode_heading_rad")},
        covariance_(Joined(summaries, "pose/covariance")) {
    // The estimates are relative to odometry without its drift, the path here is written from odometry as it
    // is.
    for (std::size_t s = 0; s < travelled_.size(); ++s) {
      mean_.correction_rad[s] -= drift_rad_per_m * travelled_[s];
      mode_.correction_rad[s] -= drift_rad_per_m * travelled_[s];
    }
  }

  void Write(const std::string& prefix, Blob* result) {
    std::size_t control = 0;
    for (int s = 0; s < steps_.size(); ++s) {
      AddControls(&control, steps_.time_s[s], s - 1);
      Add(PoseOfStep(s), s);
    }
    AddControls(&control, until_s_, steps_.size() - 1);
    PutRows(prefix, rows_, result);
  }

 private:
  struct Table {
    std::vector<double> x_m, y_m, correction_rad;
    Anchor at(int s) const { return {x_m[s], y_m[s], correction_rad[s]}; }
  };

  OdometricPose PoseOfStep(int s) const {
    return {steps_.time_s[s],          steps_.odo_x_m[s], steps_.odo_y_m[s],
            steps_.odo_heading_rad[s], PathOfStep(s),     0.0};
  }
  double PathOfStep(int s) const { return path_of_first_ + travelled_[s]; }

  // The poses at ends of controls before `until_s`, all of which lie after step `s` (-1: before the first).
  void AddControls(std::size_t* control, double until_s, int s) {
    for (; *control < odometry_.time_s.size() && odometry_.time_s[*control] < until_s; ++*control) {
      const OdometricPose at = PoseAt(odometry_, odometry_.time_s[*control]);
      if (rows_.empty() || at.path_m - last_path_m_ >= spacing_m_) Add(at, s);
    }
  }

  // Times increase: of several poses at one time the last one stays.
  void Add(const OdometricPose& at, int s) {
    if (!rows_.empty() && at.time_s <= rows_.back().time_s) rows_.pop_back();
    if (rows_.empty() || at.time_s > rows_.back().time_s) rows_.push_back(RowAt(at, s));
    last_path_m_ = at.path_m;
  }

  // The pose `at` lies at or after step `s` (-1: before the first).
  Row RowAt(const OdometricPose& at, int s) const {
    if (refined_ != nullptr) return RefinedRow(refined_->At(at.time_s), at.time_s);
    const int last = steps_.size() - 1, anchor = std::max(s, 0), next = std::min(anchor + 1, last);
    Anchor mean, mode;
    double part = 0.0;
    if (s >= 0 && s < last) {
      const double travelled = steps_.path_m[s + 1];
      part = travelled > 0 ? std::clamp((at.path_m - PathOfStep(s)) / travelled, 0.0, 1.0) : 0.0;
      mean = Between(steps_, s, mean_.at(s), mean_.at(s + 1), at, part);
      mode = Between(steps_, s, mode_.at(s), mode_.at(s + 1), at, part);
    } else {
      const double turn = -drift_rad_per_m_ * (at.path_m - PathOfStep(anchor));
      mean = Drifting(mean_.at(anchor), anchor, turn, at);
      mode = Drifting(mode_.at(anchor), anchor, turn, at);
    }
    Row row{at.time_s, mean.x_m, mean.y_m, WrapAngle(at.heading_rad + mean.correction_rad),
            {},        mode.x_m, mode.y_m, WrapAngle(at.heading_rad + mode.correction_rad)};
    for (int k = 0; k < 9; ++k) {
      row.covariance[k] =
          covariance_[9 * anchor + k] + part * (covariance_[9 * next + k] - covariance_[9 * anchor + k]);
    }
    return row;
  }

  static Row RefinedRow(const RefinedPath::Pose& pose, double time_s) {
    const double heading_rad = WrapAngle(pose.heading_rad);
    Row row{time_s, pose.x_m, pose.y_m, heading_rad, {}, pose.x_m, pose.y_m, heading_rad};
    for (int k = 0; k < 9; ++k) row.covariance[k] = pose.covariance(k / 3, k % 3);
    return row;
  }

  // Beyond the first or last step: odometry from there on, its drift taken off.
  Anchor Drifting(const Anchor& anchor, int s, double turn, const OdometricPose& at) const {
    Anchor there = Carry(steps_, s, {anchor.x_m, anchor.y_m, anchor.correction_rad + 0.5 * turn}, at);
    there.correction_rad = anchor.correction_rad + turn;
    return there;
  }

  const RobotSteps& steps_;
  const Odometry& odometry_;
  double drift_rad_per_m_, spacing_m_, until_s_;
  const RefinedPath* refined_;  // nullptr: the path is EM's
  std::vector<double> travelled_;
  double path_of_first_;
  double last_path_m_ = 0.0;
  Table mean_, mode_;
  std::vector<double> covariance_;
  std::vector<Row> rows_;
};

void PutAssociations(const RowAssociations& rows, const std::string& prefix, Blob* result) {
  result->PutVector(prefix + "map_landmark", rows.landmark);
  result->PutVector(prefix + "probability", rows.probability);
}

// Nothing where the partials have none.
void PutBeliefs(const RobotSteps& steps, const std::vector<Blob>& summaries, const Settings& settings,
                const std::string& prefix, Blob* result) {
  LayeredGrid beliefs;
  for (const Blob& summary : summaries) {
    if (!summary.Has("belief/box")) return;
    for (Layer& layer : LayeredGrid::LoadSparse("belief/", summary, settings.MostCells()).layers)
      beliefs.layers.push_back(std::move(layer));
  }
  result->PutVector(prefix + "time_s", steps.time_s);
  beliefs.Store(prefix, result);
}

void PutMap(const LayeredGrid& map, const MapRules& rules, Blob* result) {
  const GridSpec& grid = rules.grid;
  const int types = rules.types;
  Box box;
  for (const Layer& layer : map.layers) box = Union(box, layer.box);
  const auto holds = [](const Layer& layer) { return !layer.box.empty(); };
  const bool unknown = types == 0 || std::any_of(map.layers.begin() + types, map.layers.end(), holds);
  const int classes = unknown ? rules.layers() : types;
  std::vector<double> cells;
  cells.reserve(static_cast<std::size_t>(classes * box.cells()));
  for (int type = 0; type < classes; ++type) {
    for (int y = box.y0; y < box.y0 + box.ny; ++y) {
      for (int x = box.x0; x < box.x0 + box.nx; ++x) cells.push_back(map.layers[type].At(x, y));
    }
  }
  result->Put("map/grid/probability", Array::Of<double>({classes, box.ny, box.nx}, cells));
  PutFields("map/grid/",
            kinds::GridPlace{(box.x0 - 0.5) * grid.cell_m, (box.y0 - 0.5) * grid.cell_m, grid.cell_m},
            result);
}

// Names that somebody saw, by `until_s`, whose landmark is not in the map.
void PutNamesThatAreMissing(const kinds::Log& log, const std::vector<Landmark>& landmarks, double until_s,
                            Blob* result) {
  std::set<std::int32_t> missing;
  for (const kinds::Log::Robot& robot : log.robot) {
    const auto time = robot.observations.time_s.OrNone();
    for (std::size_t i = 0; i < time.size() && time[i] <= until_s; ++i)
      if (const std::int32_t name = robot.observations.landmark[i]; name >= 0) missing.insert(name);
  }
  for (const Landmark& landmark : landmarks) missing.erase(landmark.type);
  if (!missing.empty())
    result->PutVector("missing_landmarks", std::vector<std::int32_t>(missing.begin(), missing.end()));
}

// As [K,2,K,2].
void PutJointCovariance(const Eigen::MatrixXd& covariance, Blob* result) {
  if (covariance.size() == 0) return;
  const std::int64_t landmarks = covariance.rows() / 2;
  const std::span values(covariance.data(), static_cast<std::size_t>(covariance.size()));  // symmetric
  result->Put("map/landmark_joint_covariance_m2", Array::Of<double>({landmarks, 2, landmarks, 2}, values));
}

void PutLandmarks(const std::vector<Landmark>& landmarks, const MapRules& rules, Blob* result) {
  const Blob blob = BlobOf(landmarks);
  for (const char* name : {"x_m", "y_m", "covariance_m2", "count"}) {
    result->Put(std::string("map/landmark_") + name, blob.at(name));
  }
  std::vector<std::int32_t> identity;
  for (const Landmark& l : landmarks) identity.push_back(l.type < rules.types ? l.type : -1);
  result->PutVector("map/landmark_identity", identity);
  if (rules.classes.count == 1) return;
  std::vector<std::int32_t> landmark_class;
  for (const Landmark& l : landmarks) landmark_class.push_back(l.type < rules.types ? -1 : l.landmark_class);
  result->PutVector("map/landmark_type", landmark_class);
}

// Leaves out what the log's rate of false observations says is no landmark. Of the others it says how often
// they were passed, unless the log states that none is false: that is what tells where no rate is stated
// (datasets/verdicts/landmarks_seen_once.h).
void JudgePasses(const Settings& settings, const Column<double>& false_ratio,
                 std::vector<Landmark>* landmarks, Eigen::MatrixXd* covariance, Blob* result) {
  const double reach_m = std::max(5.0 * settings.map.observation_m, 1.5 * settings.map.grid.cell_m);
  if (settings.detection.false_ratio > 0.0)
    KeepLandmarks(AreLandmarks(*result, *landmarks, settings.detection, reach_m), landmarks, covariance,
                  result);
  if (false_ratio && false_ratio.Scalar() == 0.0) return;
  std::vector<std::int64_t> passes;
  for (const Passes& of : CountPasses(*result, *landmarks, reach_m)) passes.push_back(of.passed);
  result->PutVector("map/landmark_passes", passes);
}

// And what the log states of what it is held against.
void PutFit(const kinds::Log& log, const Blob& fit, Blob* result) {
  result->PutAll("fit/", fit);
  std::vector<std::uint8_t> told;
  for (const std::string& kind : fit.Texts("kind"))
    told.push_back(kind == "range"     ? bool(log.noise.range_m)
                   : kind == "bearing" ? bool(log.noise.bearing_rad)
                                       : bool(log.noise.contact_m));
  result->PutVector("fit/told", told);
  if (log.noise.false_ratio) result->PutScalar<double>("fit/false_ratio", log.noise.false_ratio.Scalar());
}

// Of the last M-step's counts; where there was none, the given map.
LayeredGrid FinalMap(const Blob& log, const Settings& settings, const Inputs& inputs,
                     const LayeredGrid& counts) {
  if (IsGivenMap(inputs, counts)) return ReadGivenMap(*inputs.Get("map"), log, settings).map;
  return MapFromCounts(counts, settings.map);
}

}  // namespace

Blob EmptyHistory() { return BlobOf(std::vector<Iteration>()); }

Blob Extended(const Blob& history, const Schedule& done, const RoundSum& sum,
              const std::vector<Landmark>& landmarks) {
  auto iterations = RowsIn<Iteration>(history);
  iterations.push_back({sum.log_likelihood(), done.prefix, done.robots, 0, 0});
  for (std::size_t r = 0; r < static_cast<std::size_t>(done.robots); ++r) {
    iterations.back().guessed += sum.guessed(r);
    iterations.back().confirmed += sum.confirmed(r);
  }
  Blob extended = BlobOf(iterations);
  auto earlier =
      history.Has("landmark_x_m") ? RowsIn<EarlierLandmark>(history) : std::vector<EarlierLandmark>();
  for (const Landmark& landmark : landmarks)
    earlier.push_back({std::ssize(iterations) - 1, landmark.x_m, landmark.y_m});
  extended.PutAll("", BlobOf(earlier));
  return extended;
}

Step MakeResult(const Blob& blob, const Settings& settings, const Inputs& inputs, const RoundSum& sum,
                const std::vector<OdometryFit>& odometry, const Blob& history, RefinedMap map) {
  const auto log = Read<kinds::Log>(blob);
  const std::vector<std::string>& robots = log.robots;
  const LayeredGrid counts = CountsIn(inputs, settings);
  const std::vector<RobotSteps>& steps = map.steps;
  std::vector<Landmark>& landmarks = map.landmarks;
  const JointRefinement& refined = map.refined;
  const std::vector<RefinedPath>& paths = refined.paths.empty() ? map.contact_paths : refined.paths;
  const bool is_lost = landmarks.empty() && inputs.Has("search");
  Blob result;
  result.Put("robots", log.robots.array());
  result.Put("landmarks", log.landmarks.array());
  if (settings.map.classes.count > 1) result.Put("types", log.types.array());
  result.Put("log_hash", Array::Text(blob.SourceHash().Hex()));
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const std::string prefix = "robot/" + std::to_string(r) + "/";
    const Odometry track = Until(Integrate(log.robot[r].odometry, robots[r]), settings.steps.until_s);
    const std::vector<Blob> summaries = sum.SummariesOf(r);
    const double em_drift_rad_per_m = is_lost ? 0.0 : odometry[r].drift_rad_per_m;
    PathWriter(steps[r], track, is_lost ? DeadReckoned(steps[r], summaries) : summaries, em_drift_rad_per_m,
               0.5 * settings.map.grid.cell_m, settings.steps.until_s, paths.empty() ? nullptr : &paths[r])
        .Write(prefix + "poses/", &result);
    PutAssociations(map.rows[r], prefix + "observations/", &result);
    if (!is_lost) PutBeliefs(steps[r], summaries, settings, prefix + "beliefs/", &result);
    const double drift_rad_per_m = paths.empty() ? em_drift_rad_per_m : paths[r].errors().drift_rad_per_m;
    result.PutScalar<double>(prefix + "heading_drift_rad_per_m", drift_rad_per_m);
    result.PutScalar<double>(prefix + "heading_walk_rad_per_sqrt_m", odometry[r].heading_walk_rad_per_sqrt_m);
    result.PutScalar<double>(prefix + "turn_ratio", odometry[r].turn_ratio);
    if (!refined.paths.empty()) {
      const SystematicErrors& errors = refined.paths[r].errors();
      result.PutScalar<double>(prefix + "distance_scale", 1 + errors.way);
      result.PutScalar<double>(prefix + "turn_scale", 1 + errors.turn);
      if (errors.range_m != 0.0) result.PutScalar<double>(prefix + "range_offset_m", errors.range_m);
      const SensorShift& sensor = refined.sensors[r];
      if (sensor.late_s != 0.0) result.PutScalar(prefix + "observations_late_s", sensor.late_s);
      if (sensor.x_m != 0.0) result.PutScalar(prefix + "sensor_x_m", sensor.x_m);
      if (sensor.y_m != 0.0) result.PutScalar(prefix + "sensor_y_m", sensor.y_m);
      if (const double half_m = HalfStep_m(log.robot[r].odometry);
          half_m != 0.0 && (sensor.x_m != 0.0 || sensor.y_m != 0.0))
        result.PutScalar(prefix + "half_step_m", half_m);
      if (sensor.turned_rad != 0.0) result.PutScalar(prefix + "bearings_turned_rad", sensor.turned_rad);
      const EdgeWidths& widths = refined.paths[r].widths();
      result.PutScalar<double>(prefix + "odometry_walk_rad_per_sqrt_m", widths.walk_rad_per_sqrt_m);
      result.PutScalar<double>(prefix + "odometry_turn_rad_per_sqrt_rad", widths.turn_rad_per_sqrt_rad);
      result.PutScalar<double>(prefix + "odometry_way_m_per_sqrt_m", widths.way_m_per_sqrt_m);
    }
  }
  if (const double until_s = settings.steps.until_s; std::isfinite(until_s)) {
    result.PutScalar<double>("until_s", until_s);
    std::int64_t looked_at = 0;
    for (const kinds::Log::Robot& robot : log.robot)
      looked_at += std::ranges::count_if(robot.observations.time_s.values(),
                                         [&](double time_s) { return time_s <= until_s; });
    result.PutScalar<std::int64_t>("until_observations", looked_at);
  }
  PutTies(blob, refined, map.rows, landmarks, settings, &result);
  if (settings.detection.tells_passes && !settings.incremental)
    JudgePasses(settings, log.noise.false_ratio, &landmarks, &map.covariance, &result);
  PutLandmarks(landmarks, settings.map, &result);
  PutJointCovariance(map.covariance, &result);
  PutNamesThatAreMissing(log, landmarks, settings.steps.until_s, &result);
  const bool counted_elsewhere = map.along_odometry || (map.shift && map.shift->taken);
  const LayeredGrid final_counts = counted_elsewhere ? CountsFromLandmarks(landmarks, settings)
                                   : refined.paths.empty()
                                       ? counts
                                       : Recentred(counts, map.found, landmarks, settings);
  PutMap(FinalMap(blob, settings, inputs, final_counts), settings.map, &result);
  result.PutAll("history/", history);
  result.PutScalar<std::uint8_t>("refinement/done", map.not_refined.empty() ? 1 : 0);
  result.Put("refinement/reason", Array::Text(map.not_refined));
  if (map.along_odometry) result.PutScalar<std::uint8_t>("refinement/along_odometry", 1);
  if (const auto doubts = ConstantObservationsOf(blob); !doubts.empty())
    result.Put("observation_doubts", Array::Texts(doubts));
  if (!refined.paths.empty()) PutFit(log, refined.fit.ToBlob(refined.landmarks, settings.map.types), &result);
  if (map.shift) {
    result.PutScalar<double>("fit/shift_m", map.shift->by_m);
    result.PutScalar<double>("fit/shift_from_s", map.shift->from_s);
    result.PutScalar<double>("fit/shift_until_s", map.shift->until_s);
    result.PutScalar<double>("fit/shift_lead_nats", map.shift->lead_nats);
    result.PutScalar<std::uint8_t>("fit/shift_taken", map.shift->taken ? 1 : 0);
  }
  if (!map.moved.empty()) result.PutAll("moved/", BlobOf(map.moved));
  if (inputs.Has("search")) result.PutAll("search/", *inputs.Get("search"));
  Step step;
  step.plan.set_result(step.Share(std::move(result)));
  step.plan.set_note(
      fmt::format("{} landmarks, log-likelihood {:.2f}", landmarks.size(), sum.log_likelihood()));
  return step;
}

}  // namespace cairn::landmark_map
