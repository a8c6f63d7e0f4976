#include "worker/worker.h"

#include <chrono>
#include <cstdlib>
#include <future>
#include <optional>
#include <thread>
#include <utility>

#include "schema/numerics.h"

namespace cairn::worker {
namespace {

double SteadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The computing thread. Ends with the object, or takes the process with it.
class ComputeThread {
 public:
  ComputeThread(TaskQueue& queue, const PipelineFactory& factory, std::uint64_t task_memory_mb)
      : queue_(queue), thread_([this, factory, task_memory_mb] {
          Executor(queue_, factory, task_memory_mb).Loop();
          ended_.set_value();
        }) {}
  ~ComputeThread() { thread_.join(); }
  ComputeThread(const ComputeThread&) = delete;
  ComputeThread& operator=(const ComputeThread&) = delete;

  void End(double patience_s, int exit_code) {
    queue_.Close();
    const auto patience = std::chrono::duration<double>(patience_s);
    if (ended_.get_future().wait_for(patience) != std::future_status::ready) std::_Exit(exit_code);
  }

 private:
  TaskQueue& queue_;
  std::promise<void> ended_;
  std::thread thread_;
};

}  // namespace

int RunWorker(Transport& transport, const PipelineFactory& factory, const WorkerOptions& options,
              const std::atomic<bool>& stop) {
  FixNumericsOfProcess();
  const std::function<double()> now_s = options.now_s ? options.now_s : SteadySeconds;
  TaskQueue queue([&transport] { transport.Wake(); });
  std::optional<SharedPath> shared;
  if (!options.shared_path.empty()) shared.emplace(options.shared_path, [&transport] { transport.Wake(); });
  Session session(options.session, transport, queue, now_s(), shared ? &*shared : nullptr);
  ComputeThread computing(queue, factory, options.task_memory_mb);
  bool leaving = false;
  while (!stop && !session.exit_code()) {
    if (options.drain != nullptr && *options.drain && !std::exchange(leaving, true))
      session.Leave(options.drain_s, now_s());
    for (const Event& event : transport.Poll(session.WaitSeconds(now_s()))) session.Handle(event, now_s());
    session.Work(now_s());
    if (options.manager != nullptr) options.manager->Alive();
  }
  if (!session.exit_code()) session.SendLeave();
  const int code = session.exit_code().value_or(kExitDone);
  computing.End(options.patience_s, code);
  return code;
}

}  // namespace cairn::worker
