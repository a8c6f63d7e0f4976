#include "coordinator/cli/common/stop_signal.h"

#include <csignal>
#include <initializer_list>

namespace cairn::cli {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch nothing else");

void OnSignal(int number) {
  if (stop.exchange(true)) {
    // Ends with the signal's own status, as if it had never been caught.
    std::signal(number, SIG_DFL);
    std::raise(number);
  }
}

}  // namespace

const std::atomic<bool>& StopOnSignals() {
  for (const int number : {SIGINT, SIGTERM}) {
    struct sigaction action = {};
    action.sa_handler = OnSignal;
    sigaction(number, &action, nullptr);
  }
  return stop;
}

}  // namespace cairn::cli
