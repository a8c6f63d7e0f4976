// Position correction by matching what is around the robot now against a recorded trace ([DM98] section 4.2).
#pragma once

#include "pipelines/local_map/traces/superposed.h"

namespace cairn::local_map {

// How far a position may be off, either way. At most 24 cells count.
struct SearchWindow {
  double z_m = 0.5, u_m = 0.5;
};

struct MatchOptions {
  ScoreOptions score;
  bool again = true;       // z and u once more, with u known: by the sides similarity (the paper: z, then u)
  double sharpness = 0.4;  // nats a unit of summed similarity: neighbouring features are no two witnesses
  double floor_sd_m = 0.01;  // added in squares: what no match resolves
  int min_known = 6;         // sides that must be comparable
  double min_gain = 0.5;     // of the summed similarities, for a correction to be significant
  double kept_m = 0.04;      // a correction below that confirms the position
};

enum class Verdict {
  kUnknown,    // too little can be compared
  kConfirmed,  // the best position is the one that was assumed, to within kept_m
  kCorrected,  // a better one was found: edge and sides similarities together rose significantly
  kRefused,    // a better one was found, but not significantly, or at the end of the range
};

struct Match {
  Verdict verdict = Verdict::kUnknown;
  // The robot's best position in the recorded trace's frame, whatever the verdict; what is not determined
  // stays as it was assumed.
  double z_m = 0, u_m = 0;
  double sd_z_m = 0, sd_u_m = 0;  // standard deviations; infinite: not determined
  // Summed similarities, a comparable side, at the assumed and at the best position: of edge, width and edges
  // across the way (by which z is corrected), and of the sides (u).
  double along_before = 0, along_after = 0;
  double sides_before = 0, sides_after = 0;
  int known = 0;  // sides that could be compared at the best position

  bool usable() const { return verdict == Verdict::kConfirmed || verdict == Verdict::kCorrected; }
};

// First z is corrected to maximise edge and width similarity, then u to maximise the sides similarity. No
// allocation.
Match Correct(const OnTrace& on, const SearchWindow& range, const MatchOptions& options);
inline Match Correct(const EdgeTrace& recorded, const ImmediateTrace& now, const Position& at,
                     const SearchWindow& range, const MatchOptions& options) {
  return Correct(OnTrace{recorded, now, at}, range, options);
}

// Two connected traces at a right angle, the second turned by `quarter` (1: left, -1: right) from the first,
// each with an immediate trace of its own direction: a step along one is a step across the other, so that
// what z rests on in one and u in the other decide together. `range` is the first trace's; the matches tell
// of the same correction.
struct PairMatch {
  Match first, second;
};
PairMatch CorrectPair(const OnTrace& first, const OnTrace& second, int quarter, const SearchWindow& range,
                      const MatchOptions& options);

}  // namespace cairn::local_map
