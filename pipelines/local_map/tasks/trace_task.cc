#include "pipelines/local_map/tasks/trace_task.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipelines/local_map/grids/local_grids.h"
#include "pipelines/local_map/traces/immediate_trace.h"
#include "pipelines/local_map/traces/recorder.h"

namespace cairn::local_map {
namespace {

constexpr int kOrientations = 4;

void Keep(const LocalGrids& grids, ImmediateTrace* room, Surroundings* kept) {
  for (int quarter = 0; quarter < kOrientations; ++quarter) {
    MakeImmediate(grids, quarter, *room);
    AppendFeatures(room->trace, &kept->features);
    kept->robot.insert(kept->robot.end(), {room->robot.z_m, room->robot.u_m});
  }
}

bool FacesAnAxis(double heading_rad, double within_rad) {
  return std::abs(std::remainder(heading_rad, std::numbers::pi / 2)) <= within_rad;
}

// Traces one after the other, each until it ends by itself.
class Recording {
 public:
  Recording(const LocalGrids& grids, const RecordOptions& options, std::vector<RecordedTrace>* traces)
      : recorder_(grids), options_(options), traces_(traces) {}

  void Update(const LocalGrids& grids, std::size_t scan, double time_s, bool hint) {
    if (runs_ && recorder_.Update(grids, time_s, hint) != TraceEnd::kNone) Finish(scan);
    if (runs_ || !FacesAnAxis(grids.pose().heading_rad, options_.begin_rad)) return;
    recorder_.Begin(grids, time_s);
    recorder_.Update(grids, time_s);
    first_ = scan;
    runs_ = true;
    begun_ = recorder_.RobotAt(grids);
    last_ = begun_;
  }
  void Note(const LocalGrids& grids) {
    if (runs_) last_ = recorder_.RobotAt(grids);
  }
  void Finish(std::size_t end) {
    runs_ = false;
    if (std::abs(last_.z_m - begun_.z_m) < options_.least_m) return;
    // A trace runs where the robot drove, which need not be where it faced.
    if (last_.z_m > begun_.z_m)
      traces_->push_back({0, first_, end, recorder_.frame(), recorder_.trace()});
    else
      traces_->push_back({0, first_, end, recorder_.frame().Back(), Reversed(recorder_.trace())});
  }
  bool runs() const { return runs_; }

 private:
  TraceRecorder recorder_;
  RecordOptions options_;
  std::vector<RecordedTrace>* traces_;
  std::size_t first_ = 0;
  Position begun_, last_;
  bool runs_ = false;
};

}  // namespace

Recorded Record(ScanReader& scans, std::size_t own, std::span<const std::int64_t> nodes,
                std::span<const double> hints, const GridOptions& grid, const RecordOptions& options,
                Progress& progress) {
  GridOptions aligned = grid;
  aligned.align = false;  // the path's headings are along the walls
  LocalGrids grids(aligned, scans.rings());
  ImmediateTrace room = ImmediateRoom(grids);
  Recorded recorded;
  Recording recording(grids, options, &recorded.traces);
  auto node = nodes.begin();
  for (std::size_t s = 0; s < scans.size(); ++s) {
    if (s % 100 == 0) progress.Tick();
    grids.Update(scans.pose(s), scans.Read(s));
    if (s < own) continue;
    const bool hint = s > 0 && std::ranges::any_of(hints, [&](double time_s) {
                        return time_s > scans.time_s(s - 1) && time_s <= scans.time_s(s);
                      });
    recording.Update(grids, s, scans.time_s(s), hint);
    recording.Note(grids);
    for (; node != nodes.end() && *node == static_cast<std::int64_t>(s); ++node)
      Keep(grids, &room, &recorded.nodes);
  }
  recorded.snapshot.Add(grids, scans.time_s(scans.size() - 1));
  if (recording.runs()) recording.Finish(scans.size());
  return recorded;
}

}  // namespace cairn::local_map
