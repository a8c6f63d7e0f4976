#include <array>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "datasets/common/fields.h"
#include "datasets/import/recorded/range_log.h"
#include "datasets/import/recorded/ranges.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr double kMillimetresOfMetre = 1e3, kMillisecondsOfSecond = 1e3,
                 kPioneerDegree_rad = std::numbers::pi / 180, kTenthOfDegree = kPioneerDegree_rad / 10;
constexpr double kMostPioneerRange_m = 1000;
constexpr std::array<double, 8> kSonar_deg{-90, -37.5, -22.5, -7.5, 7.5, 22.5, 37.5, 90};
constexpr double kSonarAside_m = 0.19, kSonarCone_deg = 20, kPioneerReach_m = 5.1;
constexpr std::size_t kLaserBeams = 361;
constexpr double kLaserReach_m = 80;

struct PioneerRow {
  std::size_t line = 0;
  double time_s = 0;
  std::vector<double> values;
};

// A file's rows: a time and `count` numbers, which `parse` reads. A bad row that is skipped leaves a gap, as
// rows of the files belong together by their numbers.
class PioneerTable {
 public:
  PioneerTable(const std::string& folder, const std::string& name, BadLines* bad)
      : path_(NeedFile(folder, name)), text_(ReadText(path_)), bad_(bad) {}
  const std::string& path() const { return path_; }

  template <class Parse>
  std::vector<std::optional<PioneerRow>> Rows(std::size_t count, const Parse& parse) {
    std::vector<std::optional<PioneerRow>> rows;
    for (Lines lines(text_); lines.Next();) {
      const Fields fields(lines.text());
      if (fields.empty()) continue;
      rows.emplace_back();
      try {
        fields.Need(1 + count, "a time and " + std::to_string(count) + " values");
        rows.back() = PioneerRow{lines.number(), fields.Stamp(0, kMillisecondsOfSecond), parse(fields)};
      } catch (const LineError& error) {
        bad_->Add(path_, lines.number(), error.reason, error.detail);
      }
    }
    return rows;
  }

 private:
  std::string path_, text_;
  BadLines* bad_;
};

RangeRows PioneerRing() {
  RangeRows rows;
  rows.sensor = "sonar";
  for (const double at : kSonar_deg) {
    rows.beam_x_m.push_back(0);
    rows.beam_y_m.push_back(at == -90 ? -kSonarAside_m : at == 90 ? kSonarAside_m : 0);
    rows.beam_heading_rad.push_back(at * kPioneerDegree_rad);
  }
  rows.opening_rad = kSonarCone_deg * kPioneerDegree_rad;
  rows.max_range_m = kPioneerReach_m;
  return rows;
}

std::vector<double> Metres(std::vector<double> millimetres) {
  for (double& value : millimetres) value /= kMillimetresOfMetre;
  return millimetres;
}

}  // namespace

ImportReport ImportPioneer(const RangeImportOptions& options, Blob* log) {
  CheckNoise(options.noise);
  BadLines bad(options.skip_bad);
  ImportReport report;
  PioneerTable poses(options.path, "od.txt", &bad), sonars(options.path, "sonar.txt", &bad),
      lasers(options.path, "laser.txt", &bad);
  const auto pose_rows = poses.Rows(3, [](const Fields& f) {
    const Pose pose = f.PoseAt(1, kMillimetresOfMetre);
    return std::vector{pose.x_m, pose.y_m, pose.heading_rad * kTenthOfDegree};
  });
  const auto ranges = [](const Fields& f) {
    return Metres(f.Ranges(1, f.size() - 1, kMostPioneerRange_m * kMillimetresOfMetre));
  };
  const auto sonar_rows = sonars.Rows(kSonar_deg.size(), ranges),
             laser_rows = lasers.Rows(kLaserBeams, ranges);
  if (sonar_rows.size() != pose_rows.size() || laser_rows.size() != pose_rows.size())
    throw InputError(options.path + ": od.txt, sonar.txt and laser.txt differ in length");
  RangeLog ranges_log;
  ranges_log.path = poses.path();
  ranges_log.robot = "pioneer";
  ranges_log.sensors = {PioneerRing(), LaserFan("laser", kLaserBeams, 0.5, 0, kLaserReach_m)};
  for (std::size_t row = 0; row < pose_rows.size(); ++row) {
    const auto &pose = pose_rows[row], &sonar = sonar_rows[row], &laser = laser_rows[row];
    if (!pose || !sonar || !laser) {
      ++report.dropped["row that is bad in one of the files"];
      continue;
    }
    if (pose->time_s != sonar->time_s || pose->time_s != laser->time_s) {
      bad.Add(poses.path(), pose->line, "another time than in sonar.txt and laser.txt", "");
      continue;
    }
    const Pose at{pose->values[0], pose->values[1], WrapAngle(pose->values[2])};
    for (std::uint32_t sensor = 0; sensor < 2; ++sensor)
      ranges_log.events.push_back(
          {pose->line,
           pose->time_s,
           at,
           {},
           {},
           sensor,
           ranges_log.things.Keep(Readings{sensor == 0 ? sonar->values : laser->values})});
  }
  return MakeRangeLog(std::move(ranges_log), options.noise, &bad, std::move(report), log);
}

}  // namespace cairn::datasets
