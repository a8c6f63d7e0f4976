// Workers as elements of arrays of jobs on a Slurm cluster, by sbatch, squeue, scancel and scontrol. A job is
// called PREFIX-FIRST: its element N is the worker PREFIX-(FIRST + N). Keys and logs lie in a folder that all
// nodes see.
//
// Slurm tells a worker to go some time before its limit comes or it is preempted: it drains. None is queued
// anew by Slurm: what is missing is asked for again.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "coordinator/scale/engine.h"
#include "coordinator/scale/engines/programs.h"

namespace cairn::coordinator {

struct SlurmOptions {
  std::string prefix;                // of the workers' names, with its '-'
  std::string folder;                // of logs; that of keys in it: keys
  std::string worker;                // the program, on all nodes
  std::vector<std::string> options;  // that each worker gets: --connect ENDPOINT …
  bool keyed = false;  // each has a key, folder/keys/NAME.key, and coordinator.pub lies beside it
  std::vector<std::string> sbatch;  // more of its options: --partition=long
  int drain_s = 60;                 // what a worker gets to finish its task
  double limit_s = 30;              // for a command of Slurm's
};

// Why one of Slurm's commands failed, and where it is missing what to do, for people.
std::string SlurmFailure(const ProgramOutput& output);
// Of what `sbatch --parsable` printed: NUMBER or NUMBER;CLUSTER. Empty where it is neither.
std::string SlurmJobNumber(const std::string& printed);
// The same file for sbatch, to which %j and the like in its name are the job's number and the like.
std::string SlurmFileName(const std::string& path);
// The script of an array whose first worker has that number.
std::string ArrayScript(const SlurmOptions& options, std::uint64_t first);
// Of `squeue -h -r -o '%j|%K|%t|%N|%r|%i'`; jobs of others are left out. `ids`: by name, what Slurm calls it.
std::vector<EngineWorker> ReadQueue(const std::string& prefix, const std::string& printed,
                                    std::map<std::string, std::string>* ids);
// Of `scontrol -o show job`: how one that is over ended.
std::string WhyEnded(const std::string& shown);

class SlurmEngine : public Engine {
 public:
  // The tests' own Slurm stands in for the real one.
  using Runner = std::function<ProgramOutput(const Program&)>;
  explicit SlurmEngine(SlurmOptions options, Runner run = {});
  Result<std::vector<EngineWorker>> List() override;
  Started Start(const std::vector<std::string>& names) override;
  Status Stop(const std::vector<std::string>& names) override;
  void Forget(const std::vector<std::string>& names) override;

 private:
  const SlurmOptions options_;
  const Runner run_;
  std::map<std::string, std::string> ids_;     // of those that wait or run, by name
  std::map<std::string, EngineWorker> ended_;  // and are not forgotten yet
};

}  // namespace cairn::coordinator
