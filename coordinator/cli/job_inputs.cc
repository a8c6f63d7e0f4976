#include "coordinator/cli/job_inputs.h"

#include <memory>

#include "coordinator/cli/failure.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {

std::map<std::string, BlobPtr> ReadJobInputs(ParsedJob& parsed) {
  std::map<std::string, BlobPtr> blobs;
  for (const auto& [name, input] : parsed.inputs) {
    Result<BlobFile> file = ReadBlobFileWithoutTruth(input.path);
    if (!file.ok()) Throw(Status(file.status().code(), input.where + ": " + file.status().message()));
    auto blob = std::make_shared<const Blob>(std::move(file).value().blob);
    (*parsed.job.mutable_input_blobs())[name] = blob->ContentHash().Binary();
    blobs[name] = std::move(blob);
  }
  return blobs;
}

}  // namespace cairn::cli
