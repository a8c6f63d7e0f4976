// A worker: one thread computes, the calling one talks to the coordinator and keeps up the heartbeat.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>

#include "schema/service_manager.h"
#include "worker/executor.h"
#include "worker/session.h"
#include "worker/transport.h"

namespace cairn::worker {

struct WorkerOptions {
  SessionOptions session;
  std::function<double()> now_s;  // monotonic; empty: the system's clock
  // How long a task may take to notice that the worker ends. Then the process ends under it, with the exit
  // code.
  double patience_s = 2;
  std::uint64_t task_memory_mb = 0;  // that a task may take, whatever its job says; 0: the job's limit alone
  // Where `drain` comes true it finishes what it runs, for at most drain_s, and then ends.
  const std::atomic<bool>* drain = nullptr;
  double drain_s = 0;
  std::filesystem::path shared_path;  // a folder of blobs (shared_path.h); empty: there is none
  ServiceManager* manager = nullptr;  // is told that it is alive; none: nobody is
};

// Works until `stop` (call transport.Wake() after setting it) or until the coordinator ends it; returns the
// process's exit code.
int RunWorker(Transport& transport, const PipelineFactory& factory, const WorkerOptions& options,
              const std::atomic<bool>& stop);

}  // namespace cairn::worker
