#include "coordinator/cli/job_inputs.h"

#include <memory>

#include "coordinator/cli/failure.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {

namespace {

bool IsNeededAsLog(const proto::Job& job, const std::string& input) {
  for (const proto::Stage& stage : job.stages()) {
    const auto source = stage.inputs().find("log");
    if (source != stage.inputs().end() && source->second == input) return true;
  }
  return false;
}

}  // namespace

std::map<std::string, BlobPtr> ReadJobInputs(ParsedJob& parsed) {
  std::map<std::string, BlobPtr> blobs;
  for (const auto& [name, input] : parsed.inputs) {
    Result<BlobFile> file = ReadBlobFileWithoutTruth(input.path);
    if (!file.ok()) Throw(Status(file.status().code(), input.where + ": " + file.status().message()));
    const std::string& kind = file.value().kind;
    if (kind != "log" && IsNeededAsLog(parsed.job, name))
      throw InputError(input.where + ": " + input.path + ": a " + kind + ", where a log is needed");
    auto blob = std::make_shared<const Blob>(std::move(file).value().blob);
    (*parsed.job.mutable_input_blobs())[name] = blob->ContentHash().Binary();
    blobs[name] = std::move(blob);
  }
  return blobs;
}

}  // namespace cairn::cli
