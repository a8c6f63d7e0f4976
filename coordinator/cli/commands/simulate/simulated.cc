#include "coordinator/cli/commands/simulate/simulated.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/output/path.h"
#include "coordinator/cli/output/plan_text.h"
#include "datasets/bag/write_bag.h"

namespace cairn::cli {

void AddOutput(Command command, SimulateOutput& output, const std::string& what) {
  command.AddFlag("--force", output.force, "Replace files that are there already");
  command.AddFlag("--json", output.json, "What was written, as JSON");
  command.Add("OUT.h5", output.out, "The " + what + " to write").Required();
}

void AddBagOutput(Command command, SimulateOutput& output) {
  command
      .Add("--bag", output.bag,
           "Writes a bag of ROS 1 too, as the robot would have recorded it (docs/bags.md): FILE.bag")
      .Check(
          [](const std::string& name) { return name.ends_with(".bag") ? "" : "a bag's name ends in .bag"; });
}

void CheckOutputs(const SimulateOutput& output) {
  CheckOverwrite(output.out, output.force);
  if (!output.bag.empty()) CheckOverwrite(output.bag, output.force);
}

int StoreSimulated(const SimulateOutput& output, const std::string& kind, const Blob& blob,
                   const std::string& sentence, const std::vector<std::string>& pictures) {
  if (!output.bag.empty()) WriteOutput(output.bag, datasets::BagOfLog(blob), output.force);
  WriteOutput(output.out, kind, blob, output.force);
  if (!output.json) {
    std::printf("%s: %s\n", output.out.c_str(), sentence.c_str());
    if (!output.bag.empty()) std::printf("%s: the same as a bag of ROS 1\n", output.bag.c_str());
    return kExitDone;
  }
  nlohmann::ordered_json json = {
      {"file", output.out}, {"kind", kind}, {"content", ContentText(blob)}, {"pictures", pictures}};
  if (!output.bag.empty()) json["bag"] = output.bag;
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  return kExitDone;
}

}  // namespace cairn::cli
