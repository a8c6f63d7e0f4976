// A whole service, for people and for programs: its workers, its jobs by state, what it has refused.
#pragma once

#include <string>
#include <vector>

#include "coordinator/client.h"

namespace cairn::cli {

// "jobs     2 running, 1 paused\nworkers  2 busy, 1 idle\n…", then a line a worker.
std::string ServiceText(const coordinator::JobList& list, const std::vector<wire::WorkerInfo>& workers);

std::string ServiceJson(const coordinator::JobList& list, const std::vector<wire::WorkerInfo>& workers);

std::string WorkersJson(const std::vector<wire::WorkerInfo>& workers);

}  // namespace cairn::cli
