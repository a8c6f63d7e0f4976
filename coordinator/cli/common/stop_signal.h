// Ctrl-C and SIGTERM as a flag. The second one ends the process at once.
#pragma once

#include <atomic>

namespace cairn::cli {

// Installs the handlers; true once one of the signals has come.
const std::atomic<bool>& StopOnSignals();

}  // namespace cairn::cli
