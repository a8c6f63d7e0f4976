#include "pipelines/local_map/plan.h"

#include <algorithm>
#include <cmath>

namespace cairn::local_map {

std::vector<Stretch> CutSegments(std::size_t robot, const std::vector<Scan>& scans, const Options& options) {
  const auto most = static_cast<std::size_t>(options.segment_scans);
  const auto warm_up = static_cast<std::size_t>(options.warm_up_scans);
  std::vector<Stretch> segments;
  for (std::size_t begin = 0; begin < scans.size();) {
    std::size_t end = begin + 1;
    while (end < scans.size() && scans[end].run == scans[begin].run) ++end;
    const std::size_t pieces = (end - begin + most - 1) / most;
    for (std::size_t k = 0; k < pieces; ++k) {
      const std::size_t own = begin + k * (end - begin) / pieces;
      segments.push_back({robot, std::max(begin, own - std::min(own, warm_up)), own,
                          begin + (k + 1) * (end - begin) / pieces});
    }
    begin = end;
  }
  return segments;
}

TaskBuilder AddScanTask(const char* kind, const Stretch& stretch, const std::string& rows_name,
                        proto::Step* plan) {
  const auto count = static_cast<std::int64_t>(stretch.end - stretch.first);
  TaskBuilder task(kind, ScanUs(kind, ScalarsIn<Size>(plan->state())) * static_cast<double>(count), plan);
  SetSize(plan->state(), &task);
  task.Set("robot", stretch.robot)
      .Set("first", stretch.first)
      .Set("own", stretch.own - stretch.first)
      .Read(kLogInput)
      .Read("rings", RingsName(stretch.robot))
      .Read("rows", rows_name, {static_cast<std::int64_t>(stretch.first), count});
  return task;
}

void PlanWalls(std::size_t robot, const std::vector<Scan>& scans, const Options& options, proto::Step* plan) {
  for (Stretch segment : CutSegments(robot, scans, options)) {
    // Whether the robot was carried while its run was cut, the scans of the run before tell.
    const auto before = segment.first < segment.own
                            ? std::size_t{0}
                            : std::min(segment.first, static_cast<std::size_t>(options.warm_up_scans));
    segment.first -= before;
    AddScanTask("walls", segment, RowsName(robot), plan).Set("motion", before);
  }
}

namespace {

// Of ADVANCE, a scan: after each kind of round. Pairs that are usual of a scan, in each round.
constexpr double kTrackUs = 60, kPlanUs = 15, kJoinUs = 10, kKeepUs = 1, kUsualPairs = 0.8;

}  // namespace

double ScanUs(std::string_view kind, const Size& size) {
  if (kind == "walls") return 12;
  if (kind == "lasers" || kind == "passes") return 100;
  return kind == "traces" ? 50 * size.cells() : 300 * size.finer() * size.finer();
}

double PairUs(std::int64_t round, const Size& size) {
  return 600 * size.columns() * std::sqrt(size.finer()) * std::pow(0.6, static_cast<double>(round - 1));
}

void ExpectRest(const Options& options, double scans, double pairs, proto::Step* plan) {
  const auto standing = ScalarsIn<Standing>(plan->state());
  const Phase phase = standing.phase;
  const auto size = ScalarsIn<Size>(plan->state());
  const double walls = scans * ScanUs("walls", size), traces = scans * ScanUs("traces", size),
               follow = scans * ScanUs("follow", size);
  const bool is_walls = phase == Phase::kWalls || phase == Phase::kWallsAgain;
  plan->set_advance_cost(scans * (is_walls                  ? kTrackUs
                                  : phase == Phase::kTraces ? kPlanUs
                                  : phase == Phase::kPairs  ? kJoinUs
                                                            : kKeepUs));
  if (phase == Phase::kWalls) ExpectRounds(1, walls + scans * kTrackUs, 0, plan);
  if (is_walls) ExpectRounds(1, traces + scans * kPlanUs, 0, plan);
  if (phase == Phase::kFollow) return;
  const double of_round = pairs < 0 ? kUsualPairs * scans : pairs;
  const std::int64_t first = phase == Phase::kPasses  ? options.loop_rounds + 1
                             : phase == Phase::kPairs ? standing.round + 1
                                                      : 1;
  for (std::int64_t next = first; next <= options.loop_rounds; ++next)
    ExpectRounds(1, of_round * PairUs(next, size) + scans * kJoinUs, 0, plan);
  if (phase != Phase::kPasses && standing.lasers > 0)
    ExpectRounds(1, scans * ScanUs("passes", size), static_cast<double>(standing.lasers), plan);
  ExpectRounds(1, follow, static_cast<double>(standing.robots), plan);
}

}  // namespace cairn::local_map
