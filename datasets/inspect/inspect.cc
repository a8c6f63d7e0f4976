#include "datasets/inspect/inspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/common/array_text.h"
#include "datasets/common/observation_doubts.h"
#include "datasets/common/occupancy.h"
#include "datasets/common/range_sensor_doubts.h"
#include "datasets/common/unit_doubts.h"
#include "datasets/verdicts/grid_map_verdict.h"
#include "datasets/verdicts/landmark_map_verdict.h"
#include "datasets/verdicts/local_map_verdict.h"
#include "datasets/verdicts/localization_verdict.h"
#include "datasets/verdicts/networks_verdict.h"
#include "schema/kinds/grid_map.h"
#include "schema/kinds/inputs_of_time.h"
#include "schema/kinds/kind.h"
#include "schema/kinds/learning.h"
#include "schema/kinds/local_map.h"
#include "schema/kinds/log.h"
#include "schema/kinds/odometry_holes.h"
#include "schema/kinds/robots_without_observations.h"

namespace cairn::datasets {
namespace {

using Facts = std::vector<std::pair<std::string, std::string>>;

std::string Count(std::size_t count, const std::string& of) {
  return fmt::format("{} {}{}", count, of, count == 1 ? "" : "s");
}

std::string Duration(std::span<const double> time_s) {
  return time_s.size() < 2 ? "" : " over " + ShortNumber(time_s.back() - time_s.front()) + " s";
}

// Inspecting forgives what a pipeline would refuse: what is missing, or not as its kind says, counts as
// nothing.
std::string RobotOfLog(const kinds::Log& log, std::size_t n) {
  const kinds::Log::Robot& robot = log.robot[n];
  double travelled = 0;
  for (const double forward : robot.odometry.forward_m.OrNone()) travelled += std::abs(forward);
  const auto time = robot.odometry.time_s.OrNone(), range = robot.observations.range_m.OrNone();
  const auto contacts =
      static_cast<std::size_t>(std::ranges::count_if(range, [](double r) { return std::isnan(r); }));
  std::string text = Count(time.size(), "control") + Duration(time) + ", " + ShortNumber(travelled) + " m, " +
                     Count(range.size(), "observation");
  if (contacts > 0) text += " (" + std::to_string(contacts) + " at the robot)";
  const auto add = [&](const Column<double>& column, const char* what, const char* of) {
    if (!column.OrNone().empty()) text += ", " + Count(column.size(), what) + of;
  };
  add(robot.robot_observations.time_s, "observation", " of other robots");
  for (const kinds::Log::RangeSensor& of : robot.sensors)
    text += ", " + Count(of.time_s.OrNone().size(), "scan") + " of " +
            std::to_string(of.beam_x_m.OrNone().size()) + " beams (" + of.sensor +
            (of.turret_rad ? ", on a turret)" : ")");
  add(robot.hints_time_s, "hint", "");
  add(robot.poses.time_s, "pose", "");
  if (n < log.truth.robot.size()) add(log.truth.robot[n].poses.time_s, "true pose", "");
  return text;
}

std::string RobotOfMap(const kinds::LandmarkMap::Robot& robot) {
  const auto time = robot.poses.time_s.OrNone();
  const auto landmark = robot.map_landmark.OrNone();
  const std::string poses = Count(time.size(), "pose") + Duration(time);
  if (!robot.map_landmark) return poses;
  return poses + ", " +
         std::to_string(std::ranges::count_if(landmark, [](std::int32_t k) { return k >= 0; })) + " of " +
         Count(landmark.size(), "observation") + " associated";
}

// "2599 scans of sonar over 612 s, 260 of them held out"; empty where it has none.
std::string RobotOfGridMap(const kinds::GridMap::Robot& robot) {
  std::string text;
  for (const kinds::GridMap::Sensor& of : robot.sensors) {
    const auto time = of.time_s.OrNone();
    const auto held_out = std::ranges::count_if(of.held_out.OrNone(), [](auto row) { return row != 0; });
    text += (text.empty() ? "" : ", ") + Count(time.size(), "scan") + " of " + of.sensor + Duration(time);
    if (held_out > 0) text += ", " + std::to_string(held_out) + " of them held out";
  }
  return text;
}

std::string Joined(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) joined += (joined.empty() ? "" : ", ") + name;
  return joined;
}

// The path length between the poses, in a straight line from one to the next.
double PathLengthM(std::span<const double> x_m, std::span<const double> y_m) {
  double travelled_m = 0;
  for (std::size_t k = 1; k < std::min(x_m.size(), y_m.size()); ++k)
    travelled_m += std::hypot(x_m[k] - x_m[k - 1], y_m[k] - y_m[k - 1]);
  return travelled_m;
}

// "-1 to 3 m", of a column of all runs; empty where there is none.
std::string Extent(const kinds::Samples& samples, Column<double> kinds::Samples::Run::* column) {
  std::optional<double> low, high;
  for (const kinds::Samples::Run& run : samples.run) {
    for (const double value : (run.*column).OrNone()) {
      low = std::min(low.value_or(value), value);
      high = std::max(high.value_or(value), value);
    }
  }
  return low ? ShortNumber(*low) + " to " + ShortNumber(*high) + " m" : "";
}

void AddSamples(const kinds::Samples& of, Facts* facts) {
  const std::vector<std::string>& runs = of.runs.OrNone();
  std::size_t samples = 0;
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const auto time = of.run[n].time_s.OrNone();
    const double travelled_m = PathLengthM(of.run[n].x_m.OrNone(), of.run[n].y_m.OrNone());
    facts->emplace_back("run " + runs[n], Count(time.size(), "sample") + Duration(time) + ", " +
                                              ShortNumber(travelled_m) + " m");
    samples += time.size();
  }
  facts->emplace_back("samples", Count(samples, "sample") + " in " + Count(runs.size(), "run") + ", " +
                                     Count(of.input_name.OrNone().size(), "input") + " each");
  const std::vector<std::string>& features = of.feature_name.OrNone();
  if (!features.empty()) facts->emplace_back("hand-made features", Joined(features));
  if (!of.label_error_m.OrNone().empty())
    facts->emplace_back("label error", ShortNumber(of.label_error_m[0]) + " m");
  if (!of.run.empty() && of.run[0].image && of.run[0].image.shape().size() == 4) {
    const Shape& shape = of.run[0].image.shape();
    facts->emplace_back("images", std::to_string(shape[1]) + " by " + std::to_string(shape[2]) +
                                      " pixels; `cairn run image_features` makes inputs of them");
  }
  const std::string x = Extent(of, &kinds::Samples::Run::x_m), y = Extent(of, &kinds::Samples::Run::y_m);
  if (!x.empty() && !y.empty()) facts->emplace_back("extent", "x " + x + ", y " + y);
}

// "289 by 134 cells of 0.05 m from (-2.7, -1.6) m; 5120 occupied, 20480 free", above and below a half, of
// those of which anything is known.
std::string GridOf(const kinds::GridMap::Grid& grid) {
  const auto scalar = [](const Column<double>& of) {
    return of.OrNone().empty() ? "?" : ShortNumber(of.front());
  };
  const Shape& shape = grid.probability.shape();
  const std::vector<double> known = KnownProbabilities(grid);
  return std::to_string(shape[1]) + " by " + std::to_string(shape[0]) + " cells of " + scalar(grid.cell_m) +
         " m from (" + scalar(grid.origin_x_m) + ", " + scalar(grid.origin_y_m) + ") m; " +
         std::to_string(std::ranges::count_if(known, [](double p) { return p > 0.5; })) + " occupied, " +
         std::to_string(std::ranges::count_if(known, [](double p) { return p < 0.5; })) + " free";
}

// "54, joined by 961 loops; the path follows 950".
std::string TracesOf(const kinds::LocalMap& map) {
  const auto kind = map.connections.kind.OrNone();
  const auto used = map.connections.used.OrNone();
  constexpr std::int32_t kLoop = 2;
  std::size_t loops = 0, followed = 0;
  for (std::size_t k = 0; k < std::min(kind.size(), used.size()); ++k) {
    loops += kind[k] == kLoop ? 1 : 0;
    followed += kind[k] == kLoop && used[k] != 0 ? 1 : 0;
  }
  return std::to_string(map.traces.robot.size()) + ", joined by " + Count(loops, "loop") +
         "; the path follows " + std::to_string(followed);
}

// How far a result can be trusted; without words where it is none.
Verdict VerdictOf(const Blob& blob) {
  if (blob.Has("map/landmark_x_m")) return LandmarkMapVerdict(blob);
  if (blob.Has("traces/robot")) return LocalMapVerdict(blob);
  const std::string kind = KindOf(blob);
  if (kind == "grid_map") return GridMapVerdict(blob);
  if (kind == "networks") return NetworksVerdict(blob);
  if (kind == "localization") return LocalizationVerdict(blob);
  return {};
}

Facts FactsOf(const Blob& blob) {
  Facts facts;
  if (blob.Has("so_far/what"))
    facts.emplace_back("no result", "a map that is still being made: " + blob.Text("so_far/what"));
  if (blob.Has("runs") && blob.Has("run/0/input")) AddSamples(Read<kinds::Samples>(blob), &facts);
  const auto log = Read<kinds::Log>(blob);
  const auto map = Read<kinds::LandmarkMap>(blob);
  const auto grid_map = Read<kinds::GridMap>(blob);
  for (std::size_t n = 0; n < log.robots.OrNone().size(); ++n) {
    const std::string text = log.robot[n].odometry.time_s ? RobotOfLog(log, n)
                             : grid_map.grid.probability && !map.map.landmark_x_m && n < grid_map.robot.size()
                                 ? RobotOfGridMap(grid_map.robot[n])
                                 : RobotOfMap(map.robot[n]);
    if (!text.empty()) facts.emplace_back("robot " + log.robots[n], text);
  }
  if (log.landmarks)
    facts.emplace_back("identities",
                       log.landmarks.empty() ? "unknown" : Count(log.landmarks.size(), "landmark"));
  if (log.truth.landmarks.name)
    facts.emplace_back("true landmarks", std::to_string(log.truth.landmarks.name.size()));
  if (map.map.landmark_x_m) {
    facts.emplace_back("map landmarks", std::to_string(map.map.landmark_x_m.size()));
    if (map.refinement_reason)
      facts.emplace_back("refinement", NotRefined(blob).empty() ? "done" : NotRefined(blob));
  }
  const kinds::GridMap::Grid& grid = grid_map.grid;
  if (grid.probability && grid.probability.shape().size() == 2) facts.emplace_back("grid", GridOf(grid));
  const auto local = Read<kinds::LocalMap>(blob);
  if (local.traces.robot) facts.emplace_back("traces", TracesOf(local));
  if (const Verdict verdict = VerdictOf(blob); !verdict.why.empty())
    facts.emplace_back("verdict", verdict.Text());
  const auto likelihoods = map.history.log_likelihood.OrNone();
  if (!likelihoods.empty()) {
    facts.emplace_back("iterations", std::to_string(likelihoods.size()) + ", log-likelihood " +
                                         ShortNumber(likelihoods.front()) + " to " +
                                         ShortNumber(likelihoods.back()));
  }
  return facts;
}

std::string Sample(const Array& array) {
  constexpr std::int64_t kShown = 4;
  if (array.size() == 1) return ElementText(array, 0);
  if (array.type() != DType::kText && array.size() > kShown) return {};
  std::string sample;
  for (std::int64_t i = 0; i < std::min(array.size(), kShown); ++i)
    sample += (i == 0 ? "" : ", ") + ElementText(array, i);
  return sample + (array.size() > kShown ? ", …" : "");
}

DatasetSummary Summarize(const DatasetInfo& info, const Array& array) {
  DatasetSummary summary{info, {}, {}, 0, Sample(array)};
  if (array.type() == DType::kText) return summary;
  for (std::int64_t i = 0; i < array.size(); ++i) {
    const double value = ElementNumber(array, i);
    if (!std::isfinite(value)) {
      ++summary.not_finite;
      continue;
    }
    summary.low = summary.low ? std::min(*summary.low, value) : value;
    summary.high = summary.high ? std::max(*summary.high, value) : value;
  }
  if (array.size() > 1 && summary.not_finite > 0) summary.sample.clear();  // how many are not tells more
  return summary;
}

bool IsRightWithoutTruth(const Blob& blob, const std::string& kind) {
  try {
    CheckKind(blob.Without("truth/"), kind);
  } catch (const InputError&) {
    return false;
  }
  return true;
}

}  // namespace

Result<Inspection> Inspect(const std::string& path) {
  const Result<BlobFileInfo> info = ListBlobFile(path);
  if (!info.ok()) return info.status();
  const Result<BlobFile> file = ReadBlobFile(path, {.only = {}, .without = {}, .changed_too = true});
  if (!file.ok()) return file.status();
  const Blob& blob = file.value().blob;
  Inspection inspection{
      info.value().kind, info.value().format, blob.ContentHash().Hex(), FactsOf(blob), {}, {}, {}};
  inspection.changed = file.value().changed;
  const Kind* kind = FindKind(inspection.kind);
  try {
    CheckKind(blob, inspection.kind);
  } catch (const InputError& error) {
    inspection.wrong = error.what();
    inspection.wrong_truth = IsRightWithoutTruth(blob, inspection.kind);
  }
  if (kind != nullptr && kind->has_units) inspection.unit_doubts = FindUnitDoubts(blob);
  inspection.warnings = OdometryHolesOf(blob);
  for (std::string& robot : RobotsWithoutObservationsOf(blob))
    inspection.warnings.push_back(std::move(robot));
  if (inspection.kind == "samples") inspection.warnings = InputsOfTimeOf(blob);
  if (inspection.kind == "log")
    for (const auto& doubts : {ObservationDoubtsOf(blob), RangeSensorDoubtsOf(blob)})
      inspection.warnings.insert(inspection.warnings.end(), doubts.begin(), doubts.end());
  for (const DatasetInfo& dataset : info.value().datasets) {
    inspection.datasets.push_back(Summarize(dataset, blob.at(dataset.name)));
  }
  return inspection;
}

}  // namespace cairn::datasets
