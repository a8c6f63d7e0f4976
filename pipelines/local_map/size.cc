#include "pipelines/local_map/size.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <string>
#include <utility>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/state_scalars.h"
#include "pipelines/local_map/path/lost_beams.h"
#include "schema/error.h"

namespace cairn::local_map {
namespace {

// A person passes within kPasses_m of way.
constexpr double kFew = 0.05, kShare = 0.15, kStretch_m = 5, kPasses_m = 1;
constexpr double kReadings = 0.75, kOfWay = 0.9;

// What a robot's lasers saw at one scan.
struct Sight {
  double way_m = 0;  // travelled since the sight before, of the same run
  double far_m = 0;  // as far as kReadings of the readings reach
  bool blind = false;
  auto operator<=>(const Sight&) const = default;
};

// Beams that tell how far one sees: those that are lost by chance do not.
std::size_t BeamsThatTell(const std::vector<Pose>& beams, std::span<const double> ranges) {
  std::vector<bool> answered(ranges.size());
  for (std::size_t b = 0; b < ranges.size(); ++b) answered[b] = ranges[b] == ranges[b];
  const std::vector<bool> lost = LostBeams(beams, answered);
  return static_cast<std::size_t>(std::ranges::count(lost, false));
}

std::vector<Sight> SightsOf(const PosedScans& scans, const RobotRuns& robot) {
  const double near_m = Size{}.reach_m();
  std::vector<Sight> sights;
  std::vector<double> met;
  const Scan* before = nullptr;
  for (std::size_t s = 0; s < robot.scans.size(); ++s) {
    std::size_t beams = 0;
    met.clear();
    for (std::size_t k = 0; k < robot.sensors.size(); ++k) {
      const RangeScans& sensor = scans.sensors[robot.sensors[k]];
      const std::int64_t row = robot.row_of_log[s * robot.sensors.size() + k];
      // Infra-red ends before what the default reaches: that it sees nothing makes no hall.
      if (sensor.opening_rad > 0 || !(sensor.max_range_m > near_m) || row < 0) continue;
      const auto ranges = sensor.range_m.As<double>().subspan(
          static_cast<std::size_t>(row) * sensor.beams.size(), sensor.beams.size());
      beams += BeamsThatTell(sensor.beams, ranges);
      std::ranges::copy_if(ranges, std::back_inserter(met), [](double r) { return r == r; });
    }
    if (beams == 0) continue;
    const Scan& scan = robot.scans[s];
    Sight sight{.way_m = before && before->run == scan.run ? scan.path_m - before->path_m : 0};
    before = &scan;
    const auto near = std::ranges::count_if(met, [&](double r) { return r < near_m; });
    sight.blind = static_cast<double>(near) < kFew * static_cast<double>(beams);
    if (!met.empty()) {
      const auto rank =
          met.begin() + static_cast<std::ptrdiff_t>(kReadings * static_cast<double>(met.size()));
      std::ranges::nth_element(met, rank);
      sight.far_m = *rank;
    }
    sights.push_back(sight);
  }
  return sights;
}

// Of the way, in stretches of more than kStretch_m; each ends where the robot sees more for kPasses_m.
double BlindWay_m(const std::vector<Sight>& sights) {
  double all = 0, stretch = 0, seen = 0;
  const auto end = [&] {
    if (stretch > kStretch_m) all += stretch;
    stretch = 0;
  };
  for (const Sight& sight : sights) {
    seen = sight.blind ? 0 : seen + sight.way_m;
    if (sight.blind) stretch += sight.way_m;
    if (seen > kPasses_m) end();
  }
  end();
  return all;
}

double FarOnMostOfWay_m(std::vector<Sight> sights, double way_m) {
  std::ranges::sort(sights, {}, [](const Sight& s) { return std::pair(s.far_m, s.way_m); });
  double gone = 0, far_m = 0;
  for (std::size_t k = 0; k < sights.size() && gone < kOfWay * way_m; ++k) {
    gone += sights[k].way_m;
    far_m = sights[k].far_m;
  }
  return far_m;
}

constexpr double kLeastCell_m = 0.02, kMostCell_m = 2;
constexpr std::int64_t kLeastHalf = 2, kMostHalf = 127, kLeastBeams = 8, kMostBeams = 720;

// An option that is given; 0: it is not.
template <class T>
void TakeGiven(const char* name, T given, T least, T most, T* value) {
  if (given == 0) return;
  if (given < least || given > most)
    throw InputError(fmt::format("option {}: {} is out of range; allowed: 0, and from {} to {}", name, given,
                                 least, most));
  *value = given;
}

}  // namespace

Size ChooseSize(const Options& options, const PosedScans& scans, const std::vector<RobotRuns>& robots) {
  double far_m = 0;
  for (const RobotRuns& robot : robots) {
    const std::vector<Sight> sights = SightsOf(scans, robot);
    double way_m = 0;
    for (const Sight& sight : sights) way_m += sight.way_m;
    if (BlindWay_m(sights) > kShare * way_m) far_m = std::max(far_m, FarOnMostOfWay_m(sights, way_m));
  }
  Size size = far_m > 0 ? kHall : Size{};
  TakeGiven("cell_m", options.grid.cell_m, kLeastCell_m, kMostCell_m, &size.cell_m);
  if (far_m > 0)
    size.half_cells = std::clamp(static_cast<std::int64_t>(std::ceil(std::min(far_m, 1e3) / size.cell_m)),
                                 Size{}.half_cells, kHall.half_cells);
  TakeGiven("half_cells", options.grid.half_cells, kLeastHalf, kMostHalf, &size.half_cells);
  TakeGiven("ring_beams", options.ring_beams, kLeastBeams, kMostBeams, &size.ring_beams);
  return size;
}

void SetSize(const proto::State& state, TaskBuilder* task) {
  const auto size = ScalarsIn<Size>(state);
  task->Set("cell_m", size.cell_m).Set("half_cells", size.half_cells).Set("ring_beams", size.ring_beams);
}

Size SizeOf(const proto::Task& task) {
  const auto cell = task.params().find("cell_m");
  const double cell_m = cell == task.params().end() ? 0 : cell->second.d();
  RequireWithin("cell_m", cell_m, kLeastCell_m, kMostCell_m);
  return {cell_m, IntegerOf(task, "half_cells", kLeastHalf, kMostHalf),
          IntegerOf(task, "ring_beams", kLeastBeams, kMostBeams)};
}

Options Sized(Options options, const Size& size) {
  options.grid.cell_m = size.cell_m;
  options.grid.half_cells = size.half_cells;
  options.ring_beams = size.ring_beams;
  return options;
}

}  // namespace cairn::local_map
