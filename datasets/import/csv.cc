#include "datasets/import/csv.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "datasets/import/alike_names.h"
#include "datasets/import/csv_reader.h"
#include "datasets/import/name_index.h"
#include "datasets/import/near_repeats.h"
#include "datasets/import/pose_controls.h"
#include "datasets/import/repeated_rows.h"
#include "datasets/import/row_times.h"
#include "datasets/import/skipped_rows.h"
#include "datasets/import/step_arcs.h"
#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

// Numbers with six digits after the point, as far as a message needs them.
std::string Shown(double value) { return std::to_string(value); }

// What a log's times and those of another table may differ by for having been rounded.
constexpr double kRounding_s = 1;

// Why a time may lie beyond a log of `first` to `last`: its unit, or its clock; nothing where it is only
// late.
std::string OtherTimes(double time, double first, double last) {
  constexpr std::array kUnits = {std::pair{1e3, "milliseconds"}, std::pair{1e6, "microseconds"},
                                 std::pair{1e9, "nanoseconds"}};
  constexpr double kUnixTime_s = 9e8;  // since 1998
  const double all = last - first;
  for (const auto& [per, unit] : kUnits) {
    const bool of_another_clock = time > kUnixTime_s && time < 1e3 * kUnixTime_s && last < kUnixTime_s;
    if (!of_another_clock && time / per >= first && time / per <= last + all && time > 100 * last)
      return std::string("; is it in ") + unit + "? Or is it of another clock?";
  }
  constexpr double kLate_s = 60;
  const double beyond = time < first ? first - time : time - last;
  return beyond > kLate_s ? "; do both files use one clock (Unix time or from 0, UTC or local)?" : "";
}

class CsvImport {
 public:
  explicit CsvImport(const CsvImportOptions& options) : options_(options), bad_(options.skip_bad) {}

  ImportReport Run(Blob* log) {
    CheckNoise(options_.noise);
    if (options_.odometry.empty()) throw InputError("import csv needs an odometry file");
    if (!options_.truth_associations.empty() && options_.truth_landmarks.empty()) {
      throw InputError(options_.truth_associations +
                       ": associations need a file of true landmarks beside them");
    }
    ReadOdometry();
    MountSensors();
    if (!options_.truth_landmarks.empty()) ReadTruthLandmarks();
    if (!options_.observations.empty()) ReadObservations();
    if (!options_.truth_poses.empty()) ReadTruthPoses();
    if (rows_.truth_landmarks) {
      CheckTrueNames();
      Associate();
    }
    WarnOfAlikeNames();
    SortLandmarks();
    report_.skipped = bad_.counts();
    *log = MakeLog(std::move(rows_), options_.odometry, &report_);
    return report_;
  }

 private:
  static constexpr std::size_t kTime = 0, kRobot = 1;  // of all columns but those of the true landmarks
  static constexpr std::size_t kMostNamed = 10;        // columns that are left out
  static constexpr std::string_view kOnlyRobot = "robot";
  static constexpr std::size_t kMostRobots = 1000;  // each is a group in the file, and they cost their square

  CsvReader Open(const std::string& path, const std::vector<std::vector<std::string>>& headers) {
    CsvReader reader(path, headers, &bad_);
    const std::vector<std::string>& extra = reader.extra_columns();
    for (std::size_t i = 0; i < std::min(extra.size(), kMostNamed); ++i)
      report_.warnings.push_back(path + ": column '" + extra[i] + "' is left out");
    if (extra.size() > kMostNamed)
      report_.warnings.push_back(path + ": " + std::to_string(extra.size() - kMostNamed) +
                                 " more columns are left out");
    if (!reader.Has(kRobot) && rows_.robots.size() > 1)
      throw InputError(reader.Place() + "the header lacks 'robot'; odometry is of " +
                       std::to_string(rows_.robots.size()) + " robots");
    return reader;
  }

  // The robot that the line names, the only one where there is no such column, or null where the line is bad.
  RobotRows* Robot(CsvReader* reader) {
    if (!reader->Has(kRobot)) return rows_.robots.empty() ? nullptr : &rows_.robots.front();
    const std::int32_t robot = robots_.Find(reader->Text(1));
    if (robot < 0)
      reader->Bad("unknown robot", "'" + std::string(reader->Text(1)) + "' has no odometry" +
                                       (has_robots_ ? "" : "; its file has no column 'robot'"));
    return robot < 0 ? nullptr : &rows_.robots[static_cast<std::size_t>(robot)];
  }

  // The robot that the line is of, a new one where nobody knows it.
  RobotRows* RobotOrNew(CsvReader* reader) {
    const auto name = reader->Has(kRobot) ? reader->Name(kRobot) : std::optional(kOnlyRobot);
    if (!name) return nullptr;
    if (name->empty() || MeansUnknown(*name)) {
      reader->Bad("unknown robot",
                  name->empty() ? "the column is empty" : "'" + std::string(*name) + "' is no robot's name");
      return nullptr;
    }
    const auto robot = static_cast<std::size_t>(robots_.FindOrAdd(*name));
    if (robot >= kMostRobots)
      throw InputError(options_.odometry + ": names more than " + std::to_string(kMostRobots) +
                       " robots: is its column 'robot' something else?");
    if (robot == rows_.robots.size()) rows_.robots.emplace_back().name = *name;
    return &rows_.robots[robot];
  }

  // Whether `time` goes on from the last one of the column; the line is bad where it does not.
  static bool InOrder(double time, const Walked<double>& times, CsvReader* reader) {
    return times.empty() || InOrder(time, times.back(), reader);
  }
  static bool InOrder(double time, double last, CsvReader* reader) {
    const bool names = reader->Has(kRobot);
    return InTimeOrder(time, last, kTime, names ? std::optional(kRobot) : std::nullopt,
                       names ? "" : "; rows of several robots need a column 'robot'", reader);
  }

  void ReadOdometry() {
    const SkippedRows skipped(bad_);
    CsvReader reader = Open(options_.odometry, {{"time_s", "robot?", "turn_rad", "forward_m"},
                                                {"time_s", "robot?", "v_mps", "omega_radps"},
                                                {"time_s", "robot?", "x_m", "y_m", "heading_rad"}});
    has_robots_ = reader.Has(kRobot);
    if (options_.steps_are_arcs && reader.header() != 0)
      throw InputError(
          options_.odometry +
          ": --steps-are-arcs is of rows turn_rad,forward_m; those of velocities and of poses are "
          "arcs already");
    skipped.RequireHalf(options_.odometry,
                        reader.header() == 2 ? ReadOdometryPoses(&reader) : ReadOdometryControls(&reader));
    if (reader.header() == 0) {
      WarnOfLostMotion();
      for (RobotRows& robot : rows_.robots) {
        LeaveOutRepeatedSteps("robot '" + robot.name + "'", options_.repeated_steps, &robot.odometry,
                              &report_);
        if (options_.repeated_steps != RepeatedSteps::kMotion)
          WarnOf(options_.odometry, robot.name, DoubtNearRepeats(robot.odometry));
        if (options_.steps_are_arcs)
          TakeStepsAsArcs(&robot.odometry);
        else
          WarnOf(options_.odometry, robot.name, DoubtLongSteps(robot.odometry));
      }
    }
    for (const auto& [robot, digits] : digits_) {
      const std::string doubt = digits.Doubt();
      if (!doubt.empty()) throw InputError(options_.odometry + ": robot '" + robot + "': " + doubt);
      WarnOf(options_.odometry, robot, digits.Rounded());
    }
  }

  void WarnOf(const std::string& file, const std::string& robot, const std::string& doubt) {
    if (!doubt.empty()) report_.warnings.push_back(file + ": robot '" + robot + "': " + doubt);
  }

  // Speeds go on until the next row and poses say where the robot is, whatever is left out between them; of
  // steps each is needed.
  void WarnOfLostMotion() {
    const SkippedLines skipped = bad_.SkippedOf(options_.odometry);
    if (skipped.count == 0) return;
    const bool one = skipped.count == 1;
    report_.warnings.push_back(
        options_.odometry + ": " + std::to_string(skipped.count) +
        (one ? " row of odometry that tells motion is" : " rows of odometry that tell motion are") +
        " left out (" + skipped.Text() + "): what " + (one ? "it" : "they") +
        " told is lost; the path after line " + std::to_string(skipped.first.front()) + " is off by it");
  }

  // The number of good rows.
  std::size_t ReadOdometryControls(CsvReader* reader) {
    std::size_t good = 0;
    RepeatedRows repeated(kRowOfOdometry, &report_);
    std::map<std::string, VelocityIntegrator> integrators;
    std::map<std::string, double> last_times;
    while (reader->Next()) {
      const auto time = reader->Number(0), first = time ? reader->Number(2) : time,
                 second = first ? reader->Number(3) : first;
      RobotRows* robot = second ? RobotOrNew(reader) : nullptr;
      if (robot == nullptr) continue;
      const auto last_time = last_times.try_emplace(robot->name, *time).first;
      if (!InOrder(*time, last_time->second, reader)) continue;
      last_time->second = *time;
      digits_[robot->name].Add(*time);
      Odometry& odometry = robot->odometry;
      odometry.from.file = options_.odometry;
      if (reader->header() == 0)
        odometry.Add(*time, *first, *second);
      else if (!repeated.Is(robot->name, *time, {*first, *second}))
        integrators[robot->name].Add(*time, *first, *second, &odometry);
      odometry.from.line.resize(odometry.time_s.size(), reader->line());
      ++good;
    }
    return good;
  }

  std::size_t ReadOdometryPoses(CsvReader* reader) {
    std::size_t good = 0;
    RepeatedRows repeated(kRowOfOdometry, &report_);
    while (reader->Next()) {
      const auto time = reader->Number(0), x = time ? reader->Number(2) : time, y = x ? reader->Number(3) : x,
                 heading = y ? reader->Number(4) : y;
      RobotRows* robot = heading ? RobotOrNew(reader) : nullptr;
      if (robot == nullptr || !InOrder(*time, robot->odometry_poses.time_s, reader)) continue;
      robot->odometry_poses.from.file = options_.odometry;
      digits_[robot->name].Add(*time);
      ++good;
      if (repeated.Is(robot->name, *time, {*x, *y, *heading})) continue;
      robot->odometry_poses.Add(*time, *x, *y, *heading, reader->line());
    }
    for (RobotRows& robot : rows_.robots) robot.odometry = ControlsOf(robot.odometry_poses);
    return good;
  }

  // Each robot's, and the noise parameters of the one that sees most.
  void MountSensors() {
    const auto known = [&](const auto& of_robots, const char* what) {
      for (const auto& [robot, value] : of_robots)
        if (!robot.empty() && robots_.Find(robot) < 0 && !(robot == kOnlyRobot && !has_robots_))
          throw InputError(
              std::string(what) + " of '" + robot + "': no such robot in " + options_.odometry +
              ", which has " +
              NameList(has_robots_ ? robots_.names() : std::vector<std::string>{std::string(kOnlyRobot)}));
    };
    known(options_.mounts, "the sensor's place");
    known(options_.late_s, "the sensor's clock");
    const auto of = [](const auto& of_robots, const std::string& robot) {
      const auto found = of_robots.contains(robot) ? of_robots.find(robot) : of_robots.find("");
      return found != of_robots.end() ? found->second : decltype(found->second)();
    };
    for (const RobotRows& robot : rows_.robots)
      sensors_.push_back({of(options_.mounts, robot.name), of(options_.late_s, robot.name)});
    rows_.noise = options_.noise;
    for (const LandmarkSensor& sensor : sensors_) {
      const NoiseParameters on = sensor.OnRobot(options_.noise);
      if (on.max_range_m) rows_.noise.max_range_m = std::max(*rows_.noise.max_range_m, *on.max_range_m);
      if (!on.field_of_view_rad) rows_.noise.field_of_view_rad.reset();
      if (rows_.noise.field_of_view_rad)
        rows_.noise.field_of_view_rad = std::max(*rows_.noise.field_of_view_rad, *on.field_of_view_rad);
    }
  }

  const LandmarkSensor& SensorOf(const RobotRows& robot) const {
    return sensors_[static_cast<std::size_t>(&robot - rows_.robots.data())];
  }

  void ReadTruthLandmarks() {
    CsvReader reader = Open(options_.truth_landmarks, {{"landmark", "x_m", "y_m"}});
    rows_.truth_landmarks.emplace();
    while (reader.Next()) {
      const auto x = reader.Number(1), y = x ? reader.Number(2) : x;
      if (!y || !reader.Name(0)) continue;
      if (reader.Text(0).empty() || MeansUnknown(reader.Text(0)) || truth_.Find(reader.Text(0)) >= 0) {
        reader.Bad("landmark without a name of its own", "'" + std::string(reader.Text(0)) + "'");
        continue;
      }
      truth_.FindOrAdd(reader.Text(0));
      rows_.truth_landmarks->x_m.push_back(*x);
      rows_.truth_landmarks->y_m.push_back(*y);
    }
    rows_.truth_landmarks->name = truth_.names();
  }

  // Whether it can be a landmark's name; the line is bad where it cannot.
  static bool IsName(std::string_view name, CsvReader* reader) {
    if (!MeansUnknown(name)) return true;
    reader->Bad("no landmark's name",
                "'" + std::string(name) + "': leave the field empty where it is unknown");
    return false;
  }

  std::string OneTrueName() const {
    return truth_.names().empty() ? "" : " ('" + truth_.names().front() + "' is one)";
  }

  // Where the true positions of only some landmarks were measured the others are not scored; where those of
  // none were, the names are of another list.
  void CheckTrueNames() {
    std::size_t measured = 0;
    std::string first;  // that was not
    for (const std::string& name : landmarks_.names()) {
      if (truth_.Find(name) >= 0)
        ++measured;
      else if (first.empty())
        first = name;
    }
    if (first.empty()) return;
    if (measured == 0)
      throw InputError(options_.observations + ": unknown landmark: '" + first +
                       "', as all others, is none of the true landmarks of " + options_.truth_landmarks +
                       OneTrueName() + ": are they called the same in both files?");
    all_measured_ = false;
    report_.warnings.push_back(options_.truth_landmarks + ": no true position of " +
                               std::to_string(landmarks_.names().size() - measured) + " of the " +
                               std::to_string(landmarks_.names().size()) +
                               " landmarks that observations name ('" + first +
                               "' is one): only the others are scored");
  }

  void WarnOfAlikeNames() {
    std::vector<std::string> landmarks = landmarks_.names();
    if (options_.truth_associations.empty())  // else true names may be of a list of their own
      landmarks.insert(landmarks.end(), truth_.names().begin(), truth_.names().end());
    for (const std::string& warning :
         {WarningOfAlikeNames(robots_.names(), "robots"), WarningOfAlikeNames(landmarks, "landmarks")})
      if (!warning.empty()) report_.warnings.push_back(warning);
  }

  // Whether there is a pose to observe from; the line is bad where there is none.
  static bool WhileDriving(double time, const SpooledRows<double>& controls, CsvReader* reader) {
    const double first = controls.front(), last = controls.back();
    const double beyond = std::max(first - time, time - last);
    const bool may_be_rounded = beyond > 0 && beyond <= kRounding_s && !reader->skips() &&
                                (AreWholeSeconds(controls) || AreWholeSeconds(*reader, kTime));
    std::string others = may_be_rounded ? std::string("; ") + kWholeSeconds : OtherTimes(time, first, last);
    if (others.empty()) others = "; a robot that stood still then needs a row of odometry that says so";
    if (time < first)
      reader->Bad("before the first control", Shown(time) + " before " + Shown(first) + others);
    if (time > last) reader->Bad("after the last control", Shown(time) + " after " + Shown(last) + others);
    return time >= first && time <= last;
  }

  // Range and bearing, both NaN for a contact detection; false where the line is bad.
  bool Measurement(const LandmarkSensor& sensor, CsvReader* reader, double* range, double* bearing) {
    *range = *bearing = std::numeric_limits<double>::quiet_NaN();
    if (reader->Text(3).empty() && reader->Text(4).empty()) return true;
    if (reader->Text(3).empty() || reader->Text(4).empty()) {
      reader->Bad("range or bearing alone", "give both, or neither for 'at the robot'");
      return false;
    }
    const auto r = reader->Number(3), b = r ? reader->Number(4) : r;
    if (!b) return false;
    if (*r == 0) {
      reader->Bad("range 0", "some sensors say it where nothing was seen: leave such rows out");
      return false;
    }
    *range = *r;
    *bearing = *b;
    const std::optional<Misreading> misreading = FindMisreading(*range, *bearing, options_.noise);
    if (misreading) reader->Bad(misreading->reason, misreading->detail);
    sensor.ToRobotFrame(range, bearing);
    return !misreading;
  }

  // By odometry's clock.
  std::optional<double> ObservationTime(const RobotRows& robot, CsvReader* reader) const {
    const auto time = reader->Number(kTime);
    return time ? *time - SensorOf(robot).late_s : time;
  }

  void ReadObservations() {
    CsvReader reader =
        Open(options_.observations, {{"time_s", "robot?", "landmark", "range_m", "bearing_rad"}});
    const SkippedRows skipped(bad_);
    RepeatedRows repeated("row of an observation", &report_);
    std::size_t good = 0;
    while (reader.Next()) {
      RobotRows* robot = Robot(&reader);
      const auto time = robot != nullptr ? ObservationTime(*robot, &reader) : std::nullopt;
      double range = 0, bearing = 0;
      if (!time || !Measurement(SensorOf(*robot), &reader, &range, &bearing)) continue;
      if (!InOrder(*time, robot->observations.time_s, &reader)) continue;
      if (!reader.Name(2) || !IsName(reader.Text(2), &reader)) continue;
      if (!WhileDriving(*time, robot->odometry.time_s, &reader)) continue;
      const std::int32_t landmark = reader.Text(2).empty() ? -1 : landmarks_.FindOrAdd(reader.Text(2));
      ++good;
      // A landmark without a name would become two. True associations are of the rows, one by one.
      if (options_.truth_associations.empty() &&
          repeated.Is(robot->name, *time, {static_cast<double>(landmark), range, bearing}))
        continue;
      robot->observations.Add(*time, landmark, range, bearing);
      robot->observations.from.file = options_.observations;
      robot->observations.from.line.push_back(reader.line());
    }
    skipped.RequireHalf(options_.observations, good);
    for (const RobotRows& robot : rows_.robots)
      WarnOf(options_.observations, robot.name,
             DoubtRepeats(robot.observations.time_s, robot.observations.landmark));
  }

  void ReadTruthPoses() {
    CsvReader reader = Open(options_.truth_poses, {{"time_s", "robot?", "x_m", "y_m", "heading_rad"}});
    const SkippedRows skipped(bad_);
    RepeatedRows repeated("row of a true pose", &report_);
    std::size_t good = 0, outside = 0;
    std::string example;
    while (reader.Next()) {
      const auto time = reader.Number(0), x = time ? reader.Number(2) : time, y = x ? reader.Number(3) : x;
      const auto heading = y ? reader.Number(4) : y;
      RobotRows* robot = heading ? Robot(&reader) : nullptr;
      if (robot == nullptr || !InOrder(*time, robot->truth.time_s, &reader)) continue;
      if (repeated.Is(robot->name, *time, {*x, *y, *heading})) continue;
      robot->truth.from.file = options_.truth_poses;
      robot->truth.Add(*time, *x, *y, *heading, reader.line());
      ++good;
      const double first = robot->odometry.time_s.front(), last = robot->odometry.time_s.back();
      if (*time >= first && *time <= last) continue;
      if (outside++ == 0)
        example = Shown(*time) + " s, where odometry is of " + Shown(first) + " to " + Shown(last) + " s" +
                  OtherTimes(*time, first, last);
    }
    skipped.RequireHalf(options_.truth_poses, good);
    if (2 * outside > good)
      report_.warnings.push_back(
          options_.truth_poses + ": " + std::to_string(outside) + " of " + std::to_string(good) +
          " poses lie outside the time of the log, where nothing is measured by them: " + example);
  }

  // Whether what observations are truly of is told by their own names. Of one without a name nobody knows it;
  // that does not make it a false one.
  bool AllAreNamed() const {
    return all_measured_ && !landmarks_.names().empty() &&
           std::ranges::all_of(rows_.robots, [](const RobotRows& robot) {
             return std::ranges::all_of(robot.observations.landmark,
                                        [](std::int32_t name) { return name >= 0; });
           });
  }

  void Associate() {
    if (options_.truth_associations.empty() && !AllAreNamed()) return;
    for (RobotRows& robot : rows_.robots) {
      for (const std::int32_t landmark : robot.observations.landmark) {
        const bool by_name = options_.truth_associations.empty();
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
    CsvReader reader = Open(options_.truth_associations, {{"time_s", "robot?", "landmark"}});
    while (reader.Next()) {
      RobotRows* robot = Robot(&reader);
      const auto time = robot != nullptr ? ObservationTime(*robot, &reader) : std::nullopt;
      if (!time || !IsName(reader.Text(2), &reader)) continue;
      if (!reader.Text(2).empty() && truth_.Find(reader.Text(2)) < 0) {
        reader.Bad("unknown landmark", "'" + std::string(reader.Text(2)) +
                                           "' is none of the true landmarks of " + options_.truth_landmarks +
                                           OneTrueName() + ": are they called the same in both files?");
        continue;
      }
      auto& unassociated = open[static_cast<std::size_t>(robot - rows_.robots.data())];
      const auto next = unassociated.lower_bound(*time);
      if (next == unassociated.end() || next->first != *time) {
        const bool may_be_rounded = !bad_.skips() && AreWholeSeconds(reader, kTime);
        reader.Bad("no such observation", "of robot '" + robot->name + "' at " + Shown(*time) +
                                              (may_be_rounded ? std::string("; ") + kWholeSeconds : ""));
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
  std::vector<LandmarkSensor> sensors_;       // of each robot
  std::map<std::string, TimeDigits> digits_;  // of each robot's odometry
  bool has_robots_ = true;                    // odometry names them
  bool all_measured_ = true;                  // the true positions of all landmarks that have a name
};

}  // namespace

ImportReport ImportCsv(const CsvImportOptions& options, Blob* log) { return CsvImport(options).Run(log); }

}  // namespace cairn::datasets
