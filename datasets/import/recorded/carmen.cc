#include "datasets/import/recorded/carmen.h"

#include <algorithm>
#include <numbers>
#include <utility>
#include <vector>

#include "datasets/import/recorded/carmen_log.h"
#include "datasets/import/recorded/carmen_mount.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kSickReach_m = 50, kSonarReach_m = 5;
constexpr std::size_t kRear = 1;

std::string SensorName(const CarmenSource& source) {
  return source.laser == 0 ? "laser" : "laser" + std::to_string(source.laser + 1);
}

// Of each laser the source that has poses, and then the most scans.
std::vector<bool> BestSources(const std::vector<CarmenSource>& sources) {
  const auto better = [](const CarmenSource& a, const CarmenSource& b) {
    return std::pair(!a.mounts.empty(), a.scans) > std::pair(!b.mounts.empty(), b.scans);
  };
  std::vector<bool> best(sources.size(), true);
  for (std::size_t a = 0; a < sources.size(); ++a) {
    for (std::size_t b = 0; b < sources.size(); ++b) {
      if (sources[a].laser != sources[b].laser || a == b) continue;
      if (better(sources[b], sources[a]) || (!better(sources[a], sources[b]) && b < a)) best[a] = false;
    }
  }
  return best;
}

class CarmenImport {
 public:
  explicit CarmenImport(const CarmenImportOptions& options) : options_(options), bad_(options.skip_bad) {}

  ImportReport Run(Blob* log) {
    CheckNoise(options_.noise);
    carmen_ = ReadCarmenLog(options_.path, &bad_, &report_);
    moves_apart_ = std::ranges::any_of(carmen_.sources, [](const auto& s) { return MovesApart(s.mounts); });
    PlacePoses();
    RangeLog ranges;
    ranges.path = options_.path;
    ranges.numbered = options_.numbered;
    ranges.marks_are_names = options_.named_markers;
    PlaceScans(&ranges);
    return MakeRangeLog(std::move(ranges), options_.noise, &bad_, std::move(report_), log);
  }

 private:
  // Which poses are whose: see CarmenImportOptions::Poses.
  void PlacePoses() {
    using Poses = CarmenImportOptions::Poses;
    const bool detected = carmen_.mended || moves_apart_;
    if (options_.poses == Poses::kRaw || (options_.poses == Poses::kDetect && !detected)) return;
    if (!moves_apart_)
      report_.warnings.emplace_back("its poses are taken for corrected ones: it has no odometry of its own");
    for (CarmenEvent& event : carmen_.events) {
      if (!moves_apart_)
        event.event.corrected = event.event.odometry;
      else if (event.laser)
        event.event.corrected = RobotUnder(*event.laser, MountOf(carmen_.sources[*event.event.sensor]));
    }
  }

  // Where a laser sits on the robot.
  Pose MountOf(const CarmenSource& source) const {
    const auto given = options_.mounts.find(SensorName(source));
    if (given != options_.mounts.end()) return given->second;
    const bool rear = source.laser == kRear;
    const bool tells = !source.mounts.empty() && !moves_apart_ && !(rear && AllAlike(source.mounts));
    if (tells) return MedianMount(source.mounts);
    if (rear) return {carmen_.Param("robot_rearlaser_offset").value_or(0), 0, std::numbers::pi};
    const double ahead_m = source.laser == 0 ? carmen_.Param("robot_frontlaser_offset").value_or(0) : 0;
    return {ahead_m, 0, 0};
  }

  // The sensors, and the events with their numbers for sources'; those of other sources are left out.
  void PlaceScans(RangeLog* ranges) {
    const std::vector<bool> best = BestSources(carmen_.sources);
    std::vector<std::uint32_t> sensor(carmen_.sources.size());
    for (std::size_t s = 0; s < best.size(); ++s) {
      sensor[s] = static_cast<std::uint32_t>(ranges->sensors.size());
      if (best[s]) ranges->sensors.push_back(LaserRows(carmen_.sources[s]));
    }
    for (CarmenEvent& event : carmen_.events) {
      std::optional<std::uint32_t>& of = event.event.sensor;
      if (of == kCarmenSonar) {
        of = static_cast<std::uint32_t>(ranges->sensors.size());
      } else if (of && best[*of]) {
        of = sensor[*of];
      } else if (of) {
        const std::string& message = carmen_.sources[*of].message;
        report_.read.erase(message);
        ++report_.dropped[message + ", of which another message holds the same"];
        continue;
      }
      ranges->events.push_back(event.event);
    }
    ranges->things = std::move(carmen_.things);
    ranges->sensors.push_back(SonarRows());
  }

  RangeRows LaserRows(const CarmenSource& source) {
    const bool rear = source.laser == kRear;
    const auto param = [&](const char* front, const char* behind) {
      return carmen_.PositiveParam(rear ? behind : front);
    };
    RangeRows rows;
    rows.sensor = SensorName(source);
    std::optional<double> reach_m = options_.max_range_m ? options_.max_range_m : source.max_range_m;
    if (!reach_m) reach_m = param("robot_front_laser_max", "robot_rear_laser_max");
    rows.max_range_m = reach_m.value_or(kSickReach_m);
    rows.reach_is_assumed = !reach_m;
    const BeamFan fan = FanOf(source.beams, options_.first_deg, options_.step_deg,
                              param("laser_frontlaser_resolution", "laser_rearlaser_resolution"));
    if (fan.guessed && !source.step_rad)
      report_.warnings.push_back(source.message + ": its " + std::to_string(source.beams) +
                                 " beams are taken to span 180 degrees");
    const Pose mount = MountOf(source);
    const double first = source.start_rad.value_or(fan.first_deg * kDegree);
    const double step = source.step_rad.value_or(fan.step_deg * kDegree);
    for (std::size_t beam = 0; beam < source.beams; ++beam) {
      rows.beam_x_m.push_back(mount.x_m);
      rows.beam_y_m.push_back(mount.y_m);
      rows.beam_heading_rad.push_back(
          NormalizedAngle(mount.heading_rad + first + static_cast<double>(beam) * step));
    }
    return rows;
  }

  RangeRows SonarRows() const {
    RangeRows rows;
    rows.sensor = "sonar";
    rows.opening_rad = carmen_.sonar.cone_rad;
    const std::optional<double> reach_m =
        options_.sonar_max_range_m ? options_.sonar_max_range_m : carmen_.PositiveParam("robot_sonar_max");
    rows.max_range_m = reach_m.value_or(kSonarReach_m);
    rows.reach_is_assumed = !reach_m;
    for (const Pose& offset : carmen_.sonar.offsets) {
      rows.beam_x_m.push_back(offset.x_m);
      rows.beam_y_m.push_back(offset.y_m);
      rows.beam_heading_rad.push_back(NormalizedAngle(offset.heading_rad));
    }
    return rows;
  }

  const CarmenImportOptions& options_;
  BadLines bad_;
  ImportReport report_;
  CarmenLog carmen_;
  bool moves_apart_ = false;  // lasers, on their robot
};

}  // namespace

ImportReport ImportCarmen(const CarmenImportOptions& options, Blob* log) {
  return CarmenImport(options).Run(log);
}

}  // namespace cairn::datasets
