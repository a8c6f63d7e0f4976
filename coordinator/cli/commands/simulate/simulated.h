// What every `cairn simulate …` does with what it has made.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/command_line/command.h"

namespace cairn::cli {

struct SimulateOutput {
  std::string out;
  std::string bag;  // the same log as a bag; empty: none
  bool force = false, json = false;
};

// --force, --json and OUT.h5, which holds `what` ("log").
void AddOutput(Command command, SimulateOutput& output, const std::string& what);

// --bag FILE.
void AddBagOutput(Command command, SimulateOutput& output);
// Throws InputError where a file is there already, before the work is done.
void CheckOutputs(const SimulateOutput& output);

// Writes OUT.h5, and the bag where one is asked for, a file of `kind`, and says so in a sentence, or, with
// --json, what was written and what it holds: {"file", "kind", "content", "pictures", "bag"}. Returns the
// exit code.
int StoreSimulated(const SimulateOutput& output, const std::string& kind, const Blob& blob,
                   const std::string& sentence, const std::vector<std::string>& pictures = {});

}  // namespace cairn::cli
