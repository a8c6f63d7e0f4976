#include "coordinator/cli/commands/job_choice.h"

#include <fnmatch.h>

namespace cairn::cli {

std::vector<wire::JobInfo> Chosen(const JobChoice& choice, const std::vector<wire::JobInfo>& jobs) {
  std::vector<wire::JobInfo> chosen;
  for (const wire::JobInfo& job : jobs)
    if ((choice.state.empty() || job.state() == choice.state) &&
        (choice.name.empty() || fnmatch(choice.name.c_str(), job.name().c_str(), 0) == 0))
      chosen.push_back(job);
  return chosen;
}

}  // namespace cairn::cli
