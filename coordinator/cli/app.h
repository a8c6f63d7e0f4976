// The command line of `cairn`: parses it, runs the command, turns errors into one line and an exit code.
#pragma once

namespace cairn::cli {

int Main(int argc, char** argv);

}  // namespace cairn::cli
