// cairn run --on slurm: for those who may only submit jobs. The coordinator is a batch job, too; it has its
// store in the folder of the results, starts workers as `cairn scale slurm` does, and is queued anew where
// its node is lost or its time is over.
#pragma once

#include <string>
#include <vector>

#include "coordinator/cli/job_file/arguments.h"

namespace cairn::cli {

struct OnSlurmArguments {
  JobArguments job;
  std::string out;                  // folder of the results, which all nodes see
  int workers = 1;                  // most at a time
  std::vector<std::string> sbatch;  // options of sbatch's, for the coordinator's job and for workers
  bool force = false;               // results that are there and are others are replaced
};

// The script of the coordinator's job. `program`: this one, by its path; `own`: what lies beside the results.
std::string OnSlurmScript(const OnSlurmArguments& arguments, const std::string& program,
                          const std::string& own);

// Hands it to sbatch, and says under which number. The exit code: with --sbatch=--wait that of the job.
// Throws InputError and WorldError.
int RunOnSlurm(const OnSlurmArguments& arguments);

}  // namespace cairn::cli
