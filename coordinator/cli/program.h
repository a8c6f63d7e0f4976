// A program of commands: parses its command line, runs the command, turns errors into one line and an exit
// code.
#pragma once

#include <functional>

#include "coordinator/cli/common/invocation.h"

namespace cairn::cli {

struct Program {
  const char* name;
  const char* purpose;  // a sentence
  const char* example;
  void (*add_commands)(Command app, Invocation& call);
  // What runs in place of a command, seen before the command line is parsed; empty: nothing.
  std::function<int()> (*instead)(int argc, char** argv) = nullptr;
};

int RunProgram(const Program& program, int argc, char** argv);

}  // namespace cairn::cli
