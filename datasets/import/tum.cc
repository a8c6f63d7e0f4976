#include "datasets/import/tum.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "datasets/common/fields.h"
#include "datasets/common/text_file.h"
#include "datasets/import/row_times.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr std::size_t kTum = 8, kPlanar = 4;

std::string NameOf(const std::string& path) {
  std::string name = std::filesystem::path(path).filename().string();
  for (const char* ending : {".gz", ".tum", ".txt"}) {
    if (name.ends_with(ending) && name != ending) name.resize(name.size() - std::string_view(ending).size());
  }
  return name;
}

// How far the poses leave the plane.
struct Tilt {
  double low_m = INFINITY, high_m = -INFINITY, most_rad = 0;
};

double HeadingOf(const Fields& line, Tilt* tilt) {
  const double x = line.Number(4), y = line.Number(5), z = line.Number(6), w = line.Number(7);
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  if (!(std::abs(length - 1) <= 0.01))
    throw LineError{"no quaternion", "its length is " + std::to_string(length)};
  tilt->low_m = std::min(tilt->low_m, line.Number(3));
  tilt->high_m = std::max(tilt->high_m, line.Number(3));
  tilt->most_rad = std::max(tilt->most_rad, 2 * std::asin(std::min(1.0, std::hypot(x, y) / length)));
  return std::atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z);
}

void AddPose(const Fields& line, std::size_t number, Poses* poses, Tilt* tilt) {
  if (line.size() != kTum && line.size() != kPlanar)
    throw LineError{"wrong number of values", std::to_string(line.size()) + " where 8 (or 4) are needed"};
  const double time = line.Stamp(0);
  const Pose at = line.PoseAt(1);
  const double heading = line.size() == kTum ? HeadingOf(line, tilt) : at.heading_rad;
  if (!poses->time_s.empty() && time <= poses->time_s.back())
    throw LineError{"time does not run forward", std::to_string(time) + " after " +
                                                     std::to_string(poses->time_s.back()) +
                                                     HintOfSameTime(time, poses->time_s.back())};
  poses->Add(time, at.x_m, at.y_m, heading, number);
}

void WarnOfTilt(const std::string& path, const Tilt& tilt, ImportReport* report) {
  constexpr double kHigh_m = 0.5, kTilt_rad = 5 * std::numbers::pi / 180;
  if (tilt.high_m - tilt.low_m > kHigh_m)
    report->warnings.push_back(path + ": heights differ by " + std::to_string(tilt.high_m - tilt.low_m) +
                               " m; they are forgotten");
  if (tilt.most_rad > kTilt_rad)
    report->warnings.push_back(path + ": poses are tilted by up to " +
                               std::to_string(tilt.most_rad * 180 / std::numbers::pi) +
                               " degrees; that is forgotten");
}

}  // namespace

ImportReport ImportTum(const TumImportOptions& options, Blob* poses) {
  BadLines bad(options.skip_bad);
  ImportReport report;
  std::vector<std::string> names = options.robots;
  if (names.empty()) {
    for (const std::string& file : options.files) names.push_back(NameOf(file));
  }
  if (names.size() != options.files.size())
    throw InputError(std::to_string(names.size()) + " names for " + std::to_string(options.files.size()) +
                     " trajectories");
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(n), names[n]) !=
        names.begin() + static_cast<std::ptrdiff_t>(n))
      throw InputError(options.files[n] + ": a second robot is called '" + names[n] + "'");
    Poses rows;
    Tilt tilt;
    ForEachLine(options.files[n], &bad,
                [&](const Fields& line, std::size_t number) { AddPose(line, number, &rows, &tilt); });
    if (rows.time_s.empty()) throw InputError(options.files[n] + ": there is no pose in it");
    rows.from.file = options.files[n];
    DoubtPosesOf(rows, "robot '" + names[n] + "'", "poses", &report);
    WarnOfTilt(options.files[n], tilt, &report);
    PutPoses("robot/" + std::to_string(n) + "/poses/", rows, poses);
  }
  poses->Put("robots", Array::Texts(names));
  report.robots = static_cast<std::int64_t>(names.size());
  report.skipped = bad.counts();
  return report;
}

}  // namespace cairn::datasets
