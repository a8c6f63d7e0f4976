// A job that task_times recorded (tests/bench), run again by the coordinator's core in a time of its own:
// what people would have been told of the time left, and what was true.
#pragma once

#include <string>
#include <vector>

#include "schema/job.pb.h"

namespace cairn::eta {

// Seconds are of one core.
struct Trace {
  struct Round {
    proto::Step step;
    std::vector<double> task_s;
    double advance_s = 0;
  };
  double start_s = 0;
  std::vector<Round> rounds;
};

// Throws InputError that names the file and the line.
Trace ReadTrace(const std::string& path);

// A moment of the job.
struct Said {
  double at_s = 0;
  double said_s = 0;               // 0: unknown
  double least_s = 0, most_s = 0;  // the span that it is in
  double true_s = 0;

  // Whether a span is told and no figure (LeftText in coordinator/cli/output/progress_line.h).
  bool IsSpan() const { return most_s > 2 * least_s; }
};

struct Fleet {
  int workers = 2;
  // Another one joins, or the last one leaves, after so many seconds; 0: none does.
  double joins_s = 0, leaves_s = 0;
  // The job is paused and goes on so much later.
  double paused_s = 0, resumed_s = 0;
};

// What is said every half second from the job's submission to its end.
std::vector<Said> Replay(const Trace& trace, const Fleet& fleet = {});

// Whether it, or what is true lies outside of its span, is at most twice off, or by two seconds.
inline constexpr double kMostOff = 2, kSlack_s = 2;
double Nearest(const Said& said);  // of what is told, to what is true
bool IsNear(const Said& said);

}  // namespace cairn::eta
