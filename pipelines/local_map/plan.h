// How local_map is cut into rounds and tasks, and what its state holds by which names.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pipelines/common/task_builder.h"
#include "pipelines/local_map/options.h"
#include "pipelines/local_map/path/runs.h"
#include "pipelines/local_map/size.h"
#include "pipelines/local_map/state.h"
#include "pipelines/pipeline.h"

namespace cairn::local_map {

// The state's blobs of robot `r`.
inline std::string RingsName(std::size_t r) { return "rings " + std::to_string(r); }
inline std::string RowsName(std::size_t r) { return "rows " + std::to_string(r); }  // RowsOf
inline std::string PathName(std::size_t r) { return "path " + std::to_string(r); }  // RowsOf, corrected poses
inline std::string WallsName(std::size_t r) { return "walls " + std::to_string(r); }  // of each scan
inline std::string NodesName(std::size_t r) { return "nodes " + std::to_string(r); }  // scans of nodes
// What scans contradict of its dead reckoning (path/motion_watch.h).
inline std::string MotionName(std::size_t r) { return "motion " + std::to_string(r); }
inline std::string MetreName(std::size_t r) { return "metre " + std::to_string(r); }  // path/scale_track.h
inline std::string CutsName(std::size_t r) { return "cuts " + std::to_string(r); }
inline std::string PlacedName(std::size_t r) { return "placed " + std::to_string(r); }  // RowsOf, optimized
inline constexpr char kLogInput[] = "log";
inline constexpr char kTraces[] = "traces", kSurroundings[] = "surroundings", kPairs[] = "pairs";
inline constexpr char kPlaced[] = "placed", kSnapshots[] = "snapshots";
inline constexpr char kConstraints[] = "constraints";  // of the last round
inline constexpr char kResultBefore[] = "result before", kConnectionsBefore[] = "connections before";
inline constexpr char kConnections[] = "connections", kResult[] = "result";

// A stretch of scans that one task goes through, those before `own` to warm up.
struct Stretch {
  std::size_t robot = 0, first = 0, own = 0, end = 0;  // scans of the robot
};

// Each run by itself, in pieces of about equal length, of `segment_scans` at most.
std::vector<Stretch> CutSegments(std::size_t robot, const std::vector<Scan>& scans, const Options& options);

// Microseconds of a core: a scan of a task of each kind, and a pair, which is looked at less far in each
// round than in the one before.
double ScanUs(std::string_view kind, const Size& size);
double PairUs(std::int64_t round, const Size& size);
// After the tasks: what ADVANCE takes, and what is expected to follow the round that the State stands at, by
// the scans of all robots and the pairs of the round (below 0: not known yet).
void ExpectRest(const Options& options, double scans, double pairs, proto::Step* plan);

// A task that reads scans [first, end) of the rows `rows_name` of the state, which has the Size.
TaskBuilder AddScanTask(const char* kind, const Stretch& stretch, const std::string& rows_name,
                        proto::Step* plan);
// The tasks of a robot that watch walls along dead reckoning.
void PlanWalls(std::size_t robot, const std::vector<Scan>& scans, const Options& options, proto::Step* plan);

}  // namespace cairn::local_map
