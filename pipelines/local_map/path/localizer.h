// Where a robot is, in the private frames of the traces around it ([DM98] section 4.3): one call a scan.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "pipelines/local_map/traces/graph.h"
#include "pipelines/local_map/traces/immediate_trace.h"
#include "pipelines/local_map/traces/match.h"

namespace cairn::local_map {

struct LocalizerOptions {
  double range_per_m = 0.02;      // that a position's range grows by, a metre travelled
  double least_m = 0.05;          // ranges never fall below
  double most_m = 0.5;            // nor grow beyond, while any position is being corrected:
  double lost_m = 5;              // after that way without any correction, or a jump, the robot is lost,
  double lost_most_m = 2.4;       // and ranges grow up to this until a correction is found
  double aside_m = 1.5;           // from a trace's way the robot may be for the trace to be active
  std::size_t most_active = 8;    // traces, those whose way is nearest
  double least_similarity = 0.3;  // a comparable side, below which the best position is none
  double agree_m = 0.1;           // to which positions on crossing traces agree that are corrected as a pair
  double better = 0.1;            // by so much a comparable side an overriding position must match better
  MatchOptions match;
};

// What is kept of a trace.
struct Held {
  Position at;
  SearchWindow range;
  bool active = false;     // the robot is in its area
  bool corrected = false;  // by this scan
  double similarity = 0;   // of sides, at the last match
};

class TraceLocalizer {
 public:
  // `capacity`: traces that the graph may grow to without allocation by Update.
  TraceLocalizer(const LocalGrids& grids, const LocalizerOptions& options, std::size_t capacity);

  // To be called for a trace that was added to the graph; `at`: where the robot is in its frame, if that is
  // known, as it is of a trace that has just been recorded.
  void Begin(int trace, const std::optional<Position>& at, const SearchWindow& range);

  // After each update of the grids. Moves all positions by what the robot moved and widens their ranges;
  // hands positions on along connections; corrects those of active traces by matching. Does not allocate.
  // `more_m`: sd of what the robot may have moved beside its odometry, as by a jump.
  void Update(const LocalGrids& grids, const TraceGraph& graph, double more_m = 0);

  const std::optional<Held>& held(int trace) const { return held_[static_cast<std::size_t>(trace)]; }

 private:
  void Move(const LocalGrids& grids, const TraceGraph& graph, double more_m);
  void Activate(const TraceGraph& graph);
  void HandOn(const LocalGrids& grids, const TraceGraph& graph);
  void Correct(const LocalGrids& grids, const TraceGraph& graph, Held* held, int trace);
  // Whether `trace` was corrected together with one that crosses it.
  bool CorrectWithCrossing(const LocalGrids& grids, const TraceGraph& graph, int trace);
  void Take(const Match& match, Held* held) const;
  Match Search(const OnTrace& on, const SearchWindow& range) const;
  const ImmediateTrace& Around(const LocalGrids& grids, int quarter);

  LocalizerOptions options_;
  std::vector<std::optional<Held>> held_;
  std::vector<int> order_;
  std::array<ImmediateTrace, 4> around_;
  std::array<bool, 4> made_{};  // of this scan
  std::optional<Pose> before_;
  double uncorrected_m_ = 0;  // travelled
  bool lost_ = false;
};

}  // namespace cairn::local_map
