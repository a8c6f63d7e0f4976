// What a job's owner may tell it, and in which of its states. README.md has the table.
#pragma once

#include <string>

#include "coordinator/core/job.h"

namespace cairn::coordinator {

enum class JobCommand { kPause, kResume, kCancel, kRetry, kDelete, kPrioritize };

// Why the job does not obey, for people, with what would help; empty where it does. A command that changes
// nothing (resume of what runs, cancel of what is cancelled) is obeyed.
std::string WhyNot(const Job& job, JobCommand command);

}  // namespace cairn::coordinator
