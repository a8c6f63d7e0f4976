#include <utility>
#include <vector>

#include "datasets/common/fields.h"
#include "datasets/import/recorded/range_log.h"
#include "datasets/import/recorded/ranges.h"

namespace cairn::datasets {
namespace {

constexpr double kCentimetres = 100, kWeanReach_m = 81.8, kAhead_m = 0.25, kMostWeanRange_m = 1000;
constexpr std::size_t kWeanBeams = 180, kRanges = 7;  // where those of an L line begin

RangeEvent EventOf(const Fields& line, std::size_t number, RangeThings* things) {
  RangeEvent event;
  event.line = number;
  if (line.Text(0) == "O") {
    line.Need(5, "pose and time");
  } else if (line.Text(0) == "L") {
    line.Need(kRanges + kWeanBeams + 1,
              "two poses, " + std::to_string(kWeanBeams) + " readings and the time");
    event.sensor = 0;
    event.scan = things->Keep(Readings{line.Ranges(kRanges, kWeanBeams, kMostWeanRange_m * kCentimetres)});
    for (double& range : event.scan->range_m) range /= kCentimetres;
  } else {
    throw UnknownMessage(line.Text(0));
  }
  event.odometry = line.PoseAt(1, kCentimetres);
  event.stamp_s = line.Stamp(line.size() - 1);
  return event;
}

}  // namespace

ImportReport ImportWean(const RangeImportOptions& options, Blob* log) {
  CheckNoise(options.noise);
  BadLines bad(options.skip_bad);
  RangeLog ranges;
  ranges.path = options.path;
  ranges.sensors = {LaserFan("laser", kWeanBeams, 1, kAhead_m, kWeanReach_m)};
  ForEachLine(options.path, &bad, [&](const Fields& line, std::size_t number) {
    ranges.events.push_back(EventOf(line, number, &ranges.things));
  });
  return MakeRangeLog(std::move(ranges), options.noise, &bad, {}, log);
}

}  // namespace cairn::datasets
