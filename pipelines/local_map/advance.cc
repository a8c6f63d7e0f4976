#include "pipelines/local_map/advance.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "pipelines/local_map/path/corrected_path.h"
#include "pipelines/local_map/path/scale_watch.h"
#include "pipelines/local_map/plan.h"
#include "pipelines/local_map/result.h"
#include "pipelines/local_map/tasks/follow_task.h"

namespace cairn::local_map {
namespace {

constexpr std::size_t kQuarters = 4, kKnotsOfTask = 40;

// What the tasks saw of walls, of each robot.
struct Watched {
  std::vector<std::vector<float>> edges_m;
  std::vector<std::vector<Approach>> approaches;
};

Watched WatchedBy(Partials& partials, std::size_t robots) {
  Watched watched{std::vector<std::vector<float>>(robots), std::vector<std::vector<Approach>>(robots)};
  for (std::size_t k = 0; k < partials.size(); ++k) {
    const BlobPtr partial = partials.Get(k);
    const auto r = static_cast<std::size_t>(partial->Scalar<std::int64_t>("robot"));
    const auto edges = partial->Get<float>("edges_m");
    watched.edges_m[r].insert(watched.edges_m[r].end(), edges.begin(), edges.end());
    const auto way2 = partial->Get<double>("way2_m2"), distance = partial->Get<double>("way_distance_m2");
    for (std::size_t a = 0; a < way2.size(); ++a) watched.approaches[r].push_back({way2[a], distance[a]});
  }
  return watched;
}

std::vector<OrientationSight> SightsOf(const std::vector<Sweep>& sweeps, const std::vector<float>& edges) {
  std::vector<OrientationSight> sights(sweeps.size());
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    sights[s].path_m = sweeps[s].path_m;
    sights[s].heading_rad = sweeps[s].pose.heading_rad;
    std::copy_n(edges.begin() + static_cast<std::ptrdiff_t>(s * kBins), kBins, sights[s].edges_m.begin());
    sights[s].begins = s > 0 && sweeps[s].jumped;
  }
  return sights;
}

Blob KnotsBlob(const std::vector<std::size_t>& knots) {
  Blob blob;
  blob.PutVector("sweep", std::vector<std::int64_t>(knots.begin(), knots.end()));
  return blob;
}

class Turn {
 public:
  Turn(const Options& options, const State& state, Partials& partials, const Inputs& inputs)
      : options_(options),
        partials_(partials),
        inputs_(inputs),
        phase_(state.scalars().at(kPhase).s()),
        robots_(static_cast<std::size_t>(state.scalars().at(kRobots).i())) {
    *step_.plan.mutable_state() = state;
  }

  Step Take() && {
    if (phase_ == "walls" || phase_ == "walls again") {
      Orient();
    } else if (phase_ == "traces") {
      KeepTraces();
      LoadGraph();
      PlanPairs(1, {});
    } else if (phase_ == "pairs") {
      LoadGraph();
      JoinPairs();
    } else {
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
  void SetPhase(const char* phase) { (*state().mutable_scalars())[kPhase].set_s(phase); }

  void Orient() {
    const bool first = phase_ == "walls";
    const Watched watched = WatchedBy(partials_, robots_);
    std::string note;
    for (std::size_t r = 0; r < robots_; ++r) {
      const BlobPtr rows = inputs_.Get(first ? RowsName(r) : PathName(r));
      std::vector<Sweep> sweeps = SweepsOf(*rows);
      const OrientationTrack track =
          TrackOrientation(SightsOf(sweeps, watched.edges_m[r]), options_.orientation);
      Share(WallsName(r), WallsBlob(track, first ? nullptr : inputs_.Get(WallsName(r)).get()));
      const double scale = first ? 1 : ScaleOf(watched.approaches[r]);
      Correct(track, scale, &sweeps);
      Share(PathName(r), WithPoses(*rows, sweeps));
      char text[160];
      if (first)
        std::snprintf(text, sizeof text, "odometry drifts by %.3f rad/m, %.1f%% of turns, %.3f rad/sqrt(m)",
                      track.drift_rad_per_m, 100 * track.turn_scale, track.walk_rad_per_sqrt_m);
      else
        std::snprintf(text, sizeof text, "odometry's metre is %.4f m by %zu walls", scale,
                      watched.approaches[r].size());
      note += (note.empty() ? "" : "; ") + std::string(text);
      if (!first) Share(KnotsName(r), KnotsBlob(KnotsOf(sweeps, options_.knots)));
      PlanSegments(r, sweeps, first ? "walls" : "traces");
    }
    const char* phase = first ? "walls again" : "traces";
    SetPhase(phase);
    double sweeps = 0;
    for (std::size_t r = 0; r < robots_; ++r)
      sweeps += static_cast<double>(inputs_.Get(RowsName(r))->at("time_s").size());
    ExpectRest(phase, options_, 0, sweeps, -1, &step_.plan);
    step_.plan.set_note(note);
  }

  void PlanSegments(std::size_t r, const std::vector<Sweep>& sweeps, const char* kind) {
    const std::vector<std::size_t> knots = KnotsOf(sweeps, options_.knots);
    for (const Stretch& segment : SegmentsOf(r, sweeps, options_)) {
      TaskBuilder task = AddSweepTask(kind, std::string(kind) == "walls" ? kWallsUs : kTracesUs, segment,
                                      PathName(r), &step_.plan);
      if (kind == std::string("walls")) continue;
      const auto first = std::ranges::lower_bound(knots, segment.own);
      const auto last = std::ranges::lower_bound(knots, segment.end);
      if (first == last) continue;
      task.Read("knots", KnotsName(r), {first - knots.begin(), last - first});
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
      for (RecordedTrace& trace : TracesOf(*partial, options_.grid.cell_m))
        traces.push_back(std::move(trace));
      const auto more = partial->Get<float>("knot_features");
      features.insert(features.end(), more.begin(), more.end());
      const auto at = partial->Get<double>("knot_robot");
      robot.insert(robot.end(), at.begin(), at.end());
      snapshots.push_back(partial->Sub("snapshot/"));
      const auto r = static_cast<std::size_t>(partial->Scalar<std::int64_t>("robot"));
      const auto last = static_cast<std::size_t>(partial->Scalar<std::int64_t>("last"));
      of.push_back(static_cast<std::int32_t>(r));
      frame.push_back(WrapAngle(inputs_.Get(WallsName(r))->Get<double>("angle_rad")[last]));
    }
    Share(kSnapshots, JoinSnapshots(snapshots, of, frame));
    const auto knots = static_cast<std::int64_t>(robot.size() / (2 * kQuarters));
    Blob surroundings;
    surroundings.Put(
        "features",
        Array::Of<float>({knots, knots > 0 ? static_cast<std::int64_t>(features.size()) / knots : 0},
                         features));
    surroundings.Put("robot", Array::Of<double>({knots, static_cast<std::int64_t>(2 * kQuarters)}, robot));
    Share(kTraces, TracesBlob(traces));
    Share(kSurroundings, std::move(surroundings));
  }

  // Knots of all robots, their legs, and the traces.
  void LoadGraph() {
    traces_ = TracesOf(*BlobOf(kTraces), options_.grid.cell_m);
    for (std::size_t r = 0; r < robots_; ++r) {
      Robot robot{SweepsOf(*inputs_.Get(PathName(r))), {}};
      for (const std::int64_t sweep : inputs_.Get(KnotsName(r))->Get<std::int64_t>("sweep"))
        robot.knots.push_back(static_cast<std::size_t>(sweep));
      const std::vector<Leg> legs =
          LegsOf(robot.sweeps, robot.knots, static_cast<std::int32_t>(knots_.size()), options_.knots);
      legs_.insert(legs_.end(), legs.begin(), legs.end());
      for (const std::size_t sweep : robot.knots) {
        const Pose& pose = robot.sweeps[sweep].pose;
        const Point at{pose.x_m, pose.y_m};
        knots_.push_back({r, sweep, robot.sweeps[sweep].path_m, at, at});
      }
      all_.push_back(std::move(robot));
    }
    if (!state().blobs().contains(kPlaced)) return;
    const BlobPtr placed = inputs_.Get(kPlaced);
    const auto at = placed->Get<double>("at");
    for (std::size_t k = 0; k < knots_.size(); ++k) knots_[k].at = {at[2 * k], at[2 * k + 1]};
  }

  // `loops`: of the round before.
  void PlanPairs(std::int64_t round, std::vector<Loop> loops) {
    (*state().mutable_scalars())[kRound].set_i(round);
    SetPhase("pairs");
    const double wider = std::pow(0.5, static_cast<double>(round - 1));
    const std::vector<Pair> pairs =
        round > options_.loop_rounds ? std::vector<Pair>() : PairsOf(knots_, traces_, wider, options_.pairs);
    if (round == 1) {
      char text[100];
      std::snprintf(text, sizeof text, "%zu traces, %zu knots, %zu pairs", traces_.size(), knots_.size(),
                    pairs.size());
      step_.plan.set_note(text);
    }
    if (pairs.empty()) return Finish(std::move(loops));
    Share(kPairs, PairsBlob(pairs));
    for (std::size_t first = 0; first < pairs.size();) {
      const auto knot = static_cast<std::size_t>(pairs[first].knot);
      std::size_t end = first;
      while (end < pairs.size() && static_cast<std::size_t>(pairs[end].knot) < knot + kKnotsOfTask) ++end;
      const auto last = static_cast<std::size_t>(pairs[end - 1].knot);
      const auto rows = [](std::size_t from, std::size_t to) {
        return BlobRows{static_cast<std::int64_t>(from), static_cast<std::int64_t>(to - from)};
      };
      TaskBuilder("pairs", PairUs(round) * static_cast<double>(end - first), &step_.plan)
          .Read("traces", kTraces)
          .Read("surroundings", kSurroundings, rows(knot, last + 1))
          .Read("pairs", kPairs, rows(first, end));
      first = end;
    }
    ExpectRest("pairs", options_, round, Sweeps(), static_cast<double>(pairs.size()), &step_.plan);
  }

  double Sweeps() const {
    double sweeps = 0;
    for (const Robot& robot : all_) sweeps += static_cast<double>(robot.sweeps.size());
    return sweeps;
  }

  void JoinPairs() {
    const std::vector<Pair> pairs = PairsOfBlob(*inputs_.Get(kPairs));
    std::vector<Candidate> matches;
    for (std::size_t k = 0; k < partials_.size(); ++k) AppendMatches(*partials_.Get(k), &matches);
    std::vector<Relation> relations;
    std::vector<std::size_t> of;  // pairs
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      const Relation relation = RelationOf(pairs[p], matches[p], knots_,
                                           traces_[static_cast<std::size_t>(pairs[p].trace)], options_.pairs);
      if (std::isinf(relation.sd_z_m) && std::isinf(relation.sd_u_m)) continue;
      relations.push_back(relation);
      of.push_back(p);
    }
    std::vector<Point> start;
    for (const Knot& knot : knots_) start.push_back(knot.dead);
    const Assembly assembly = Assemble(start, legs_, relations, options_.assembly);
    std::vector<double> placed;
    for (std::size_t k = 0; k < knots_.size(); ++k) {
      knots_[k].at = assembly.knot[k];
      placed.insert(placed.end(), {knots_[k].at.x_m, knots_[k].at.y_m});
    }
    Blob blob;
    blob.PutVector("at", placed);
    Share(kPlaced, std::move(blob));
    const auto used = std::ranges::count_if(assembly.weight, [](double w) { return w > 0; });
    const std::int64_t round = state().scalars().at(kRound).i();
    char text[160];
    std::snprintf(text, sizeof text, "%zu pairs, %zu matched, %lld followed", pairs.size(), relations.size(),
                  static_cast<long long>(used));
    std::vector<Loop> loops;
    for (std::size_t k = 0; k < relations.size(); ++k) {
      const Pair& pair = pairs[of[k]];
      loops.push_back({static_cast<std::size_t>(pair.knot),
                       static_cast<std::size_t>(pair.trace),
                       {std::isinf(relations[k].sd_z_m) ? std::nan("") : matches[of[k]].z_m,
                        std::isinf(relations[k].sd_u_m) ? std::nan("") : matches[of[k]].u_m},
                       relations[k].quality,
                       assembly.weight[k] > 0});
    }
    PlanPairs(round + 1, std::move(loops));
    step_.plan.set_note(text);
  }

  void Finish(std::vector<Loop> loops) {
    const BlobPtr log = inputs_.Get("log");
    std::vector<Point> at;
    for (const Knot& knot : knots_) at.push_back(knot.at);
    Blob result;
    result.Put("robots", log->at("robots"));
    result.Put("log_hash", Array::Text(log->Without("truth/").ContentHash().Hex()));
    result.PutScalar("cell_m", options_.grid.cell_m);
    Parts parts{.sweeps = {}, .traces = traces_, .knots = knots_, .loops = std::move(loops)};
    std::size_t first = 0;
    for (std::size_t r = 0; r < robots_; ++r) {
      MoveTo(all_[r].knots, at.data() + first, &all_[r].sweeps);
      first += all_[r].knots.size();
      const std::string robot = "robot/" + std::to_string(r) + "/";
      PutPoses(robot + "poses/", all_[r].sweeps, &result);
      PutWalls(robot + "walls/", all_[r].sweeps, *inputs_.Get(WallsName(r)), &result);
      result.PutAll(robot + "cuts/", *inputs_.Get(CutsName(r)));
      parts.sweeps.push_back(all_[r].sweeps);
    }
    PutTraces(parts, &result);
    PutConnections(parts, &result);
    result.PutAll("snapshots/", *BlobOf(kSnapshots));
    Share(kResult, std::move(result));
    Share(kConnections, ConnectionsBlob(ConnectionsOf(parts)));
    PlanFollowing();
  }

  void PlanFollowing() {
    SetPhase("follow");
    for (std::size_t r = 0; r < robots_; ++r) {
      if (all_[r].sweeps.empty()) continue;
      AddSweepTask("follow", kFollowUs, {r, 0, 0, all_[r].sweeps.size()}, PathName(r), &step_.plan)
          .Read("traces", kTraces)
          .Read("connections", kConnections);
    }
    ExpectRest("follow", options_, 0, Sweeps(), 0, &step_.plan);
  }

  void KeepPositions() {
    Blob result = *inputs_.Get(kResult);
    for (std::size_t k = 0; k < partials_.size(); ++k) {
      const BlobPtr partial = partials_.Get(k);
      const std::string robot = "robot/" + std::to_string(partial->Scalar<std::int64_t>("robot"));
      result.PutAll(robot + "/positions/", partial->Sub("positions/"));
    }
    step_.plan.set_result(step_.Share(std::move(result)));
    step_.plan.set_note("done");
  }

  struct Robot {
    std::vector<Sweep> sweeps;
    std::vector<std::size_t> knots;
  };
  const Options& options_;
  Partials& partials_;
  const Inputs& inputs_;
  std::string phase_;
  std::size_t robots_;
  std::vector<Robot> all_;
  std::vector<Knot> knots_;
  std::vector<Leg> legs_;
  std::vector<RecordedTrace> traces_;
  Step step_;
};

}  // namespace

Step AdvanceLocalMap(const Options& options, const State& state, Partials& partials, const Inputs& inputs) {
  return Turn(options, state, partials, inputs).Take();
}

Blob MatchPairs(const Inputs& inputs, const Options& options, Progress& progress) {
  const std::vector<RecordedTrace> traces = TracesOf(*inputs.Get("traces"), options.grid.cell_m);
  const std::vector<Pair> pairs = PairsOfBlob(*inputs.Get("pairs"));
  const BlobPtr surroundings = inputs.Get("surroundings");
  const auto features = surroundings->Get<float>("features");
  const auto robot = surroundings->Get<double>("robot");
  const std::size_t of_knot = features.size() / (robot.size() / (2 * kQuarters)),
                    of_quarter = of_knot / kQuarters;
  const int half = static_cast<int>(options.grid.half_cells);
  std::vector<Candidate> matches;
  for (const Pair& pair : pairs) {
    progress.Tick();
    const RecordedTrace& trace = traces[static_cast<std::size_t>(pair.trace)];
    const auto knot = static_cast<std::size_t>(pair.knot - pairs.front().knot);
    const auto quarter = static_cast<std::size_t>(trace.frame.quarter);
    const EdgeTrace around = TraceOf(options.grid.cell_m, -half,
                                     features.subspan(knot * of_knot + quarter * of_quarter, of_quarter));
    const std::size_t at = 2 * (kQuarters * knot + quarter);
    matches.push_back(MatchPair(pair, trace, around, {robot[at], robot[at + 1]}, options.pairs));
  }
  return MatchesBlob(matches);
}

}  // namespace cairn::local_map
