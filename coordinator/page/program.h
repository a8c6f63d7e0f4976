// The command line of cairn-page.
#pragma once

namespace cairn::page {

// Serves the pages until a signal comes; returns the exit code.
int PageProgram(int argc, char** argv);

}  // namespace cairn::page
