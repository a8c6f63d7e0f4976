#include "datasets/import/trajectories.h"

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

using Format = TrajectoryImportOptions::Format;

std::string NameOf(const std::string& path) {
  std::string name = std::filesystem::path(path).filename().string();
  for (const char* ending : {".gz", ".tum", ".kitti", ".csv", ".txt"}) {
    if (name.ends_with(ending) && name != ending) name.resize(name.size() - std::string_view(ending).size());
  }
  return name;
}

struct Extent {
  double low_m = INFINITY, high_m = -INFINITY;
  void Add(double at_m) {
    low_m = std::min(low_m, at_m);
    high_m = std::max(high_m, at_m);
  }
  double length_m() const { return std::max(0.0, high_m - low_m); }
};

// How far the poses leave the plane; and how far they would, were they written as others write them: with the
// real part of quaternions at the other end, or a camera's axes.
struct Tilt {
  Extent up, other_up;
  double most_rad = 0;
  std::size_t poses = 0, tilted = 0, other_tilted = 0;
  void Add(double height_m, double tilt_rad, double other_height_m, double other_tilt_rad) {
    constexpr double kTilted_rad = std::numbers::pi / 6;
    up.Add(height_m);
    other_up.Add(other_height_m);
    most_rad = std::max(most_rad, tilt_rad);
    ++poses;
    tilted += tilt_rad > kTilted_rad ? 1 : 0;
    other_tilted += other_tilt_rad > kTilted_rad ? 1 : 0;
  }
};

void RequireLengthOne(double length, const char* what) {
  if (!(std::abs(length - 1) <= 0.01)) throw LineError{what, "its length is " + std::to_string(length)};
}

void RequireSize(const Fields& line, bool is_right, const char* needed) {
  if (!is_right)
    throw LineError{"wrong number of values",
                    std::to_string(line.size()) + " where " + needed + " are needed"};
}

// z in field 3; a quaternion from field 4 on, its real part, w, first or last.
double HeadingOf(const Fields& line, bool real_first, Tilt* tilt) {
  const std::size_t imaginary = real_first ? 5 : 4;
  const double w = line.Number(real_first ? 4 : 7), x = line.Number(imaginary),
               y = line.Number(imaginary + 1), z = line.Number(imaginary + 2);
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  RequireLengthOne(length, "no quaternion");
  const auto tilt_rad = [length](double a, double b) {
    return 2 * std::asin(std::min(1.0, std::hypot(a, b) / length));
  };
  // What would be x and y, were the real part at the other end.
  tilt->Add(line.Number(3), tilt_rad(x, y), line.Number(3), real_first ? tilt_rad(w, x) : tilt_rad(y, z));
  return std::atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z);
}

struct Row {
  double time_s;
  Pose pose;
};

Row TumRow(const Fields& line, Tilt* tilt) {
  constexpr std::size_t kTum = 8, kPlanar = 4;
  RequireSize(line, line.size() == kTum || line.size() == kPlanar, "8 (or 4)");
  Row row{line.Stamp(0), line.PoseAt(1)};
  if (line.size() == kTum) row.pose.heading_rad = HeadingOf(line, false, tilt);
  return row;
}

Row EurocRow(const Fields& line, Tilt* tilt) {
  RequireSize(line, line.size() >= 8, "8 and more");
  Row row{line.Stamp(0, 1e9), line.PoseAt(1)};
  row.pose.heading_rad = HeadingOf(line, true, tilt);
  return row;
}

// Rows of a matrix: what stands in column 3 is the place. A camera's axes are x to the right, y down, z
// ahead: a robot's x is its z, and so of the world, its y the other way round.
Row KittiRow(const Fields& line, double time_s, bool camera_axes, Tilt* tilt) {
  RequireSize(line, line.size() == 12, "12");
  const auto at = [&line](std::size_t row, std::size_t column) { return line.Number(4 * row + column); };
  for (std::size_t row = 0; row < 3; ++row)
    RequireLengthOne(std::hypot(at(row, 0), at(row, 1), at(row, 2)), "no rotation");
  const auto minor = [&at](std::size_t a, std::size_t b) {
    return at(1, a) * at(2, b) - at(1, b) * at(2, a);
  };
  const double determinant = at(0, 0) * minor(1, 2) - at(0, 1) * minor(0, 2) + at(0, 2) * minor(0, 1);
  constexpr double kRounded = 0.05;  // as far as rows of almost one's length at almost right angles go
  if (!(std::abs(determinant - 1) <= kRounded))
    throw LineError{"no rotation", "its determinant is " + std::to_string(determinant) +
                                       (determinant < 0 ? ": one axis points the other way" : "")};
  const std::size_t ahead = camera_axes ? 2 : 0, aside = camera_axes ? 0 : 1, up = camera_axes ? 1 : 2;
  const double sign = camera_axes ? -1 : 1;
  const std::size_t other_up = camera_axes ? 2 : 1;
  const auto tilt_rad = [&](std::size_t axis) { return std::acos(std::clamp(at(axis, axis), -1.0, 1.0)); };
  tilt->Add(sign * at(up, 3), tilt_rad(up), at(other_up, 3), tilt_rad(other_up));
  return {time_s,
          {line.Place(4 * ahead + 3), sign * line.Place(4 * aside + 3),
           std::atan2(sign * at(aside, ahead), at(ahead, ahead))}};
}

class TrajectoryReader {
 public:
  TrajectoryReader(const TrajectoryImportOptions& options, BadLines* bad) : options_(options), bad_(bad) {}

  Poses Read(std::size_t n, Tilt* tilt) {
    const std::string& file = options_.files[n];
    const bool kitti = options_.format == Format::kKitti;
    std::vector<double> times;
    if (kitti)
      ForEachLine(options_.times.at(n), bad_,
                  [&](const Fields& line, std::size_t) { times.push_back(line.Stamp(0)); });
    Poses poses;
    std::size_t lines = 0;
    ForEachLine(
        file, bad_,
        [&](const Fields& line, std::size_t number) {
          const std::size_t index = lines++;
          if (kitti && index >= times.size()) return;
          Add(kitti                               ? KittiRow(line, times[index], options_.camera_axes, tilt)
              : options_.format == Format::kEuroc ? EurocRow(line, tilt)
                                                  : TumRow(line, tilt),
              number, &poses);
        },
        options_.format == Format::kEuroc);
    if (kitti && lines != times.size())
      throw InputError(file + ": it has " + std::to_string(lines) + " poses, '" + options_.times[n] + "' " +
                       std::to_string(times.size()) + " times");
    if (poses.time_s.empty()) throw InputError(file + ": there is no pose in it");
    poses.from.file = file;
    return poses;
  }

 private:
  static void Add(const Row& row, std::size_t number, Poses* poses) {
    if (!poses->time_s.empty() && row.time_s <= poses->time_s.back())
      throw LineError{"time does not run forward", std::to_string(row.time_s) + " after " +
                                                       std::to_string(poses->time_s.back()) +
                                                       HintOfSameTime(row.time_s, poses->time_s.back())};
    poses->Add(row.time_s, row.pose.x_m, row.pose.y_m, row.pose.heading_rad, number);
  }

  const TrajectoryImportOptions& options_;
  BadLines* bad_;
};

// No robot drives on its side: what is likely wrong with the file then, where another way to read it has
// none.
void DoubtTilt(const TrajectoryImportOptions& options, const std::string& path, const Tilt& tilt,
               ImportReport* report) {
  constexpr double kSteep = 3, kHigh_m = 1;
  if (options.format == Format::kKitti) {
    if (tilt.up.length_m() < kHigh_m || tilt.up.length_m() < kSteep * tilt.other_up.length_m()) return;
    report->unit_doubts.push_back(
        path + ": it goes " + std::to_string(tilt.up.length_m()) + " m up and down, and " +
        std::to_string(tilt.other_up.length_m()) +
        (options.camera_axes
             ? " m along its z axis: are its axes a robot's, with z up? Then without --camera-axes"
             : " m along its y axis: are its axes a camera's? Then with --camera-axes"));
    return;
  }
  if (tilt.poses == 0 || 2 * tilt.tilted < tilt.poses || 2 * tilt.other_tilted >= tilt.poses) return;
  report->unit_doubts.push_back(
      path + ": " + std::to_string(tilt.tilted) + " of its " + std::to_string(tilt.poses) +
      " poses lie on their sides or backs, and would not with the real part of their quaternions " +
      (options.format == Format::kEuroc
           ? "last, as TUM's files have it (`import tum`); EuRoC's have it first"
           : "first, as EuRoC's files have it; TUM's have it last: qx qy qz qw"));
}

void WarnOfTilt(const std::string& path, const Tilt& tilt, ImportReport* report) {
  constexpr double kHigh_m = 0.5, kTilt_rad = 5 * std::numbers::pi / 180;
  if (tilt.up.length_m() > kHigh_m)
    report->warnings.push_back(path + ": heights differ by " + std::to_string(tilt.up.length_m()) +
                               " m; they are forgotten");
  if (tilt.most_rad > kTilt_rad)
    report->warnings.push_back(path + ": poses are tilted by up to " +
                               std::to_string(tilt.most_rad * 180 / std::numbers::pi) +
                               " degrees; that is forgotten");
}

}  // namespace

ImportReport ImportTrajectories(const TrajectoryImportOptions& options, Blob* poses) {
  BadLines bad(options.skip_bad);
  ImportReport report;
  std::vector<std::string> names = options.robots;
  if (names.empty()) {
    for (const std::string& file : options.files) names.push_back(NameOf(file));
  }
  if (names.size() != options.files.size())
    throw InputError(std::to_string(names.size()) + " names for " + std::to_string(options.files.size()) +
                     " trajectories");
  if (options.format == Format::kKitti && options.times.size() != options.files.size())
    throw InputError(std::to_string(options.times.size()) + " files of times for " +
                     std::to_string(options.files.size()) + " trajectories");
  TrajectoryReader reader(options, &bad);
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(n), names[n]) !=
        names.begin() + static_cast<std::ptrdiff_t>(n))
      throw InputError(options.files[n] + ": a second robot is called '" + names[n] + "'");
    Tilt tilt;
    const Poses rows = reader.Read(n, &tilt);
    DoubtPosesOf(rows, "robot '" + names[n] + "'", "poses", &report);
    DoubtTilt(options, options.files[n], tilt, &report);
    WarnOfTilt(options.files[n], tilt, &report);
    PutPoses("robot/" + std::to_string(n) + "/poses/", rows, poses);
  }
  poses->Put("robots", Array::Texts(names));
  report.robots = static_cast<std::int64_t>(names.size());
  report.skipped = bad.counts();
  return report;
}

}  // namespace cairn::datasets
