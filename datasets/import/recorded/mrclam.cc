#include "datasets/import/recorded/mrclam.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

#include "datasets/import/recorded/dat_reader.h"
#include "datasets/import/repeated_rows.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr std::array kFilesOfARobot = {"Odometry", "Measurement", "Groundtruth"};
constexpr int kLastRobot = 5;  // subjects 1 to 5 are robots, the others landmarks

class MrclamImport {
 public:
  explicit MrclamImport(const MrclamImportOptions& options) : options_(options), bad_(options.skip_bad) {}

  ImportReport Run(Blob* log) {
    rows_.noise = Noise();
    if (!std::filesystem::is_directory(options_.folder))
      throw InputError(options_.folder + ": no such folder");
    ReadBarcodes();
    ReadTruthLandmarks();
    for (int subject = 1; subject <= kLastRobot; ++subject) {
      if (!HasFileOf(subject)) continue;
      const std::string odometry = Need(Robot(subject, "Odometry"));
      robots_[subject] = static_cast<std::int32_t>(rows_.robots.size());
      rows_.robots.emplace_back().name = std::to_string(subject);
      ReadOdometry(odometry, &rows_.robots.back());
    }
    if (rows_.robots.empty())
      throw InputError(options_.folder + ": there is no Robot1_Odometry.dat(.gz) in it");
    for (const auto& [subject, index] : robots_) {
      RobotRows& robot = rows_.robots[static_cast<std::size_t>(index)];
      ReadMeasurements(subject, &robot);
      ReadTruthPoses(Find(Robot(subject, "Groundtruth")), &robot);
    }
    WarnOfMissingTruth();
    report_.skipped = bad_.counts();
    *log = MakeLog(std::move(rows_), options_.folder, &report_);
    return report_;
  }

 private:
  NoiseParameters Noise() const {
    CheckNoise(options_.noise);
    NoiseParameters noise = MrclamNoise();
    const NoiseParameters& given = options_.noise;
    const auto replace = [](std::optional<double>& parameter, const std::optional<double>& other) {
      if (other) parameter = other;
    };
    replace(noise.heading_drift_rad_per_m, given.heading_drift_rad_per_m);
    replace(noise.heading_walk_rad_per_sqrt_m, given.heading_walk_rad_per_sqrt_m);
    replace(noise.forward_ratio, given.forward_ratio);
    replace(noise.turn_ratio, given.turn_ratio);
    replace(noise.contact_m, given.contact_m);
    replace(noise.range_m, given.range_m);
    replace(noise.bearing_rad, given.bearing_rad);
    replace(noise.false_ratio, given.false_ratio);
    replace(noise.miss_ratio, given.miss_ratio);
    replace(noise.max_range_m, given.max_range_m);
    replace(noise.field_of_view_rad, given.field_of_view_rad);
    return noise;
  }

  static std::string Robot(int subject, const char* what) {
    return "Robot" + std::to_string(subject) + "_" + what + ".dat";
  }

  std::string Find(const std::string& name) const { return FindFile(options_.folder, name); }
  std::string Need(const std::string& name) const { return NeedFile(options_.folder, name); }

  bool HasFileOf(int subject) const {
    return std::ranges::any_of(kFilesOfARobot,
                               [&](const char* what) { return !Find(Robot(subject, what)).empty(); });
  }

  // Truth may be missing, but where some of it is there the rest was meant to be.
  void WarnOfMissingTruth() {
    std::vector<std::string> files = {"Landmark_Groundtruth.dat"};
    for (const auto& [subject, index] : robots_) files.push_back(Robot(subject, "Groundtruth"));
    const auto missing = [this](const std::string& file) { return Find(file).empty(); };
    if (std::ranges::none_of(files, missing) || std::ranges::all_of(files, missing)) return;
    std::string names;
    for (const std::string& file : files)
      if (missing(file)) names += (names.empty() ? "" : ", ") + file;
    report_.warnings.push_back(options_.folder + ": no truth is taken from what is not there: " + names);
  }

  // The subject number in column 0, or 0 where the line is bad.
  static int Subject(DatReader* reader) {
    const double subject = (*reader)[0];
    if (subject >= 1 && subject <= 1e6 && subject == std::floor(subject)) return static_cast<int>(subject);
    reader->Bad("not a subject number", std::to_string(subject));
    return 0;
  }

  void ReadBarcodes() {
    DatReader reader(Need("Barcodes.dat"), 2, &bad_);
    while (reader.Next()) {
      if (const int subject = Subject(&reader)) subjects_[reader[1]] = subject;
    }
    for (const auto& [barcode, subject] : subjects_) {
      if (subject > kLastRobot) landmarks_[subject] = 0;
    }
    std::int32_t index = 0;
    for (auto& [subject, number] : landmarks_) number = index++;
    if (options_.withhold_identities) return;
    for (const auto& [subject, number] : landmarks_) rows_.landmarks.push_back(std::to_string(subject));
  }

  void ReadTruthLandmarks() {
    const std::string path = Find("Landmark_Groundtruth.dat");
    if (path.empty()) return;
    rows_.truth_landmarks.emplace();
    DatReader reader(path, 5, &bad_);
    while (reader.Next()) {
      const int subject = Subject(&reader);
      if (subject == 0) continue;
      truth_[subject] = static_cast<std::int32_t>(rows_.truth_landmarks->name.size());
      rows_.truth_landmarks->name.push_back(std::to_string(subject));
      rows_.truth_landmarks->x_m.push_back(reader[1]);
      rows_.truth_landmarks->y_m.push_back(reader[2]);
    }
  }

  void ReadOdometry(const std::string& path, RobotRows* robot) {
    VelocityIntegrator integrator;
    robot->odometry.from.file = path;
    DatReader reader(path, 3, &bad_);
    while (reader.Next()) {
      if (!reader.InOrder()) continue;
      integrator.Add(reader[0], reader[1], reader[2], &robot->odometry);
      robot->odometry.from.line.resize(robot->odometry.time_s.size(), reader.line());
    }
    if (robot->odometry.time_s.empty()) throw InputError(path + ": there is no odometry in it");
    constexpr double kLongGapS = 2;
    if (integrator.largest_gap_s() > kLongGapS) {
      report_.warnings.push_back(path + ": a gap of " + std::to_string(integrator.largest_gap_s()) +
                                 " s, over which the last velocity is held");
    }
  }

  bool IsGood(double range, double bearing, DatReader* reader) {
    const std::optional<Misreading> misreading = FindMisreading(range, bearing, rows_.noise);
    if (misreading) reader->Bad(misreading->reason, misreading->detail);
    return !misreading;
  }

  void ReadMeasurements(int observer, RobotRows* robot) {
    const std::string path = Need(Robot(observer, "Measurement"));
    DatReader reader(path, 4, &bad_);
    robot->observations.from.file = robot->robot_observations.from.file = path;
    RepeatedRows repeated("measurement", &report_);
    while (reader.Next()) {
      if (!reader.InOrder() || !IsGood(reader[2], reader[3], &reader)) continue;
      if (repeated.Is(robot->name, reader[0], {reader[1], reader[2], reader[3]})) continue;
      const auto subject = subjects_.find(reader[1]);
      if (subject == subjects_.end()) {
        ++report_.dropped["unknown barcode"];
      } else if (reader[0] < robot->odometry.time_s.front()) {
        ++report_.dropped["before the first odometry"];
      } else if (reader[0] > robot->odometry.time_s.back()) {
        ++report_.dropped["after the last odometry"];
      } else {
        Take(subject->second, &reader, robot);
        for (Observations* rows : {&robot->observations, &robot->robot_observations})
          rows->from.line.resize(rows->time_s.size(), reader.line());
      }
    }
    if (robot->observations.time_s.empty() && robot->robot_observations.time_s.empty())
      report_.warnings.push_back(path + ": nothing of it can be used: robot '" + robot->name +
                                 "' observes nothing");
  }

  void Take(int subject, DatReader* reader, RobotRows* robot) {
    const DatReader& row = *reader;
    const double bearing = row[3];
    if (subject <= kLastRobot && options_.robots_as_clutter) {
      robot->observations.Add(row[0], -1, row[2], bearing);
      if (rows_.truth_landmarks) robot->observations.truth_landmark.push_back(-1);
      return;
    }
    if (subject <= kLastRobot) {
      const auto seen = robots_.find(subject);
      if (seen == robots_.end())
        ++report_.dropped["observation of a robot without odometry"];
      else
        robot->robot_observations.Add(row[0], seen->second, row[2], bearing);
      return;
    }
    if (rows_.truth_landmarks && !truth_.contains(subject)) {
      reader->Bad("unknown landmark", "subject " + std::to_string(subject) + " has no true position");
      return;
    }
    robot->observations.Add(row[0], options_.withhold_identities ? -1 : landmarks_.at(subject), row[2],
                            bearing);
    if (rows_.truth_landmarks) robot->observations.truth_landmark.push_back(truth_.at(subject));
  }

  void ReadTruthPoses(const std::string& path, RobotRows* robot) {
    if (path.empty()) return;
    DatReader reader(path, 4, &bad_);
    robot->truth.from.file = path;
    RepeatedRows repeated("true pose", &report_);
    while (reader.Next()) {
      if (!reader.InOrder()) continue;
      if (repeated.Is(robot->name, reader[0], {reader[1], reader[2], reader[3]})) continue;
      robot->truth.Add(reader[0], reader[1], reader[2], reader[3], reader.line());
    }
  }

  const MrclamImportOptions& options_;
  BadLines bad_;
  ImportReport report_;
  LogRows rows_;
  std::map<double, int> subjects_;         // by barcode
  std::map<int, std::int32_t> landmarks_;  // by subject: index into `landmarks`
  std::map<int, std::int32_t> truth_;      // by subject: index into the true landmarks
  std::map<int, std::int32_t> robots_;     // by subject: index into `robots`
};

}  // namespace

NoiseParameters MrclamNoise() {
  NoiseParameters noise;
  noise.max_range_m = 10;
  noise.field_of_view_rad = 1.22;
  return noise;
}

ImportReport ImportMrclam(const MrclamImportOptions& options, Blob* log) {
  return MrclamImport(options).Run(log);
}

}  // namespace cairn::datasets
