#include "coordinator/cli/job_inputs.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "coordinator/cli/failure.h"
#include "coordinator/cli/result_file.h"
#include "datasets/unit_doubts.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {

namespace {

bool IsNeededAs(const std::string& role, const proto::Job& job, const std::string& input) {
  for (const proto::Stage& stage : job.stages()) {
    const auto source = stage.inputs().find(role);
    if (source != stage.inputs().end() && source->second == input) return true;
  }
  return false;
}

// Two roles have the name of the kind of file that they need; of others the pipeline knows.
void RefuseOtherKind(const proto::Job& job, const std::string& name, const JobInput& input,
                     const std::string& kind) {
  for (const auto& [role, needed] : {std::pair{"log", "a log is"}, {"samples", "samples are"}}) {
    if (kind != role && IsNeededAs(role, job, name))
      throw InputError(input.where + ": " + input.path + ": " + (kind == "samples" ? "" : "a ") + kind +
                       ", where " + needed + " needed");
  }
}

}  // namespace

void RefuseUnits(const std::string& where, const std::vector<std::string>& doubts) {
  constexpr std::size_t kMost = 4;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, doubts.size()); ++i)
    text += (i == 0 ? "" : "; and ") + where + doubts[i];
  if (doubts.size() > kMost) text += "; and " + std::to_string(doubts.size() - kMost) + " like these";
  throw InputError(text + " (--units-are-right takes it as it is)");
}

std::map<std::string, BlobPtr> ReadJobInputs(ParsedJob& parsed, bool units_are_right) {
  std::map<std::string, BlobPtr> blobs;
  for (const auto& [name, input] : parsed.inputs) {
    Result<BlobFile> file = ReadBlobFileWithoutTruth(input.path, true);
    if (!file.ok()) Throw(Status(file.status().code(), input.where + ": " + file.status().message()));
    if (file.value().changed) WarnOfChanged(input.path);  // the job knows it by its content
    RefuseOtherKind(parsed.job, name, input, file.value().kind);
    if (const std::string& kind = file.value().kind;
        !units_are_right && (kind == "log" || kind == "samples" || kind == "poses")) {
      const std::vector<std::string> doubts = datasets::UnitDoubtsOf(file.value().blob);
      if (!doubts.empty()) RefuseUnits(input.where + ": " + input.path + ": ", doubts);
    }
    auto blob = std::make_shared<const Blob>(std::move(file).value().blob);
    (*parsed.job.mutable_input_blobs())[name] = blob->ContentHash().Binary();
    blobs[name] = std::move(blob);
  }
  return blobs;
}

}  // namespace cairn::cli
