#include "coordinator/cli/commands/first_stage.h"

#include <cstdint>

#include "coordinator/cli/commands/run.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/programs.h"
#include "coordinator/cli/job_file/inputs.h"
#include "coordinator/local/private_folder.h"
#include "schema/flat_blob.h"

namespace cairn::cli {
namespace {

// What a submission has in memory does not grow with its inputs; these are there as a whole.
constexpr std::uint64_t kMostPlanned_bytes = 16 << 20;

// Of their arrays, as they are in memory.
std::uint64_t SizeOf(const std::map<std::string, coordinator::Input>& inputs) {
  std::uint64_t all = 0;
  for (const auto& [name, input] : inputs) {
    const Result<std::uint64_t> bytes = FlatBytes(input.meta);
    if (bytes.ok()) all += bytes.value();
  }
  return all;
}

}  // namespace

coordinator::EmbeddedResult PlanFirstStage(const proto::Job& job,
                                           const std::map<std::string, BlobPtr>& inputs,
                                           const std::atomic<bool>& stop) {
  Result<coordinator::PrivateFolder> folder = coordinator::PrivateFolder::Make();
  if (!folder.ok()) Throw(folder.status());
  coordinator::EmbeddedOptions embedded;
  embedded.dir = (folder.value().path() / "plan").string();
  embedded.worker_program = WorkerProgram();
  embedded.plan_only = true;
  embedded.log = [](coordinator::Severity, const std::string&) {};
  return coordinator::RunEmbedded(embedded, job, inputs, {}, stop);
}

void CheckFirstStage(ParsedJob parsed, bool units_are_right) {
  if (SizeOf(LookAtJobInputs(parsed, units_are_right)) > kMostPlanned_bytes) return;
  PrepareToRun(1);
  const std::map<std::string, BlobPtr> inputs = ReadJobInputs(parsed, units_are_right);
  const std::atomic<bool> never = false;  // a signal ends the command
  const coordinator::EmbeddedResult planned = PlanFirstStage(parsed.job, inputs, never);
  // Whatever else went wrong here may go well there.
  if (planned.end == coordinator::EmbeddedEnd::kInputError) throw InputError(planned.reason);
}

}  // namespace cairn::cli
