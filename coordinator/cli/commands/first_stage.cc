#include "coordinator/cli/commands/first_stage.h"

#include <cstdint>
#include <filesystem>

#include "coordinator/cli/commands/run.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/programs.h"
#include "coordinator/cli/job_file/inputs.h"
#include "coordinator/local/private_folder.h"

namespace cairn::cli {
namespace {

constexpr std::uint64_t kMostPlanned_bytes = 256 << 20;

std::uint64_t SizeOf(const ParsedJob& parsed) {
  std::uint64_t bytes = 0;
  for (const auto& [name, input] : parsed.inputs) {
    std::error_code error;  // which reading it says
    const std::uint64_t size = std::filesystem::file_size(input.path, error);
    if (!error) bytes += size;
  }
  return bytes;
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
  if (SizeOf(parsed) > kMostPlanned_bytes) return;
  PrepareToRun(1);
  const std::map<std::string, BlobPtr> inputs = ReadJobInputs(parsed, units_are_right);
  const std::atomic<bool> never = false;  // a signal ends the command
  const coordinator::EmbeddedResult planned = PlanFirstStage(parsed.job, inputs, never);
  // Whatever else went wrong here may go well there.
  if (planned.end == coordinator::EmbeddedEnd::kInputError) throw InputError(planned.reason);
}

}  // namespace cairn::cli
