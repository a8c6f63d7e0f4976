// How a service stands, for programs that watch many: a line and an exit code, as Nagios' plugins have them.
#pragma once

#include <string>
#include <vector>

#include "coordinator/client.h"

namespace cairn::cli {

struct ServiceVerdict {
  int code = 0;      // 0 fine, 1 warning, 2 critical
  std::string line;  // "CAIRN OK: 1 job running, 3 workers | jobs_running=1 …"
};

// Critical: its store cannot be written, or jobs wait and no worker can take them. Warning: jobs that are
// paused, though not by their owner, workers that hang, a store that is nearly full, what it warns of itself.
ServiceVerdict CheckService(const coordinator::JobList& list, const std::vector<wire::WorkerInfo>& workers);

// Nobody answers.
ServiceVerdict Unanswered(const std::string& why);

}  // namespace cairn::cli
