// How many workers an engine should run: a pure function of what the service could use, what there is, and
// for how long.
#pragma once

#include <cstddef>
#include <vector>

#include "schema/wire.pb.h"

namespace cairn::coordinator {

struct PolicyOptions {
  int least = 0, most = 1;  // workers
  double work_s = 30;       // so many seconds of work are worth a worker
  double idle_s = 60;       // one that had nothing to do for so long may go …
  double cool_down_s = 30;  // … but none so soon after one was started
};

// One of those that were started here: it is there, or was asked for.
struct ScaledWorker {
  enum class State {  // those that go first come first
    kWaiting,         // for its place at the engine
    kStarting,        // it has its place, and has not said Hello
    kIdle,
    kBusy,
    kLeaving,  // it was told to go
  };
  State state = State::kStarting;
  double for_s = 0;  // in that state
};

struct Decision {
  int start = 0;  // so many more
  // Those of `ours` that may go: that have long been idle or waited; where there are more than `most`, as
  // some came back that were taken for lost, others too, once they have finished what they run.
  std::vector<std::size_t> leave;
};

// Of each job as many as it has tasks side by side, but no more than its work is worth, at least `least`, at
// most `most`; one where there is any job at all.
int WorkersWanted(const PolicyOptions& options, const std::vector<wire::Demand>& demand);

// `others`: workers that serve too, and are none of ours. `started_s`: since one was last started.
Decision Decide(const PolicyOptions& options, const std::vector<wire::Demand>& demand, int others,
                const std::vector<ScaledWorker>& ours, double started_s);

}  // namespace cairn::coordinator
