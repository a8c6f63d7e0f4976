#include <optional>
#include <utility>

#include "datasets/common/fields.h"
#include "datasets/import/recorded/range_log.h"
#include "datasets/import/recorded/ranges.h"

namespace cairn::datasets {
namespace {

constexpr std::size_t kMostDpslamBeams = 100000;
constexpr double kMostDpslamRange_m = 1000, kReach_m = 8.18;

class DpSlamLines {
 public:
  explicit DpSlamLines(RangeLog* log) : log_(log) {}

  void Read(const Fields& line, std::size_t number) {
    if (line.Text(0) == "Odometry") {
      line.Need(4, "the pose of the odometry");
      pose_ = line.PoseAt(1);
      return;
    }
    if (line.Text(0) != "Laser") throw UnknownMessage(line.Text(0));
    const std::size_t beams = line.Count(1, kMostDpslamBeams);
    line.Need(2 + beams, std::to_string(beams) + " readings");
    if (beams < 2) throw LineError{"no count", "a scan has two beams or more"};
    if (!pose_) throw LineError{"scan without odometry before it", ""};
    if (log_->sensors.empty())
      log_->sensors.push_back(LaserFan("laser", beams, 180.0 / static_cast<double>(beams - 1), 0, kReach_m));
    const std::size_t first = log_->sensors[0].beam_x_m.size();
    if (beams != first)
      throw LineError{"other beams than the sensor's first scan",
                      std::to_string(beams) + " instead of " + std::to_string(first)};
    log_->events.push_back({number,
                            0,
                            pose_,
                            {},
                            {},
                            0,
                            log_->things.Keep(Readings{line.Ranges(2, beams, kMostDpslamRange_m)})});
    pose_.reset();
  }

 private:
  RangeLog* log_;
  std::optional<Pose> pose_;  // which no scan has used yet
};

}  // namespace

ImportReport ImportDpSlam(const RangeImportOptions& options, Blob* log) {
  CheckNoise(options.noise);
  BadLines bad(options.skip_bad);
  RangeLog ranges;
  ranges.path = options.path;
  ranges.numbered = true;
  DpSlamLines lines(&ranges);
  ForEachLine(options.path, &bad, [&](const Fields& line, std::size_t number) { lines.Read(line, number); });
  return MakeRangeLog(std::move(ranges), options.noise, &bad, {}, log);
}

}  // namespace cairn::datasets
