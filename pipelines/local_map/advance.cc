// Long, for it is one class: what ends each round and plans the next, over one graph.
#include "pipelines/local_map/advance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "pipelines/common/handed_over.h"
#include "pipelines/local_map/path/pass_watch.h"
#include "pipelines/local_map/path/scale_track.h"
#include "pipelines/local_map/plan.h"
#include "pipelines/local_map/result.h"
#include "pipelines/local_map/tasks/follow_task.h"
#include "pipelines/local_map/watched.h"
#include "schema/kinds/map_so_far.h"

namespace cairn::local_map {
namespace {

constexpr std::size_t kQuarters = 4, kNodesOfTask = 40;

Blob NodesBlob(const std::vector<std::size_t>& nodes) {
  Blob blob;
  blob.PutVector("scan", std::vector<std::int64_t>(nodes.begin(), nodes.end()));
  return blob;
}

class Turn {
 public:
  Turn(const Options& options, const State& state, Partials& partials, const Inputs& inputs)
      : options_(options),
        partials_(partials),
        inputs_(inputs),
        standing_(ScalarsIn<Standing>(state)),
        robots_(static_cast<std::size_t>(standing_.robots)) {
    *step_.plan.mutable_state() = state;
  }

  Step Take() && {
    switch (standing_.phase) {
      case Phase::kWalls:
      case Phase::kWallsAgain:
        Orient();
        break;
      case Phase::kTraces:
        KeepTraces();
        LoadGraph();
        ShowSoFar("what was met along the paths, before loops");
        PlanPairs(1, {});
        break;
      case Phase::kPairs:
        LoadGraph();
        JoinPairs();
        break;
      case Phase::kPasses:
        LoadGraph();
        KeepPasses();
        break;
      case Phase::kFollow:
        KeepPositions();
    }
    return std::move(step_);
  }

 private:
  State& state() { return *step_.plan.mutable_state(); }
  void Share(const std::string& name, Blob blob) {
    (*state().mutable_blobs())[name] = step_.Share(std::move(blob));
  }
  // As this turn shared it, else as it was.
  BlobPtr BlobOf(const std::string& name) {
    const std::string& hash = state().blobs().at(name);
    for (const BlobPtr& blob : step_.blobs)
      if (blob->ContentHash().Binary() == hash) return blob;
    return inputs_.Get(name);
  }
  void Enter(Phase phase, std::int64_t round = 0) {
    Standing standing = standing_;
    standing.phase = phase;
    standing.round = round;
    PutScalars(standing, "", &state());
  }

  void Orient() {
    const bool first = standing_.phase == Phase::kWalls;
    const Watched watched = WatchedBy(partials_, robots_);
    if (first && standing_.round == 0 && MeasureMetre(watched)) return;
    std::string note;
    for (std::size_t r = 0; r < robots_; ++r) {
      const BlobPtr rows = inputs_.Get(first ? RowsName(r) : PathName(r));
      std::vector<Scan> scans = RowsIn<Scan>(*rows);
      if (first) ShareMotion(r, watched.motion[r], scans);
      const OrientationTrack track = TrackWalls(SightsOf(scans, watched.edges_m[r]),
                                                MissedTurns(watched.motion[r], scans), options_.orientation);
      MakeWaysGood(watched.motion[r], &scans);
      Share(WallsName(r), WallsBlob(track, first ? nullptr : inputs_.Get(WallsName(r)).get()));
      const double scale = first ? 1 : FitScale(watched.approaches[r]);
      Correct(track, scale, &scans);
      Blob path = *rows;
      PutRows("", scans, &path);
      Share(PathName(r), std::move(path));
      if (!note.empty()) note += "; ";
      note += first ? fmt::format("odometry drifts by {:.3f} rad/m, {:.1f}% of turns, {:.3f} rad/sqrt(m)",
                                  track.drift_rad_per_m, 100 * track.turn_scale, track.walk_rad_per_sqrt_m)
                    : fmt::format("odometry's metre is {:.4f} m by {} walls", scale,
                                  watched.approaches[r].size());
      if (!first) {
        Share(NodesName(r), NodesBlob(ChooseNodes(scans, options_.nodes)));
        std::vector<MetreAt> track = RowsIn<MetreAt>(*inputs_.Get(MetreName(r)));
        for (MetreAt& metre : track) metre.scale *= scale;
        Share(MetreName(r), cairn::BlobOf(track));
      }
      PlanSegments(r, scans, first ? "walls" : "traces");
      all_.push_back({std::move(scans), {}});
    }
    ShowSoFar(first ? "paths along the walls" : "paths along the walls, at their scale");
    Enter(first ? Phase::kWallsAgain : Phase::kTraces);
    double scans = 0;
    for (std::size_t r = 0; r < robots_; ++r)
      scans += static_cast<double>(inputs_.Get(RowsName(r))->at("time_s").size());
    ExpectRest(options_, scans, -1, &step_.plan);
    step_.plan.set_note(note);
  }

  // For people to look at while the stage runs.
  void ShowSoFar(const std::string& what) {
    kinds::MapSoFar map;
    map.what = what;
    map.robots = inputs_.Get("log")->Texts("robots");
    const std::vector<Point> at = cairn::ColumnOf(nodes_, &PathNode::at);
    std::size_t first = 0;
    for (const Robot& robot : all_) {
      std::vector<Scan> scans = robot.scans;
      MoveTo(robot.nodes, at.data() + first, &scans);
      first += robot.nodes.size();
      map.robot.push_back({{cairn::ColumnOf(scans, &Scan::time_s),
                            cairn::ColumnOf(scans, [](const Scan& s) { return s.pose.x_m; }),
                            cairn::ColumnOf(scans, [](const Scan& s) { return s.pose.y_m; })}});
    }
    const std::vector<Point> edges = EdgesOf(traces_, nodes_);
    map.edge_x_m = cairn::ColumnOf(edges, &Point::x_m);
    map.edge_y_m = cairn::ColumnOf(edges, &Point::y_m);
    state().set_so_far(step_.Share(cairn::BlobOf(map)));
  }

  // Where odometry's metre is not one, walls are watched anew along ways that are as long as they should be.
  bool MeasureMetre(const Watched& watched) {
    std::string note;
    for (std::size_t r = 0; r < robots_; ++r) {
      const BlobPtr rows = inputs_.Get(RowsName(r));
      std::vector<Scan> scans = RowsIn<Scan>(*rows);
      for (const Approach& approach : watched.approaches[r]) {
        RequireWithin("an approach's scan", approach.scan, std::int64_t{0},
                      static_cast<std::int64_t>(scans.size()) - 1);
        RequireWithin("an approach's scale", approach.Scale(), -kFarthest_m, kFarthest_m);
        RequireWithin("an approach's sd", approach.sd, 0.0, kFarthest_m);
      }
      for (const WayFit& fit : watched.ways[r]) {
        RequireAllWithin("a way's share", fit.share, 0.0, 1.0);
        RequireWithin("a way's scan", fit.scan, std::int64_t{0}, static_cast<std::int64_t>(scans.size()) - 1);
      }
      std::vector<MetreAt> track = TrackScale(watched.approaches[r], scans);
      if (!track.empty() && !IsBorneOut(track, watched.ways[r], scans)) track.clear();
      Share(MetreName(r), cairn::BlobOf(track));
      if (!track.empty()) {
        const auto [least, most] = std::ranges::minmax(cairn::ColumnOf(track, &MetreAt::scale));
        note +=
            fmt::format("{}odometry's metre is {:.3f} to {:.3f} m", note.empty() ? "" : "; ", least, most);
        Rescale(track, &scans);
        Blob longer = *rows;
        PutRows("", scans, &longer);
        Share(RowsName(r), std::move(longer));
      }
      all_.push_back({std::move(scans), {}});
    }
    if (note.empty()) {
      all_.clear();
      return false;
    }
    for (std::size_t r = 0; r < robots_; ++r) PlanWalls(r, all_[r].scans, options_, &step_.plan);
    Enter(Phase::kWalls, 1);
    ExpectRest(options_, Scans(), -1, &step_.plan);
    step_.plan.set_note(note);
    return true;
  }

  void ShareMotion(std::size_t r, const std::vector<Contradiction>& motion, const std::vector<Scan>& scans) {
    for (const Contradiction& c : motion) {
      RequireWithin("a contradiction's scan", c.to, std::int64_t{1},
                    static_cast<std::int64_t>(scans.size()) - 1);
      RequireWithin("a contradiction's scan", c.from, std::int64_t{0}, c.to - 1);
    }
    Share(MotionName(r), cairn::BlobOf(motion));
  }

  void PlanSegments(std::size_t r, const std::vector<Scan>& scans, const char* kind) {
    const std::vector<std::size_t> nodes = ChooseNodes(scans, options_.nodes);
    for (const Stretch& segment : CutSegments(r, scans, options_)) {
      TaskBuilder task = AddScanTask(kind, segment, PathName(r), &step_.plan);
      if (kind == std::string("walls")) continue;
      const auto first = std::ranges::lower_bound(nodes, segment.own);
      const auto last = std::ranges::lower_bound(nodes, segment.end);
      if (first == last) continue;
      task.Read("nodes", NodesName(r), {first - nodes.begin(), last - first});
    }
  }

  void KeepTraces() {
    std::vector<RecordedTrace> traces;
    std::vector<float> features;
    std::vector<double> robot, frame;
    std::vector<Blob> snapshots;
    std::vector<std::int32_t> of;
    for (std::size_t k = 0; k < partials_.size(); ++k) {
      const BlobPtr partial = partials_.Get(k);
      for (RecordedTrace& trace : ReadTraces(*partial, options_.grid.cell_m))
        traces.push_back(std::move(trace));
      const auto more = partial->Get<float>("node_features");
      features.insert(features.end(), more.begin(), more.end());
      const auto at = partial->Get<double>("node_robot");
      robot.insert(robot.end(), at.begin(), at.end());
      snapshots.push_back(partial->Sub("snapshot/"));
      const std::size_t r = RobotOf(*partial, robots_);
      const BlobPtr walls = inputs_.Get(WallsName(r));
      const auto angle_rad = walls->Get<double>("angle_rad");
      const auto last = partial->Scalar<std::int64_t>("last");
      RequireWithin("last", last, 0, static_cast<std::int64_t>(angle_rad.size()) - 1);
      of.push_back(static_cast<std::int32_t>(r));
      frame.push_back(WrapAngle(angle_rad[static_cast<std::size_t>(last)]));
    }
    Share(kSnapshots, JoinSnapshots(snapshots, of, frame));
    const auto nodes = static_cast<std::int64_t>(robot.size() / (2 * kQuarters));
    Blob surroundings;
    surroundings.Put(
        "features",
        Array::Of<float>({nodes, nodes > 0 ? static_cast<std::int64_t>(features.size()) / nodes : 0},
                         features));
    surroundings.Put("robot", Array::Of<double>({nodes, static_cast<std::int64_t>(2 * kQuarters)}, robot));
    Share(kTraces, TracesBlob(traces));
    Share(kSurroundings, std::move(surroundings));
  }

  // Nodes of all robots, their odometry edges, and the traces.
  void LoadGraph() {
    traces_ = ReadTraces(*BlobOf(kTraces), options_.grid.cell_m);
    for (std::size_t r = 0; r < robots_; ++r) {
      Robot robot{RowsIn<Scan>(*inputs_.Get(PathName(r))), {}};
      const BlobPtr nodes = inputs_.Get(NodesName(r));
      RequireAllWithin("a node's scan", nodes->Get<std::int64_t>("scan"), std::int64_t{0},
                       static_cast<std::int64_t>(robot.scans.size()) - 1);
      for (const std::int64_t scan : nodes->Get<std::int64_t>("scan"))
        robot.nodes.push_back(static_cast<std::size_t>(scan));
      const std::vector<OdometryEdge> odometry_edges = MakeOdometryEdges(
          robot.scans, robot.nodes, static_cast<std::int32_t>(nodes_.size()), options_.nodes);
      odometry_edges_.insert(odometry_edges_.end(), odometry_edges.begin(), odometry_edges.end());
      for (const std::size_t scan : robot.nodes) {
        const Pose& pose = robot.scans[scan].pose;
        const Point at{pose.x_m, pose.y_m};
        nodes_.push_back({r, scan, robot.scans[scan].path_m, at, at});
      }
      all_.push_back(std::move(robot));
    }
    for (const RecordedTrace& trace : traces_) {
      RequireWithin("a trace's robot", static_cast<std::int64_t>(trace.robot), 0,
                    static_cast<std::int64_t>(robots_) - 1);
      const auto scans = static_cast<std::int64_t>(all_[trace.robot].scans.size());
      RequireWithin("a trace's end", static_cast<std::int64_t>(trace.end), 1, scans);
      RequireWithin("a trace's first scan", static_cast<std::int64_t>(trace.first), 0,
                    static_cast<std::int64_t>(trace.end) - 1);
    }
    if (!state().blobs().contains(kPlaced)) return;
    const auto placed = RowsIn<Point>(*inputs_.Get(kPlaced));
    for (std::size_t k = 0; k < nodes_.size(); ++k) nodes_[k].at = placed.at(k);
  }

  // `loops`: of the round before.
  void PlanPairs(std::int64_t round, std::vector<Loop> loops) {
    Enter(Phase::kPairs, round);
    const double wider = std::pow(0.5, static_cast<double>(round - 1));
    const std::vector<Pair> pairs = round > options_.loop_rounds
                                        ? std::vector<Pair>()
                                        : ChoosePairs(nodes_, traces_, wider, options_.pairs);
    if (round == 1) {
      step_.plan.set_note(
          fmt::format("{} traces, {} nodes, {} pairs", traces_.size(), nodes_.size(), pairs.size()));
    }
    if (pairs.empty()) return Finish(std::move(loops));
    Share(kPairs, cairn::BlobOf(pairs));
    const double pair_us = PairUs(round, ScalarsIn<Size>(state()));
    for (std::size_t first = 0; first < pairs.size();) {
      const auto node = static_cast<std::size_t>(pairs[first].node);
      std::size_t end = first;
      while (end < pairs.size() && static_cast<std::size_t>(pairs[end].node) < node + kNodesOfTask) ++end;
      const auto last = static_cast<std::size_t>(pairs[end - 1].node);
      const auto rows = [](std::size_t from, std::size_t to) {
        return BlobRows{static_cast<std::int64_t>(from), static_cast<std::int64_t>(to - from)};
      };
      TaskBuilder task("pairs", pair_us * static_cast<double>(end - first), &step_.plan);
      SetSize(state(), &task);
      task.Read("traces", kTraces)
          .Read("surroundings", kSurroundings, rows(node, last + 1))
          .Read("pairs", kPairs, rows(first, end));
      first = end;
    }
    ExpectRest(options_, Scans(), static_cast<double>(pairs.size()), &step_.plan);
  }

  double Scans() const {
    double scans = 0;
    for (const Robot& robot : all_) scans += static_cast<double>(robot.scans.size());
    return scans;
  }

  void JoinPairs() {
    const std::vector<Pair> pairs = RowsIn<Pair>(*inputs_.Get(kPairs));
    std::vector<Candidate> matches;
    for (std::size_t k = 0; k < partials_.size(); ++k) AppendRows("", *partials_.Get(k), &matches);
    RequireSize("matches", matches.size(), pairs.size());
    for (const Pair& pair : pairs) {
      RequireWithin("a pair's node", std::int64_t{pair.node}, 0,
                    static_cast<std::int64_t>(nodes_.size()) - 1);
      RequireWithin("a pair's trace", std::int64_t{pair.trace}, 0,
                    static_cast<std::int64_t>(traces_.size()) - 1);
    }
    std::vector<LoopConstraint> constraints;
    std::vector<std::size_t> of;  // pairs
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      const LoopConstraint constraint = MakeLoopConstraint(
          pairs[p], matches[p], nodes_, traces_[static_cast<std::size_t>(pairs[p].trace)], options_.pairs);
      if (std::isinf(constraint.sd_z_m) && std::isinf(constraint.sd_u_m)) continue;
      constraints.push_back(constraint);
      of.push_back(p);
    }
    Share(kConstraints, cairn::BlobOf(constraints));
    const OptimizedGraph optimized = Place(constraints);
    ShowSoFar(fmt::format("round {} of loops", standing_.round));
    const auto used = std::ranges::count_if(optimized.weight, [](double w) { return w > 0; });
    std::vector<Loop> loops;
    for (std::size_t k = 0; k < constraints.size(); ++k) {
      const Pair& pair = pairs[of[k]];
      loops.push_back({static_cast<std::size_t>(pair.node),
                       static_cast<std::size_t>(pair.trace),
                       {std::isinf(constraints[k].sd_z_m) ? std::nan("") : matches[of[k]].z_m,
                        std::isinf(constraints[k].sd_u_m) ? std::nan("") : matches[of[k]].u_m},
                       constraints[k].quality,
                       optimized.weight[k] > 0});
    }
    PlanPairs(standing_.round + 1, std::move(loops));
    step_.plan.set_note(
        fmt::format("{} pairs, {} matched, {} followed", pairs.size(), constraints.size(), used));
  }

  // The nodes, by odometry and these.
  OptimizedGraph Place(const std::vector<LoopConstraint>& constraints) {
    const OptimizedGraph optimized = OptimizePoseGraph(cairn::ColumnOf(nodes_, &PathNode::dead),
                                                       odometry_edges_, constraints, options_.pose_graph);
    for (std::size_t k = 0; k < nodes_.size(); ++k) nodes_[k].at = optimized.node[k];
    Share(kPlaced, cairn::BlobOf(optimized.node));
    return optimized;
  }

  void Finish(std::vector<Loop> loops) {
    const BlobPtr log = inputs_.Get("log");
    std::vector<Point> at;
    for (const PathNode& node : nodes_) at.push_back(node.at);
    Blob result;
    result.Put("robots", log->at("robots"));
    result.Put("log_hash", Array::Text(log->SourceHash().Hex()));
    result.PutScalar("cell_m", options_.grid.cell_m);
    Parts parts{.scans = {}, .traces = traces_, .nodes = nodes_, .loops = std::move(loops)};
    std::size_t first = 0;
    for (std::size_t r = 0; r < robots_; ++r) {
      MoveTo(all_[r].nodes, at.data() + first, &all_[r].scans);
      first += all_[r].nodes.size();
      const std::string robot = "robot/" + std::to_string(r) + "/";
      PutPath(robot, all_[r].scans, *inputs_.Get(WallsName(r)), &result);
      result.PutAll(robot + "cuts/", *inputs_.Get(CutsName(r)));
      result.PutAll(robot + "metre/", *inputs_.Get(MetreName(r)));
      PutRows(robot + "fit/",
              Disagreements(RowsIn<Contradiction>(*inputs_.Get(MotionName(r))), all_[r].scans), &result);
      parts.scans.push_back(all_[r].scans);
    }
    PutTraces(parts, &result);
    PutConnections(parts, &result);
    result.PutAll("snapshots/", *BlobOf(kSnapshots));
    Share(kResult, std::move(result));
    Share(kConnections, cairn::BlobOf(MakeConnections(parts)));
    PlanPasses();
  }

  void PlanPasses() {
    if (standing_.lasers == 0) return PlanFollowing();
    Enter(Phase::kPasses);
    for (std::size_t r = 0; r < robots_; ++r) {
      if (all_[r].scans.empty() || LasersIn(*inputs_.Get(RingsName(r))) == 0) continue;
      Blob placed = *inputs_.Get(PathName(r));
      PutRows("", all_[r].scans, &placed);
      Share(PlacedName(r), std::move(placed));
      AddScanTask("passes", {r, 0, 0, all_[r].scans.size()}, PlacedName(r), &step_.plan);
    }
    ExpectRest(options_, Scans(), 0, &step_.plan);
  }

  // Where the scans of many places contradict the path it is sought anew, from where they meet. It stays
  // where fewer contradict it, and no fewer agree.
  void KeepPasses() {
    constexpr double kMany = 0.02;
    constexpr std::int64_t kLeast = 20;
    Blob result = *inputs_.Get(kResult);
    std::int64_t all = 0;
    std::vector<LoopConstraint> meet = TakePasses(&result, &all);
    const auto doubled = static_cast<std::int64_t>(meet.size()), met = all - doubled;
    const bool is_better = doubled * (standing_.met + standing_.doubled) < standing_.doubled * all;
    if (standing_.mends > 0 && (!is_better || met < standing_.met)) {
      Rename(kResultBefore, kResult);
      Rename(kConnectionsBefore, kConnections);
      return PlanFollowing();
    }
    Share(kResult, std::move(result));
    const bool many = doubled >= kLeast && static_cast<double>(doubled) >= kMany * static_cast<double>(all);
    if (!many || standing_.mends >= options_.loop_mends || options_.loop_rounds == 0) return PlanFollowing();
    ++standing_.mends;
    standing_.met = met;
    standing_.doubled = doubled;
    SeekAnew(std::move(meet));
    step_.plan.set_note(fmt::format("{} of {} pairs of scans contradict the path", doubled, all));
  }

  // Puts them into the result, counts them, and returns where those that contradict the path would meet.
  std::vector<LoopConstraint> TakePasses(Blob* result, std::int64_t* all) {
    std::vector<LoopConstraint> meet;
    for (std::size_t k = 0; k < partials_.size(); ++k) {
      const BlobPtr partial = partials_.Get(k);
      const std::size_t r = RobotOf(*partial, robots_);
      const auto passes = RowsIn<Passing>(*partial, "passes/");
      PutPasses("robot/" + std::to_string(r) + "/", passes, all_[r].scans, result);
      *all += static_cast<std::int64_t>(passes.size());
      for (const LoopConstraint& constraint : MakePassConstraints(passes, r, nodes_))
        meet.push_back(constraint);
    }
    return meet;
  }

  // By the last round's loops and these; then the last two rounds once more.
  void SeekAnew(std::vector<LoopConstraint> meet) {
    Rename(kResult, kResultBefore);
    Rename(kConnections, kConnectionsBefore);
    if (state().blobs().contains(kConstraints))
      for (const LoopConstraint& constraint : RowsIn<LoopConstraint>(*inputs_.Get(kConstraints)))
        meet.push_back(constraint);
    Place(meet);
    PlanPairs(std::max(std::int64_t{1}, options_.loop_rounds - 1), {});
  }

  void Rename(const std::string& from, const std::string& to) {
    auto& blobs = *state().mutable_blobs();
    const std::string hash = blobs.at(from);
    blobs[to] = hash;
  }

  void PlanFollowing() {
    Enter(Phase::kFollow);
    for (std::size_t r = 0; r < robots_; ++r) {
      if (all_[r].scans.empty()) continue;
      AddScanTask("follow", {r, 0, 0, all_[r].scans.size()}, PathName(r), &step_.plan)
          .Read("traces", kTraces)
          .Read("connections", kConnections);
      if (LasersIn(*inputs_.Get(RingsName(r))) > 1)
        AddScanTask("lasers", {r, 0, 0, all_[r].scans.size()}, PathName(r), &step_.plan);
    }
    ExpectRest(options_, Scans(), 0, &step_.plan);
  }

  void KeepPositions() {
    Blob result = *inputs_.Get(kResult);
    for (std::size_t k = 0; k < partials_.size(); ++k) {
      const BlobPtr partial = partials_.Get(k);
      const std::string robot = "robot/" + std::to_string(RobotOf(*partial, robots_)) + "/";
      for (const char* table : {"positions/", "lasers/"}) result.PutAll(robot + table, partial->Sub(table));
    }
    step_.plan.set_result(step_.Share(std::move(result)));
    step_.plan.set_note("done");
  }

  struct Robot {
    std::vector<Scan> scans;
    std::vector<std::size_t> nodes;
  };
  const Options& options_;
  Partials& partials_;
  const Inputs& inputs_;
  Standing standing_;
  std::size_t robots_;
  std::vector<Robot> all_;
  std::vector<PathNode> nodes_;
  std::vector<OdometryEdge> odometry_edges_;
  std::vector<RecordedTrace> traces_;
  Step step_;
};

}  // namespace

Step AdvanceLocalMap(const Options& options, const State& state, Partials& partials, const Inputs& inputs) {
  return Turn(options, state, partials, inputs).Take();
}

Blob MatchPairs(const Inputs& inputs, const Options& options, Progress& progress) {
  const std::vector<RecordedTrace> traces = ReadTraces(*inputs.Get("traces"), options.grid.cell_m);
  const std::vector<Pair> pairs = RowsIn<Pair>(*inputs.Get("pairs"));
  const BlobPtr surroundings = inputs.Get("surroundings");
  const auto features = surroundings->Get<float>("features");
  const auto robot = surroundings->Get<double>("robot");
  const int half = static_cast<int>(options.grid.half_cells);
  const std::size_t of_quarter = static_cast<std::size_t>(2 * half + 1) * kFeatureNumbers,
                    of_node = of_quarter * kQuarters, nodes = features.size() / of_node;
  RequireSize("features", features.size(), nodes * of_node);
  RequireSize("robot", robot.size(), nodes * 2 * kQuarters);
  RequireAllWithin("robot", robot, -kFarthest_m, kFarthest_m);
  RequireFeatures(features);
  std::vector<Candidate> matches;
  for (const Pair& pair : pairs) {
    progress.Tick();
    RequireWithin("a pair's trace", std::int64_t{pair.trace}, 0,
                  static_cast<std::int64_t>(traces.size()) - 1);
    RequireWithin("a pair's node", std::int64_t{pair.node} - pairs.front().node, 0,
                  static_cast<std::int64_t>(nodes) - 1);
    RequireWithin("a pair's z_m", pair.at.z_m, -kFarthest_m, kFarthest_m);
    RequireWithin("a pair's u_m", pair.at.u_m, -kFarthest_m, kFarthest_m);
    RequireWithin("a pair's range_m", pair.range_m, 0.0, options.pairs.most_m);
    const RecordedTrace& trace = traces[static_cast<std::size_t>(pair.trace)];
    const auto node = static_cast<std::size_t>(pair.node - pairs.front().node);
    const auto quarter = static_cast<std::size_t>(trace.frame.quarter);
    const EdgeTrace around = TraceOf(options.grid.cell_m, -half,
                                     features.subspan(node * of_node + quarter * of_quarter, of_quarter));
    const std::size_t at = 2 * (kQuarters * node + quarter);
    matches.push_back(MatchPair(pair, trace, around, {robot[at], robot[at + 1]}, options.pairs));
  }
  return BlobOf(matches);
}

}  // namespace cairn::local_map
