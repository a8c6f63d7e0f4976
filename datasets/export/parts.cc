#include "datasets/export/parts.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <span>
#include <system_error>

#include "datasets/common/array_text.h"
#include "schema/kinds/landmark_map.h"
#include "schema/store/atomic_file.h"
#include "schema/store/checksum_trailer.h"
#include "schema/store/regular_file.h"

namespace cairn::datasets {
namespace {

std::string FileName(const std::string& robot, std::size_t index, std::set<std::string>* taken) {
  constexpr std::size_t kMostBytes = 200;  // file systems take 255, with what comes behind
  std::string name = robot.substr(0, kMostBytes);
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
  }
  // Nor do two names differ in case alone, which some file systems do not tell apart.
  const auto lower = [](std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
  };
  while (name.empty() || !taken->insert(lower(name)).second) name += "_" + std::to_string(index);
  return name;
}

// The probability that a cell holds any landmark: the layers, which may be one, joined.
Occupancy JoinedLayers(const Blob& blob) {
  const Array& layers = blob.at("map/grid/probability");
  const Shape& shape = layers.shape();
  Blob joined;  // read as any grid is, its place and values checked there
  std::vector<double> none(static_cast<std::size_t>(shape[1] * shape[2]), 1.0);
  const auto values = layers.As<double>();
  for (std::size_t i = 0; i < values.size(); ++i) none[i % none.size()] *= 1 - values[i];
  for (double& p : none) p = 1 - p;
  joined.Put("map/grid/probability", Array::Of<double>({shape[1], shape[2]}, none));
  for (const char* name : {"map/grid/origin_x_m", "map/grid/origin_y_m", "map/grid/cell_m"})
    joined.Put(name, blob.at(name));
  return ReadOccupancy(joined);
}

// The file is there and holds these bytes: an export that was cut off is gone on with.
bool Holds(const std::string& path, const std::string& text) {
  const Result<RegularFile> file = RegularFile::Open(path);
  if (!file.ok() || file.value().size() != text.size()) return false;
  std::string bytes(text.size(), '\0');
  return file.value().ReadAt(std::as_writable_bytes(std::span(bytes)), 0) == 0 && bytes == text;
}

// Cut off at any moment, what is left is files of the old export alone or of the new one, which is short of
// some then: never an old map.yaml beside a new map.pgm. So what names others comes last in `changed`.
Status TakeAway(std::span<const std::string> changed) {
  if (changed.size() < 2) return Status::Ok();
  for (std::size_t k = changed.size() - 1; k > 0; --k) {
    const std::filesystem::path path = changed[k];
    std::error_code error;
    if (IsNoFile(path) || std::filesystem::is_directory(path, error)) continue;
    std::filesystem::remove(path, error);
    if (error) return SystemFailure(path, "cannot replace", error.value());
  }
  return SyncFolder(std::filesystem::path(changed[0]).parent_path());
}

}  // namespace

std::vector<Path> ReadPaths(const Blob& blob) {
  std::vector<Path> paths;
  std::set<std::string> taken;
  const std::vector<std::string> robots = blob.Texts("robots");
  for (std::size_t n = 0; n < robots.size(); ++n) {
    std::string prefix = "robot/" + std::to_string(n) + "/poses/";
    if (!blob.Has(prefix + "time_s")) prefix = "truth/" + prefix;
    const kinds::PoseTable poses = kinds::LikeliestPoses(prefix, blob);
    if (!poses.time_s) continue;
    const std::span<const double> covariances = Column<double>::In(blob, prefix + "covariance").OrNone();
    paths.push_back({n,
                     robots[n],
                     FileName(robots[n], n, &taken),
                     poses.time_s.vector(),
                     poses.poses(),
                     {covariances.begin(), covariances.end()}});
  }
  if (paths.empty()) throw InputError("there are no poses in it");
  return paths;
}

std::vector<Path> PathsOf(const Blob& blob) {
  return IsGridMap(blob) ? std::vector<Path>() : ReadPaths(blob);
}

std::int64_t Nanoseconds(double time_s) {
  constexpr double kMost_s = 9.2e9;
  if (!(std::abs(time_s) < kMost_s))
    throw InputError("time " + NumberText(time_s) + " s: nanoseconds are counted to 9.2e9 s (292 years)");
  const double whole_s = std::floor(time_s);
  return static_cast<std::int64_t>(whole_s) * 1'000'000'000 + std::llround((time_s - whole_s) * 1e9);
}

Occupancy ReadCells(const Blob& blob) {
  if (!blob.Has("map/grid/probability") || blob.at("map/grid/probability").size() == 0)
    throw InputError("there is no grid map in it (map/grid/probability)");
  if (IsGridMap(blob)) return ReadOccupancy(blob);
  Occupancy cells = JoinedLayers(blob);
  for (double& p : cells.probability) {
    if (!(p > 0.5)) p = std::numeric_limits<double>::quiet_NaN();
  }
  for (const MapLandmark& landmark : ReadMapLandmarks(blob)) {
    const std::int64_t column = cells.box.ColumnOf(landmark.at.x_m), row = cells.box.RowOf(landmark.at.y_m);
    if (cells.box.Holds(column, row)) cells.probability[cells.box.Index(column, row)] = 1;
  }
  return cells;
}

bool IsGridMap(const Blob& blob) {
  return blob.Has("map/grid/probability") && blob.at("map/grid/probability").shape().size() == 2 &&
         !blob.Has("map/landmark_x_m");
}

std::vector<MapLandmark> ReadMapLandmarks(const Blob& blob) {
  std::vector<MapLandmark> landmarks;
  const auto map = FieldsIn<kinds::LandmarkMap::Map>("map/", blob);
  for (std::size_t k = 0; k < map.landmark_x_m.OrNone().size(); ++k) {
    landmarks.push_back({{map.landmark_x_m[k], map.landmark_y_m[k]}});
    if (!map.landmark_covariance_m2) continue;
    landmarks[k].var_xx_m2 = map.landmark_covariance_m2[4 * k];
    landmarks[k].var_xy_m2 = map.landmark_covariance_m2[4 * k + 1];
    landmarks[k].var_yy_m2 = map.landmark_covariance_m2[4 * k + 3];
  }
  return landmarks;
}

void FolderWriter::Write(const std::string& name, std::string text) {
  files_.emplace_back((std::filesystem::path(folder_) / name).string(), std::move(text));
}

Written FolderWriter::Finish() {
  const auto check_is_new = [&](const std::string& path, const std::string& text) {
    if (!replace_ && std::filesystem::exists(std::filesystem::symlink_status(path)) && !Holds(path, text))
      throw InputError("'" + path + "' is there already (--force replaces it)");
    // It may be what is exported.
    if (store::HasTrailer(path))
      throw InputError("'" + path + "' is a file of Cairn's own, which no export replaces");
  };
  for (const auto& [path, text] : files_) check_is_new(path, text);
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) return SystemFailure(folder_, "cannot make the folder", error.value());
  std::vector<std::string> paths, changed;
  for (const auto& [path, text] : files_) {
    RemoveLeftoversOf(path);
    if (!Holds(path, text)) changed.push_back(path);
  }
  if (replace_)
    if (Status taken = TakeAway(changed); !taken.ok()) return taken;
  for (const auto& [path, text] : files_) {
    const auto bytes = std::as_bytes(std::span(text));
    paths.push_back(path);
    if (!replace_ && Holds(path, text)) continue;
    if (Status status = replace_ ? WriteFileAtomically(path, bytes) : WriteNewFileAtomically(path, bytes);
        !status.ok()) {
      check_is_new(path, text);  // another has come to be there meanwhile
      return status;
    }
  }
  return paths;
}

}  // namespace cairn::datasets
