#include "datasets/inspect/inspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/common/array_text.h"
#include "datasets/common/confidence.h"
#include "datasets/common/unit_doubts.h"
#include "schema/kinds/kind.h"

namespace cairn::datasets {
namespace {

using Facts = std::vector<std::pair<std::string, std::string>>;

// A column where the file has it as its kind says, else empty: inspecting forgives what a pipeline would
// refuse.
template <class T>
std::span<const T> ColumnOrNone(const Blob& blob, const std::string& name) {
  if (!blob.Has(name) || blob.at(name).type() != DTypeOf<T>()) return {};
  return blob.Get<T>(name);
}

std::vector<std::string> TextsOrNone(const Blob& blob, const std::string& name) {
  if (!blob.Has(name) || blob.at(name).type() != DType::kText) return {};
  return blob.Texts(name);
}

std::string Count(std::size_t count, const std::string& of) {
  return fmt::format("{} {}{}", count, of, count == 1 ? "" : "s");
}

std::string Duration(std::span<const double> time_s) {
  return time_s.size() < 2 ? "" : " over " + ShortNumber(time_s.back() - time_s.front()) + " s";
}

std::string RobotOfLog(const Blob& blob, const std::string& prefix) {
  const auto time = ColumnOrNone<double>(blob, prefix + "odometry/time_s");
  double travelled = 0;
  for (const double forward : ColumnOrNone<double>(blob, prefix + "odometry/forward_m"))
    travelled += std::abs(forward);
  const auto range = ColumnOrNone<double>(blob, prefix + "observations/range_m");
  const auto contacts =
      static_cast<std::size_t>(std::ranges::count_if(range, [](double r) { return std::isnan(r); }));
  std::string text = Count(time.size(), "control") + Duration(time) + ", " + ShortNumber(travelled) + " m, " +
                     Count(range.size(), "observation");
  if (contacts > 0) text += fmt::format(" ({} at the robot)", contacts);
  const auto robot_observations = ColumnOrNone<double>(blob, prefix + "robot_observations/time_s");
  if (!robot_observations.empty())
    text += ", " + Count(robot_observations.size(), "observation") + " of other robots";
  for (const auto& [name, array] : blob.fields()) {
    constexpr std::string_view kBeams = "/beam_x_m";
    if (!name.starts_with(prefix) || !name.ends_with(kBeams)) continue;
    const std::string sensor = name.substr(0, name.size() - kBeams.size());
    text += ", " + Count(ColumnOrNone<double>(blob, sensor + "/time_s").size(), "scan") + " of " +
            std::to_string(array.size()) + " beams (" + sensor.substr(prefix.size()) +
            (blob.Has(sensor + "/turret_rad") ? ", on a turret)" : ")");
  }
  const auto hints = ColumnOrNone<double>(blob, prefix + "hints/time_s");
  if (!hints.empty()) text += ", " + Count(hints.size(), "hint");
  const auto poses = ColumnOrNone<double>(blob, prefix + "poses/time_s");
  if (!poses.empty()) text += ", " + Count(poses.size(), "pose");
  const auto truth = ColumnOrNone<double>(blob, "truth/" + prefix + "poses/time_s");
  if (!truth.empty()) text += ", " + Count(truth.size(), "true pose");
  return text;
}

std::string RobotOfMap(const Blob& blob, const std::string& prefix) {
  const auto time = ColumnOrNone<double>(blob, prefix + "poses/time_s");
  const auto landmark = ColumnOrNone<std::int32_t>(blob, prefix + "observations/map_landmark");
  const auto associated =
      static_cast<std::size_t>(std::ranges::count_if(landmark, [](std::int32_t k) { return k >= 0; }));
  const std::string poses = Count(time.size(), "pose") + Duration(time);
  if (!blob.Has(prefix + "observations/map_landmark")) return poses;
  return fmt::format("{}, {} of {} associated", poses, associated, Count(landmark.size(), "observation"));
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
std::string Extent(const Blob& blob, std::size_t runs, const std::string& column) {
  std::optional<double> low, high;
  for (std::size_t n = 0; n < runs; ++n) {
    for (const double value : ColumnOrNone<double>(blob, "run/" + std::to_string(n) + "/" + column)) {
      low = std::min(low.value_or(value), value);
      high = std::max(high.value_or(value), value);
    }
  }
  return low ? ShortNumber(*low) + " to " + ShortNumber(*high) + " m" : "";
}

void AddSamples(const Blob& blob, Facts* facts) {
  const std::vector<std::string> runs = TextsOrNone(blob, "runs"), inputs = TextsOrNone(blob, "input_name");
  std::size_t samples = 0;
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const std::string prefix = "run/" + std::to_string(n) + "/";
    const auto time = ColumnOrNone<double>(blob, prefix + "time_s");
    const double travelled_m =
        PathLengthM(ColumnOrNone<double>(blob, prefix + "x_m"), ColumnOrNone<double>(blob, prefix + "y_m"));
    facts->emplace_back("run " + runs[n], Count(time.size(), "sample") + Duration(time) + ", " +
                                              ShortNumber(travelled_m) + " m");
    samples += time.size();
  }
  facts->emplace_back("samples", Count(samples, "sample") + " in " + Count(runs.size(), "run") + ", " +
                                     Count(inputs.size(), "input") + " each");
  const std::vector<std::string> features = TextsOrNone(blob, "feature_name");
  if (!features.empty()) facts->emplace_back("hand-made features", Joined(features));
  if (blob.Has("label_error_m") && !ColumnOrNone<double>(blob, "label_error_m").empty())
    facts->emplace_back("label error",
                        ShortNumber(ColumnOrNone<double>(blob, "label_error_m").front()) + " m");
  if (blob.Has("run/0/image")) {
    const Shape& shape = blob.at("run/0/image").shape();
    if (shape.size() == 4)
      facts->emplace_back(
          "images", fmt::format("{} by {} pixels; `cairn run image_features` makes inputs of them", shape[1],
                                shape[2]));
  }
  const std::string x = Extent(blob, runs.size(), "x_m"), y = Extent(blob, runs.size(), "y_m");
  if (!x.empty() && !y.empty()) facts->emplace_back("extent", "x " + x + ", y " + y);
}

// "289 by 134 cells of 0.05 m from (-2.7, -1.6) m; 5120 occupied, 20480 free", above and below a half.
std::string GridOf(const Blob& blob) {
  const auto scalar = [&](const char* name) {
    const auto value = ColumnOrNone<double>(blob, std::string("map/grid/") + name);
    return value.empty() ? "?" : ShortNumber(value.front());
  };
  const Shape& shape = blob.at("map/grid/probability").shape();
  const auto probability = ColumnOrNone<double>(blob, "map/grid/probability");
  return fmt::format("{} by {} cells of {} m from ({}, {}) m; {} occupied, {} free", shape[1], shape[0],
                     scalar("cell_m"), scalar("origin_x_m"), scalar("origin_y_m"),
                     std::ranges::count_if(probability, [](double p) { return p > 0.5; }),
                     std::ranges::count_if(probability, [](double p) { return p < 0.5; }));
}

// "54, joined by 961 loops; the path follows 950".
std::string TracesOf(const Blob& blob) {
  const auto kind = ColumnOrNone<std::int32_t>(blob, "connections/kind");
  const auto used = ColumnOrNone<std::uint8_t>(blob, "connections/used");
  constexpr std::int32_t kLoop = 2;
  std::size_t loops = 0, followed = 0;
  for (std::size_t k = 0; k < std::min(kind.size(), used.size()); ++k) {
    loops += kind[k] == kLoop ? 1 : 0;
    followed += kind[k] == kLoop && used[k] != 0 ? 1 : 0;
  }
  return fmt::format("{}, joined by {}; the path follows {}", blob.at("traces/robot").size(),
                     Count(loops, "loop"), followed);
}

Facts FactsOf(const Blob& blob) {
  Facts facts;
  if (blob.Has("runs") && blob.Has("run/0/input")) AddSamples(blob, &facts);
  const std::vector<std::string> robots = TextsOrNone(blob, "robots");
  for (std::size_t n = 0; n < robots.size(); ++n) {
    const std::string prefix = "robot/" + std::to_string(n) + "/";
    const bool log = blob.Has(prefix + "odometry/time_s");
    facts.emplace_back("robot " + robots[n], log ? RobotOfLog(blob, prefix) : RobotOfMap(blob, prefix));
  }
  if (blob.Has("landmarks")) {
    const std::size_t count = TextsOrNone(blob, "landmarks").size();
    facts.emplace_back("identities", count == 0 ? "unknown" : Count(count, "landmark"));
  }
  if (blob.Has("truth/landmarks/name")) {
    facts.emplace_back("true landmarks", std::to_string(TextsOrNone(blob, "truth/landmarks/name").size()));
  }
  if (blob.Has("map/landmark_x_m")) {
    facts.emplace_back("map landmarks",
                       std::to_string(ColumnOrNone<double>(blob, "map/landmark_x_m").size()));
    facts.emplace_back("confidence", ConfidenceText(blob));
    if (blob.Has("refinement/reason"))
      facts.emplace_back("refinement", NotRefined(blob).empty() ? "done" : NotRefined(blob));
  }
  if (blob.Has("map/grid/probability") && blob.at("map/grid/probability").shape().size() == 2)
    facts.emplace_back("grid", GridOf(blob));
  if (blob.Has("traces/robot")) facts.emplace_back("traces", TracesOf(blob));
  const auto likelihoods = ColumnOrNone<double>(blob, "history/log_likelihood");
  if (!likelihoods.empty()) {
    facts.emplace_back(blob.Has("map/landmark_x_m") ? "iterations" : "rounds",
                       std::to_string(likelihoods.size()) + ", log-likelihood " +
                           ShortNumber(likelihoods.front()) + " to " + ShortNumber(likelihoods.back()));
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

}  // namespace

Result<Inspection> Inspect(const std::string& path) {
  const Result<BlobFileInfo> info = ListBlobFile(path);
  if (!info.ok()) return info.status();
  const Result<BlobFile> file = ReadBlobFile(path, {.only = {}, .without = {}, .changed_too = true});
  if (!file.ok()) return file.status();
  const Blob& blob = file.value().blob;
  Inspection inspection{
      info.value().kind, info.value().format, blob.ContentHash().Hex(), FactsOf(blob), {}, {}};
  inspection.changed = file.value().changed;
  const Kind* kind = FindKind(inspection.kind);
  try {
    CheckKind(blob, inspection.kind);
  } catch (const InputError& error) {
    inspection.wrong = error.what();
  }
  if (kind != nullptr && kind->has_units) inspection.unit_doubts = FindUnitDoubts(blob);
  for (const DatasetInfo& dataset : info.value().datasets) {
    inspection.datasets.push_back(Summarize(dataset, blob.at(dataset.name)));
  }
  return inspection;
}

}  // namespace cairn::datasets
