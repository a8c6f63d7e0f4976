#include "coordinator/cli/commands/simulate/simulated.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/output/path.h"
#include "coordinator/cli/output/plan_text.h"

namespace cairn::cli {

void AddOutput(Command command, SimulateOutput& output, const std::string& what) {
  command.AddFlag("--force", output.force, "Replace files that are there already");
  command.AddFlag("--json", output.json, "What was written, as JSON");
  command.Add("OUT.h5", output.out, "The " + what + " to write").Required();
}

int StoreSimulated(const SimulateOutput& output, const std::string& kind, const Blob& blob,
                   const std::string& sentence, const std::vector<std::string>& pictures) {
  WriteOutput(output.out, kind, blob, output.force);
  if (!output.json) {
    std::printf("%s: %s\n", output.out.c_str(), sentence.c_str());
    return kExitDone;
  }
  const nlohmann::ordered_json json = {
      {"file", output.out}, {"kind", kind}, {"content", ContentText(blob)}, {"pictures", pictures}};
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  return kExitDone;
}

}  // namespace cairn::cli
