// Recording an edge trace along a straight way ([DM98] section 4.1).
#pragma once

#include <vector>

#include "pipelines/local_map/traces/immediate_trace.h"

namespace cairn::local_map {

struct RecorderOptions {
  std::size_t capacity = 256;  // features; at a cell of 0.15 m: 38 m
  double blocked_s = 30;       // an obstacle in the way that stays that long ends a trace
  double ahead_m = 1;        // 'in the way': an occupied cell up to there, before a robot that does not move
  double width_m = 0.3;      // and no further than that from its line
  double still_m = 0.1;      // 'does not move': by less than that
  double turned_rad = 0.35;  // a way is straight while the heading stays within that of it
  double aside_m = 0.6;      // and the robot within that of its line,
  double back_m = 0.6;       // and goes back on it by no more than that
  int votes = 50;            // scans after which a feature changes no more quickly
};

enum class TraceEnd {
  kNone,     // goes on
  kBlocked,  // by an obstacle that stayed
  kTurn,     // the robot turned, left the line, or went back on it
  kHint,     // the log says so
  kFrame,    // the grids were turned along the walls
  kFull,     // has all the features that it may
};

class TraceRecorder {
 public:
  // All memory is taken here.
  explicit TraceRecorder(const LocalGrids& grids, const RecorderOptions& options = {});

  // Begins a trace where the robot is, in that of the four directions that it faces. It grows to either side:
  // a robot may drive backwards.
  void Begin(const LocalGrids& grids, double time_s);

  // Superposes the edge grid upon the trace, after each scan; says whether the trace ends with it. `hint`: a
  // marked time lies since the last call.
  TraceEnd Update(const LocalGrids& grids, double time_s, bool hint = false);

  // Whether the robot has driven further back from where the trace began than ahead.
  bool backwards() const;

  // In the direction that the robot faced.
  const EdgeTrace& trace() const { return trace_; }
  const TraceFrame& frame() const { return frame_; }
  // The robot in the trace's frame.
  Position RobotAt(const LocalGrids& grids) const;

 private:
  // How sure a recorded side is: rises with each scan that agrees, falls with each that does not.
  struct Votes {
    int along = 0, cross = 0, occupied = 0;
  };
  struct FeatureVotes {
    Votes left, right;
  };
  void Merge(Side& side, Votes& votes, const Side& now) const;
  TraceEnd EndOf(const LocalGrids& grids, double time_s);
  bool Blocked(const LocalGrids& grids, const Position& robot) const;

  RecorderOptions options_;
  TraceFrame frame_;
  EdgeTrace trace_;
  std::vector<FeatureVotes> votes_;
  double heading_rad_ = 0;  // of the way, in the local frame
  double frame_rad_ = 0;    // of the local frame, when the trace began
  double still_since_s_ = 0;
  Position still_at_;
  double begun_z_m_ = 0, least_z_m_ = 0, most_z_m_ = 0;  // of the robot
};

}  // namespace cairn::local_map
