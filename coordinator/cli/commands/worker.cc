#include "coordinator/cli/common/invocation.h"

namespace cairn::cli {

// For `cairn --help` alone: `cairn worker …` becomes cairn-worker before the command line is parsed, and
// `cairn page …` cairn-page.
void AddWorker(Command app, Invocation&) {
  Command command = app.AddCommand("worker", "Computes tasks for a coordinator, here or on another machine");
  command.Footer("Example:\n  cairn worker --connect tcp://hub:7000 --key desk.key --server-key hub.pub");
}

void AddPage(Command app, Invocation&) {
  Command command = app.AddCommand("page", "Shows a coordinator's jobs in a browser, and commands them");
  command.Footer("Example:\n  cairn page");
}

}  // namespace cairn::cli
