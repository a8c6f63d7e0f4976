#include "datasets/import_csv.h"

#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "datasets/csv_reader.h"
#include "datasets/name_index.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

// Numbers with six digits after the point, as far as a message needs them.
std::string Shown(double value) { return std::to_string(value); }

class CsvImport {
 public:
  explicit CsvImport(const CsvImportOptions& options) : options_(options), bad_(options.skip_bad) {}

  ImportReport Run(Blob* log) {
    CheckNominal(options_.nominal);
    if (options_.odometry.empty()) throw InputError("import csv needs an odometry file");
    if (!options_.truth_associations.empty() && options_.truth_landmarks.empty()) {
      throw InputError(options_.truth_associations +
                       ": associations need a file of true landmarks beside them");
    }
    rows_.nominal = options_.nominal;
    ReadOdometry();
    if (!options_.truth_landmarks.empty()) ReadTruthLandmarks();
    if (!options_.observations.empty()) ReadObservations();
    if (!options_.truth_poses.empty()) ReadTruthPoses();
    if (rows_.truth_landmarks) Associate();
    SortLandmarks();
    report_.skipped = bad_.counts();
    *log = MakeLog(rows_, options_.odometry, &report_);
    return report_;
  }

 private:
  CsvReader Open(const std::string& path, const std::vector<std::vector<std::string>>& headers) {
    CsvReader reader(path, headers, &bad_);
    for (const std::string& column : reader.extra_columns()) {
      report_.warnings.push_back(path + ": column '" + column + "' is left out");
    }
    return reader;
  }

  // The robot that column 1 names, or null where the line is bad.
  RobotRows* Robot(CsvReader* reader) {
    const std::int32_t robot = robots_.Find(reader->Text(1));
    if (robot < 0) reader->Bad("unknown robot", "'" + std::string(reader->Text(1)) + "' has no odometry");
    return robot < 0 ? nullptr : &rows_.robots[static_cast<std::size_t>(robot)];
  }

  // Whether `time` goes on from the last one of the column; the line is bad where it does not.
  static bool InOrder(double time, const std::vector<double>& times, CsvReader* reader) {
    return times.empty() || InOrder(time, times.back(), reader);
  }
  static bool InOrder(double time, double last, CsvReader* reader) {
    if (time >= last) return true;
    reader->Bad("time runs backwards", Shown(time) + " after " + Shown(last));
    return false;
  }

  void ReadOdometry() {
    CsvReader reader = Open(options_.odometry, {{"time_s", "robot", "turn_rad", "forward_m"},
                                                {"time_s", "robot", "v_mps", "omega_radps"}});
    std::vector<VelocityIntegrator> integrators;
    std::vector<double> last_times;
    while (reader.Next()) {
      const auto time = reader.Number(0), first = time ? reader.Number(2) : time,
                 second = first ? reader.Number(3) : first;
      if (!second) continue;
      if (reader.Text(1).empty()) {
        reader.Bad("unknown robot", "the column is empty");
        continue;
      }
      const auto robot = static_cast<std::size_t>(robots_.FindOrAdd(reader.Text(1)));
      if (robot == rows_.robots.size()) {
        rows_.robots.emplace_back().name = reader.Text(1);
        integrators.emplace_back();
        last_times.push_back(*time);
      }
      if (!InOrder(*time, last_times[robot], &reader)) continue;
      last_times[robot] = *time;
      Odometry& odometry = rows_.robots[robot].odometry;
      if (reader.header() == 0)
        odometry.Add(*time, *first, *second);
      else
        integrators[robot].Add(*time, *first, *second, &odometry);
    }
  }

  void ReadTruthLandmarks() {
    CsvReader reader = Open(options_.truth_landmarks, {{"landmark", "x_m", "y_m"}});
    rows_.truth_landmarks.emplace();
    while (reader.Next()) {
      const auto x = reader.Number(1), y = x ? reader.Number(2) : x;
      if (!y) continue;
      if (reader.Text(0).empty() || truth_.Find(reader.Text(0)) >= 0) {
        reader.Bad("landmark without a name of its own", "'" + std::string(reader.Text(0)) + "'");
        continue;
      }
      truth_.FindOrAdd(reader.Text(0));
      rows_.truth_landmarks->x_m.push_back(*x);
      rows_.truth_landmarks->y_m.push_back(*y);
    }
    rows_.truth_landmarks->name = truth_.names();
  }

  // Whether the line may name this landmark; it is bad where it may not.
  bool LandmarkIsKnown(std::string_view name, CsvReader* reader) {
    if (name.empty() || !rows_.truth_landmarks || truth_.Find(name) >= 0) return true;
    reader->Bad("unknown landmark", "'" + std::string(name) + "' is none of the true landmarks");
    return false;
  }

  // Whether there is a pose to observe from; the line is bad where there is none.
  static bool WhileDriving(double time, const std::vector<double>& controls, CsvReader* reader) {
    const double first = controls.front(), last = controls.back();
    if (time < first) reader->Bad("before the first control", Shown(time) + " before " + Shown(first));
    if (time > last) reader->Bad("after the last control", Shown(time) + " after " + Shown(last));
    return time >= first && time <= last;
  }

  // Range and bearing, both NaN for a press; false where the line is bad.
  bool Measurement(CsvReader* reader, double* range, double* bearing) {
    *range = *bearing = std::numeric_limits<double>::quiet_NaN();
    if (reader->Text(3).empty() && reader->Text(4).empty()) return true;
    if (reader->Text(3).empty() || reader->Text(4).empty()) {
      reader->Bad("range or bearing alone", "give both, or neither for 'at the robot'");
      return false;
    }
    const auto r = reader->Number(3), b = r ? reader->Number(4) : r;
    if (!b) return false;
    *range = *r;
    *bearing = NormalizedAngle(*b);
    const std::optional<Misreading> misreading = FindMisreading(*range, *bearing, options_.nominal);
    if (misreading) reader->Bad(misreading->reason, misreading->detail);
    return !misreading;
  }

  void ReadObservations() {
    CsvReader reader =
        Open(options_.observations, {{"time_s", "robot", "landmark", "range_m", "bearing_rad"}});
    while (reader.Next()) {
      const auto time = reader.Number(0);
      double range = 0, bearing = 0;
      if (!time || !Measurement(&reader, &range, &bearing)) continue;
      RobotRows* robot = Robot(&reader);
      if (robot == nullptr || !InOrder(*time, robot->observations.time_s, &reader)) continue;
      if (!LandmarkIsKnown(reader.Text(2), &reader)) continue;
      if (!WhileDriving(*time, robot->odometry.time_s, &reader)) continue;
      const std::int32_t landmark = reader.Text(2).empty() ? -1 : landmarks_.FindOrAdd(reader.Text(2));
      robot->observations.Add(*time, landmark, range, bearing);
    }
  }

  void ReadTruthPoses() {
    CsvReader reader = Open(options_.truth_poses, {{"time_s", "robot", "x_m", "y_m", "heading_rad"}});
    while (reader.Next()) {
      const auto time = reader.Number(0), x = time ? reader.Number(2) : time, y = x ? reader.Number(3) : x;
      const auto heading = y ? reader.Number(4) : y;
      RobotRows* robot = heading ? Robot(&reader) : nullptr;
      if (robot == nullptr || !InOrder(*time, robot->truth.time_s, &reader)) continue;
      robot->truth.time_s.push_back(*time);
      robot->truth.x_m.push_back(*x);
      robot->truth.y_m.push_back(*y);
      robot->truth.heading_rad.push_back(NormalizedAngle(*heading));
    }
  }

  void Associate() {
    if (options_.truth_associations.empty() && landmarks_.names().empty()) return;
    for (RobotRows& robot : rows_.robots) {
      for (const std::int32_t landmark : robot.observations.landmark) {
        const bool by_name = options_.truth_associations.empty() && landmark >= 0;
        robot.observations.truth_landmark.push_back(
            by_name ? truth_.Find(landmarks_.names()[static_cast<std::size_t>(landmark)]) : -1);
      }
    }
    if (!options_.truth_associations.empty()) ReadTruthAssociations();
  }

  void ReadTruthAssociations() {
    // The next observation of each robot and time that has no association yet.
    std::vector<std::multimap<double, std::size_t>> open(rows_.robots.size());
    for (std::size_t n = 0; n < open.size(); ++n) {
      const std::vector<double>& times = rows_.robots[n].observations.time_s;
      for (std::size_t i = 0; i < times.size(); ++i) open[n].emplace(times[i], i);
    }
    CsvReader reader = Open(options_.truth_associations, {{"time_s", "robot", "landmark"}});
    while (reader.Next()) {
      const auto time = reader.Number(0);
      RobotRows* robot = time ? Robot(&reader) : nullptr;
      if (robot == nullptr || !LandmarkIsKnown(reader.Text(2), &reader)) continue;
      auto& unassociated = open[static_cast<std::size_t>(robot - rows_.robots.data())];
      const auto next = unassociated.lower_bound(*time);
      if (next == unassociated.end() || next->first != *time) {
        reader.Bad("no such observation", "of robot '" + robot->name + "' at " + Shown(*time));
        continue;
      }
      robot->observations.truth_landmark[next->second] = truth_.Find(reader.Text(2));
      unassociated.erase(next);
    }
  }

  void SortLandmarks() {
    const std::vector<std::int32_t> renumbered = landmarks_.Sort();
    rows_.landmarks = landmarks_.names();
    for (RobotRows& robot : rows_.robots) {
      for (std::int32_t& landmark : robot.observations.landmark) {
        if (landmark >= 0) landmark = renumbered[static_cast<std::size_t>(landmark)];
      }
    }
  }

  const CsvImportOptions& options_;
  BadLines bad_;
  ImportReport report_;
  LogRows rows_;
  NameIndex robots_, landmarks_, truth_;
};

}  // namespace

ImportReport ImportCsv(const CsvImportOptions& options, Blob* log) { return CsvImport(options).Run(log); }

}  // namespace cairn::datasets
