// What every `cairn simulate …` does with what it has made.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/command_line/command.h"

namespace cairn::cli {

struct SimulateOutput {
  std::string out;
  bool force = false, json = false;
};

// --force, --json and OUT.h5, which holds `what` ("log").
void AddOutput(Command command, SimulateOutput& output, const std::string& what);

// Writes OUT.h5, a file of `kind`, and says so in a sentence, or, with --json, what was written and what it
// holds: {"file", "kind", "content", "pictures"}. Returns the exit code.
int StoreSimulated(const SimulateOutput& output, const std::string& kind, const Blob& blob,
                   const std::string& sentence, const std::vector<std::string>& pictures = {});

}  // namespace cairn::cli
