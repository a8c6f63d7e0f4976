#include <algorithm>
#include <cmath>
#include <vector>

#include "datasets/common/text_file.h"
#include "datasets/import/recorded/range_log.h"
#include "datasets/import/recorded/recorded.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr double kMetres = 1e-3, kSeconds = 1e-3;  // files hold mm and ms
constexpr double kTick_m = 0.349e-3, kWheels_m = 0.155, kScannerAhead_m = 0.030;

// The numbers of each line, the letters before them left out.
class LetteredFile {
 public:
  LetteredFile(const std::string& path, BadLines* bad) : path_(path), text_(ReadText(path)), bad_(bad) {}

  // Rows of `least` numbers or more, in pairs where asked. A bad line that is skipped leaves an empty row:
  // files belong together by the numbers of their rows.
  std::vector<std::vector<double>> Rows(std::size_t least, bool pairs) {
    std::vector<std::vector<double>> rows;
    Lines lines(text_);
    while (lines.Next()) {
      if (Trim(lines.text()).empty()) continue;
      line_.push_back(lines.number());
      std::vector<double>& row = rows.emplace_back();
      if (!Parse(lines, &row)) {
        row.clear();
      } else if (row.size() < least || (pairs && row.size() % 2 != 0)) {
        bad_->Add(path_, lines.number(), "wrong number of columns", std::to_string(row.size()));
        row.clear();
      }
    }
    return rows;
  }

  const std::vector<std::size_t>& line() const { return line_; }  // of each row

 private:
  bool Parse(const Lines& lines, std::vector<double>* row) {
    for (std::string_view rest = Trim(lines.text()); !rest.empty();) {
      const std::string_view field = rest.substr(0, rest.find_first_of(" \t"));
      rest = Trim(rest.substr(field.size()));
      const bool letter = field.size() == 1 && field[0] >= 'A' && field[0] <= 'Z';
      if (letter && row->empty()) continue;
      const char* reason = "";
      const std::optional<double> number = ParseNumber(field, &reason);
      if (!number) {
        bad_->Add(path_, lines.number(), reason, "'" + std::string(field) + "'");
        return false;
      }
      row->push_back(*number);
    }
    return true;
  }

  std::string path_, text_;
  BadLines* bad_;
  std::vector<std::size_t> line_;
};

// Ticks to controls; returns the time of each row. One that repeats the time before counts as a millisecond
// later, or its scan and the one before would be taken for one.
std::vector<double> ReadMotors(const std::string& path, BadLines* bad, Odometry* odometry) {
  constexpr double kRepeat_s = 1e-3, kMostRepeats = 5;
  std::vector<double> times;
  double left = 0.0, right = 0.0;
  LetteredFile file(path, bad);
  odometry->from.file = path;
  for (const std::vector<double>& row : file.Rows(6, false)) {
    if (row.empty()) {
      times.push_back(times.empty() ? 0.0 : times.back());
      continue;
    }
    double time = row[0] * kSeconds;
    if (!times.empty() && time <= times.back()) {
      if (row[0] * kSeconds < times.back() - kMostRepeats * kRepeat_s)
        throw InputError(path + ":" + std::to_string(file.line()[times.size()]) + ": time runs backwards");
      time = times.back() + kRepeat_s;
    }
    if (odometry->time_s.empty()) {
      odometry->Add(time, 0.0, 0.0);
    } else {
      const double to_left = (row[1] - left) * kTick_m, to_right = (row[5] - right) * kTick_m;
      const double turn = (to_right - to_left) / kWheels_m;
      odometry->Add(time, turn / 2, (to_left + to_right) / 2);
      odometry->Add(time, turn / 2, 0.0);
    }
    left = row[1];
    right = row[5];
    odometry->from.line.resize(odometry->time_s.size(), file.line()[times.size()]);
    times.push_back(time);
  }
  return times;
}

void ReadPoles(const std::string& path, BadLines* bad, const std::vector<double>& times,
               Observations* observations) {
  LetteredFile file(path, bad);
  const auto rows = file.Rows(0, true);
  observations->from.file = path;
  if (rows.size() > times.size()) throw InputError(path + ": it has more rows than robot4_motors.txt");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t k = 0; k + 1 < rows[i].size(); k += 2) {
      const double ahead = rows[i][k] * kMetres + kScannerAhead_m, aside = rows[i][k + 1] * kMetres;
      observations->Add(times[i], -1, std::hypot(ahead, aside), std::atan2(aside, ahead));
      observations->from.line.push_back(file.line()[i]);
    }
  }
}

// A Hokuyo's; rows belong together by their numbers.
void ReadScans(const std::string& path, BadLines* bad, const std::vector<double>& times, RobotRows* robot) {
  constexpr std::size_t kBeams = 660, kAhead = kBeams / 2, kBefore = 2;  // the time, the number of ranges
  constexpr double kStep_rad = 0.006135923151543, kTurned_rad = -0.06981317007977318;
  constexpr double kLeast_m = 0.02, kReach_m = 4;
  RangeRows laser;
  laser.sensor = "laser";
  laser.max_range_m = kReach_m;
  for (std::size_t beam = 0; beam < kBeams; ++beam) {
    laser.beam_x_m.push_back(kScannerAhead_m);
    laser.beam_y_m.push_back(0);
    laser.beam_heading_rad.push_back((static_cast<double>(beam) - static_cast<double>(kAhead)) * kStep_rad +
                                     kTurned_rad);
  }
  const auto rows = LetteredFile(path, bad).Rows(kBefore + kBeams, false);
  for (std::size_t i = 0; i < std::min(rows.size(), times.size()); ++i) {
    if (rows[i].empty()) continue;
    laser.time_s.push_back(times[i]);
    for (std::size_t beam = 0; beam < kBeams; ++beam)
      laser.range_m.push_back(Answer(rows[i][kBefore + beam] * kMetres, kLeast_m, kReach_m));
  }
  robot->ranges.push_back(std::move(laser));
}

void ReadReference(const std::string& path, BadLines* bad, const std::vector<double>& times, Poses* truth) {
  constexpr double kStep_m = 0.02;
  if (path.empty()) return;
  LetteredFile file(path, bad);
  const auto rows = file.Rows(3, false);
  truth->from.file = path;
  for (std::size_t i = 0; i < std::min(rows.size(), times.size()); ++i) {
    if (rows[i].empty()) continue;
    truth->from.line.push_back(file.line()[i]);
    truth->time_s.push_back(times[i]);
    truth->x_m.push_back(rows[i][1] * kMetres);
    truth->y_m.push_back(rows[i][2] * kMetres);
  }
  truth->heading_rad = Course(truth->x_m.vector(), truth->y_m.vector(), kStep_m);
}

void ReadArena(const std::string& path, BadLines* bad, LogRows* rows) {
  if (path.empty()) return;
  TruthLandmarks& poles = rows->truth_landmarks.emplace();
  for (const std::vector<double>& row : LetteredFile(path, bad).Rows(2, false)) {
    if (row.empty()) continue;
    poles.name.push_back("pole " + std::to_string(poles.name.size() + 1));
    poles.x_m.push_back(row[0] * kMetres);
    poles.y_m.push_back(row[1] * kMetres);
  }
}

}  // namespace

std::vector<double> Course(const std::vector<double>& x_m, const std::vector<double>& y_m, double least_m) {
  std::vector<double> course(x_m.size(), 0.0);
  std::size_t from = 0, known = 0;  // courses before `known` are set
  for (std::size_t i = 1; i < x_m.size(); ++i) {
    const double dx = x_m[i] - x_m[from], dy = y_m[i] - y_m[from];
    if (std::hypot(dx, dy) < least_m) {
      if (known > 0) course[i] = course[i - 1];
      continue;
    }
    course[i] = std::atan2(dy, dx);
    if (known == 0) std::fill(course.begin(), course.begin() + static_cast<std::ptrdiff_t>(i), course[i]);
    known = i + 1;
    from = i;
  }
  return course;
}

ImportReport ImportLegoRobot(const RecordedImportOptions& options, Blob* log) {
  CheckNoise(options.noise);
  BadLines bad(options.skip_bad);
  ImportReport report;
  LogRows rows;
  rows.noise = options.noise;
  RobotRows& robot = rows.robots.emplace_back();
  robot.name = "lego";
  const std::vector<double> times =
      ReadMotors(NeedFile(options.folder, "robot4_motors.txt"), &bad, &robot.odometry);
  if (options.scans)
    ReadScans(NeedFile(options.folder, "robot4_scan.txt"), &bad, times, &robot);
  else
    ReadPoles(NeedFile(options.folder, "cylinders.txt"), &bad, times, &robot.observations);
  ReadReference(FindFile(options.folder, "robot4_reference.txt"), &bad, times, &robot.truth);
  ReadArena(FindFile(options.folder, "robot_arena_landmarks.txt"), &bad, &rows);
  report.skipped = bad.counts();
  *log = MakeLog(std::move(rows), options.folder, &report);
  return report;
}

}  // namespace cairn::datasets
