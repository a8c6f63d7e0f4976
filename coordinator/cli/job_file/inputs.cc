#include "coordinator/cli/job_file/inputs.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/result_file.h"
#include "datasets/common/range_sensor_doubts.h"
#include "datasets/common/unit_doubts.h"
#include "schema/kinds/kind.h"
#include "schema/kinds/odometry_holes.h"
#include "schema/store/blob_file.h"
#include "schema/store/blob_stream.h"

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
void CheckInputKind(const proto::Job& job, const std::string& name, const JobInput& input,
                    const std::string& kind) {
  for (const char* role : {"log", "samples"}) {
    if (kind != role && IsNeededAs(role, job, name))
      throw InputError(input.where + ": " + input.path + ": " + WithArticle(kind) + ", where " +
                       IsNeeded(role));
  }
}

using Doubts = std::vector<std::string>;

Doubts DoubtsOf(const std::string& kind, const Blob& blob) {
  const Kind* known = FindKind(kind);
  return known != nullptr && known->has_units ? datasets::FindUnitDoubts(blob) : Doubts();
}

// Of a file of another program `inspect` says which command reads it in.
Status Named(const JobInput& input, const Status& status) {
  const bool foreign = status.code() == Code::kCorrupt && !input.path.ends_with(".h5");
  return {status.code(), input.where + ": " + status.message() +
                             (foreign ? "; `cairn inspect " + input.path + "` says how it is read in" : "")};
}

void Accept(const proto::Job& job, const std::string& name, const JobInput& input, const std::string& kind,
            bool changed, const Doubts& doubts) {
  if (changed) WarnOfChanged(input.path);  // the job knows it by its content
  CheckInputKind(job, name, input, kind);
  if (!doubts.empty()) CheckUnits(input.where + ": " + input.path + ": ", doubts);
}

// Whoever imported the log was told so, and may be another, or long ago.
void WarnOf(const std::string& path, const Blob& log) {
  for (const auto& warnings : {OdometryHolesOf(log), datasets::RangeSensorDoubtsOf(log)})
    for (const std::string& warning : warnings)
      std::fprintf(stderr, "cairn: warning: %s: %s\n", path.c_str(), warning.c_str());
}

class FileBytes : public coordinator::InputBytes {
 public:
  static Result<std::unique_ptr<coordinator::InputBytes>> Open(const std::string& path,
                                                               const wire::BlobMeta& meta) {
    Result<store::ChildStream> stream = StreamArrays(path, meta);
    if (!stream.ok()) return stream.status();
    return std::unique_ptr<coordinator::InputBytes>(new FileBytes(std::move(stream).value()));
  }
  Status Read(std::span<std::byte> bytes) override { return stream_.Read(bytes); }

 private:
  explicit FileBytes(store::ChildStream stream) : stream_(std::move(stream)) {}
  store::ChildStream stream_;
};

}  // namespace

void CheckUnits(const std::string& where, const std::vector<std::string>& doubts) {
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
    if (!file.ok()) Throw(Named(input, file.status()));
    const std::string& kind = file.value().kind;
    Accept(parsed.job, name, input, kind, file.value().changed,
           units_are_right ? Doubts() : DoubtsOf(kind, file.value().blob));
    if (kind == "log") WarnOf(input.path, file.value().blob);
    auto blob = std::make_shared<const Blob>(std::move(file).value().blob);
    (*parsed.job.mutable_input_blobs())[name] = blob->ContentHash().Binary();
    blobs[name] = std::move(blob);
  }
  return blobs;
}

std::map<std::string, coordinator::Input> LookAtJobInputs(ParsedJob& parsed, bool units_are_right) {
  std::map<std::string, coordinator::Input> inputs;
  for (const auto& [name, input] : parsed.inputs) {
    const Result<BlobFileFacts> looked =
        LookAtBlobFileWithoutTruth(input.path, [units_are_right](const std::string& kind, const Blob& blob) {
          return units_are_right ? Doubts() : DoubtsOf(kind, blob);
        });
    if (!looked.ok()) Throw(Named(input, looked.status()));
    const BlobFileFacts& facts = looked.value();
    Accept(parsed.job, name, input, facts.kind, facts.changed, facts.remarks);
    (*parsed.job.mutable_input_blobs())[name] = facts.meta.hash();
    inputs[name] = {facts.meta,
                    [path = input.path, meta = facts.meta] { return FileBytes::Open(path, meta); }};
  }
  return inputs;
}

}  // namespace cairn::cli
