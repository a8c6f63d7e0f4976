#include "coordinator/cli/common/invocation.h"

namespace cairn::cli {

// For `cairn --help` alone: `cairn worker …` becomes cairn-worker before the command line is parsed.
void AddWorker(Command app, Invocation&) {
  Command command = app.AddCommand("worker", "Computes tasks for a coordinator, here or on another machine");
  command.Footer("Example:\n  cairn worker --connect tcp://hub:7000 --key desk.key --server-key hub.pub");
}

}  // namespace cairn::cli
