// How long the stage under way will take yet. Its pipeline says what work it expects (Task.cost, Step.later,
// Step.advance_cost), the answers of workers say what work takes. For people; no result depends on it.
//
// The rest of the round takes slowness times pace times the larger of its work over the workers and its
// longest chain of tasks; each later phase the same, by as many workers as it is wide, and an ADVANCE a
// round. A phase without a round is what the last ADVANCE takes beyond what was said of it. Pace is seconds
// of a worker for a unit of cost; slowness is how much longer rounds took than that, as workers wait or serve
// other jobs.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "coordinator/core/round.h"

namespace cairn::coordinator {

// Who works at a job.
struct Effort {
  double workers = 0;                                       // that it can have
  std::vector<std::pair<std::uint32_t, double>> running_s;  // its tasks that run, in order; for how long
};

// A span where the data decide what work is to come (Phase.least, Phase.most), else three times the same. 0:
// unknown.
struct TimeLeft {
  double least_s = 0, expected_s = 0, most_s = 0;
};

class Eta {
 public:
  // A stage begins, or a job goes on: nothing is under way, and what was shown no longer counts.
  void BeginStage();
  void GoOn() { shows_ = false; }
  // It stood still for so long, which was no work.
  void Skip(double seconds, double now_s) { tasks_ended_s_ = std::min(now_s, tasks_ended_s_ + seconds); }
  // A step was planned, or taken up again.
  void BeginRound(const proto::Step& step, const Round& tasks, double now_s);
  // An answer to a RUN task, after so many seconds of a worker.
  void NoteTask(double cost, double seconds);
  // All tasks of the round, which began then, are done; ADVANCE is due.
  void EndTasks(double since_s, double now_s);
  // The round's ADVANCE is answered.
  void EndRound(double now_s);

  // What it takes from now on, as far as that is known now; `tasks` are those of the step, or its ADVANCE.
  TimeLeft Expected(const proto::Step& step, const Round& tasks, const Effort& effort, double now_s) const;
  // Seconds of one worker that the stage has left, whoever else has work.
  double Work_s(const proto::Step& step, const Round& tasks) const;
  // Whether it is time to look again.
  bool IsDue(double now_s) const { return jumps_ || !shows_ || now_s - looked_s_ >= kLook_s; }
  void Look(const proto::Step& step, const Round& tasks, const Effort& effort, double now_s);
  // What people are told: of the last look, counted down. Between two looks it counts down, and moves towards
  // what is expected then by at most kShare + kYoung / (seconds since the stage began) of itself, and kSlack
  // s, in a second; but where the plan has changed (another step than was expected, other workers) it is what
  // is expected. The span's ends are as many times that as they were at the last look.
  TimeLeft Shown(double now_s) const;

  static constexpr double kLook_s = 0.5, kShare = 0.02, kYoung = 2, kSlack = 0.5;

 private:
  double Pace(const Round& tasks, const Effort& effort) const;
  double Slowness() const;
  double Run_s(double cost, double chain, const Effort& effort, double pace) const;

  // Sums that forget: of cost and of a worker's seconds; of rounds, what they took and what their tasks alone
  // would have; of ADVANCE.
  double cost_ = 0, seconds_ = 0;
  double rounds_s_ = 0, alone_s_ = 0;
  double advance_s_ = 0, advances_ = 0;
  double noted_s_ = 0;        // of this round's tasks
  double chain_part_ = 0;     // of the round's cost, that its longest chain has
  double tasks_ended_s_ = 0;  // when
  double began_s_ = 0;        // the stage
  bool begun_ = false;        // the stage has a step
  double expected_cost_ = 0;  // of the next step and all after it
  double workers_ = 0;        // at the last look
  bool shows_ = false;        // there was a look
  bool jumps_ = false;        // at the next one
  double shown_s_ = 0, looked_s_ = 0;
  double least_ = 1, most_ = 1;  // times what is shown
};

}  // namespace cairn::coordinator
