// Runs a job on workers of its own: what `cairn run` and `cairn map` share.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/job_file/job_file.h"
#include "coordinator/local/embedded.h"
#include "schema/command_line/command.h"

namespace cairn::cli {

struct RunArguments {
  std::string out;  // empty: the job's name
  int workers = MostWorkers();
  std::uint64_t task_memory_mb = 0;
  double checkpoint_interval_s = coordinator::EmbeddedOptions().checkpoint_interval_s;
  std::uint64_t checkpoint_rounds = 0;
  bool force = false, units_are_right = false, json = false;
  bool page = false;

  static int MostWorkers();  // as many as there are cores
};

// --out is the caller's, and --units-are-right.
void AddRunArguments(Command command, RunArguments& arguments);

// What a process that runs a job with so many workers needs of the system.
// Throws InputError where it is not there.
void PrepareToRun(int workers);

// Shows its progress, leaves the results with their pages in arguments.out and prints a summary of them; goes
// on with an earlier run of the same job there. `beside_results`: done while the folder is still this run's,
// before the pages are written. The exit code.
// Throws InputError of inputs that cannot be read or are in doubt, and of files in the folder that are not
// Cairn's.
int RunJob(const RunArguments& arguments, ParsedJob parsed, const Invocation& call,
           const std::function<void()>& beside_results = {});

}  // namespace cairn::cli
