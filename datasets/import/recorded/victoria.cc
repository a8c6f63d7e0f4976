#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/import/recorded/dat_reader.h"
#include "datasets/import/recorded/range_log.h"
#include "datasets/import/recorded/recorded.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr double kWheelBase_m = 2.83, kLeftWheel_m = 0.76;  // L, H
constexpr double kLaserAhead_m = 3.78, kLaserLeft_m = 0.5;  // a, b, from the rear axle's middle
constexpr double kGpsBehind_s = 20.967;                     // GPS.txt's clock against that of trees/
constexpr std::size_t kTreesAScan = 18;

class VictoriaImport {
 public:
  explicit VictoriaImport(const RecordedImportOptions& options) : options_(options), bad_(options.skip_bad) {}

  ImportReport Run(Blob* log) {
    CheckNoise(options_.noise);
    rows_.noise = options_.noise;
    RobotRows& robot = rows_.robots.emplace_back();
    robot.name = "car";
    ReadControls(&robot.odometry);
    if (options_.scans)
      ReadScans(&robot);
    else
      ReadTrees(&robot);
    ReadGps(&robot.truth);
    report_.skipped = bad_.counts();
    *log = MakeLog(std::move(rows_), options_.folder, &report_);
    return report_;
  }

 private:
  std::string Find(const std::string& name) const { return FindFile(options_.folder, name); }
  std::string Need(const std::string& name) const { return NeedFile(options_.folder, name); }

  std::vector<double> Column(const std::string& name, Origin* from = nullptr) {
    std::vector<double> column;
    const std::string path = Need(name);
    DatReader reader(path, 1, &bad_);
    if (from != nullptr) from->file = path;
    while (reader.Next()) {
      column.push_back(reader[0]);
      if (from != nullptr) from->line.push_back(reader.line());
    }
    return column;
  }

  // The left rear wheel's speed and the steering angle as those of the rear axle's middle.
  void ReadControls(Odometry* odometry) {
    Origin at;
    const std::vector<double> time = Column("trees/time.txt", &at), speed = Column("trees/speed.txt"),
                              steering = Column("trees/steering.txt");
    if (time.size() != speed.size() || time.size() != steering.size())
      throw InputError(options_.folder + "/trees: time, speed and steering differ in length");
    if (!std::ranges::is_sorted(time))
      throw InputError(options_.folder + "/trees/time.txt: time runs backwards");
    VelocityIntegrator integrator;
    odometry->from.file = at.file;
    for (std::size_t i = 0; i < time.size(); ++i) {
      const double tangent = std::tan(steering[i]);
      const double middle_mps = speed[i] / (1.0 - tangent * kLeftWheel_m / kWheelBase_m);
      integrator.Add(1e-3 * time[i], middle_mps, middle_mps * tangent / kWheelBase_m, odometry);
      odometry->from.line.resize(odometry->time_s.size(), at.line[i]);
    }
  }

  // Zero stands for no tree; a tree lies where the laser sees it, told from the rear axle's middle.
  void ReadTrees(RobotRows* robot) {
    if (robot->odometry.time_s.empty()) return;
    const std::vector<double> time = Column("trees/lasersampling.txt");
    const std::string path = Need("trees/ObservationDistance.txt");
    DatReader range(path, kTreesAScan, &bad_);
    DatReader angle(Need("trees/ObservationAngle.txt"), kTreesAScan, &bad_);
    robot->observations.from.file = path;
    for (const double time_ms : time) {
      if (!range.Next() || !angle.Next())
        throw InputError(options_.folder + "/trees: fewer rows of trees than laser scans");
      const double time_s = 1e-3 * time_ms;
      if (time_s < robot->odometry.time_s.front() || time_s > robot->odometry.time_s.back()) {
        ++report_.dropped["scan outside the controls' time"];
        continue;
      }
      for (std::size_t k = 0; k < kTreesAScan; ++k) AddTree(time_s, range[k], angle[k], &robot->observations);
      robot->observations.from.line.resize(robot->observations.time_s.size(), range.line());
    }
  }

  // Its clock is that of the fixes.
  void ReadScans(RobotRows* robot) {
    constexpr std::size_t kBeams = 361;
    constexpr double kStep_deg = 0.5, kReach_m = 81;
    RangeRows laser = LaserFan("laser", kBeams, kStep_deg, kLaserAhead_m, kReach_m);
    laser.beam_y_m.assign(kBeams, kLaserLeft_m);
    DatReader reader(Need("LASER.txt"), kBeams + 1, &bad_);
    while (reader.Next()) {
      if (!reader.InOrder()) continue;
      laser.time_s.push_back(reader[0] + kGpsBehind_s);
      for (std::size_t beam = 0; beam < kBeams; ++beam)
        laser.range_m.push_back(Answer(reader[1 + beam], 0, kReach_m));
    }
    robot->ranges.push_back(std::move(laser));
  }

  static void AddTree(double time_s, double range_m, double angle_rad, Observations* observations) {
    constexpr double kNoTree_m = 1e-3;
    if (range_m < kNoTree_m) return;
    const double bearing = angle_rad - std::numbers::pi / 2;  // the laser counts from its right
    const double ahead = kLaserAhead_m + range_m * std::cos(bearing);
    const double aside = kLaserLeft_m + range_m * std::sin(bearing);
    observations->Add(time_s, -1, std::hypot(ahead, aside), std::atan2(aside, ahead));
  }

  void ReadGps(Poses* truth) {
    constexpr double kMove_m = 1.0;
    const std::string path = Find("GPS.txt");
    if (path.empty()) return;
    DatReader reader(path, 3, &bad_);
    truth->from.file = path;
    while (reader.Next()) {
      if (!reader.InOrder()) continue;
      truth->from.line.push_back(reader.line());
      truth->time_s.push_back(reader[0] + kGpsBehind_s);
      truth->x_m.push_back(reader[2]);  // east
      truth->y_m.push_back(reader[1]);  // north: told from the turns of the odometry
    }
    truth->heading_rad = Course(truth->x_m.vector(), truth->y_m.vector(), kMove_m);
  }

  const RecordedImportOptions& options_;
  BadLines bad_;
  ImportReport report_;
  LogRows rows_;
};

}  // namespace

ImportReport ImportVictoriaPark(const RecordedImportOptions& options, Blob* log) {
  return VictoriaImport(options).Run(log);
}

}  // namespace cairn::datasets
