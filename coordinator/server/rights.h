// What each request needs: the one table of who may ask what.
#pragma once

#include <optional>
#include <string>

#include "coordinator/core/job_commands.h"
#include "schema/wire.pb.h"

namespace cairn::coordinator {

enum class Right {
  kWork,    // take tasks, answer them, fetch blobs
  kSubmit,  // hand in jobs and command them and the workers
  kView,    // look at jobs, workers and results
};

// Of a message that comes to the coordinator; none where it knows no such message or action.
std::optional<Right> RightNeeded(const wire::Envelope& envelope);

// The command that an action of JobQuery is; none of those that only look.
std::optional<JobCommand> CommandOf(const std::string& action);

// "status, results, …": of JobQuery, for people.
std::string JobActions();
// The same of WorkerQuery.
std::string WorkerActions();

}  // namespace cairn::coordinator
