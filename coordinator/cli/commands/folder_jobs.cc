#include "coordinator/cli/commands/folder_jobs.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "coordinator/cli/common/result_file.h"
#include "coordinator/core/job.h"
#include "schema/job.pb.h"
#include "schema/kinds/provenance.h"
#include "schema/store/blob_file.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

std::optional<proto::Job> SpecOf(const Blob& result) {
  const auto bytes = kinds::Provenance::In(result).job.OrNone();
  proto::Job job;
  if (bytes.empty() || !job.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return std::nullopt;
  return job;
}

std::optional<proto::Job> SpecInFile(const std::string& file) {
  const Result<BlobFile> read =
      ReadBlobFile(file, {.only = {"provenance/"}, .without = {}, .changed_too = true});
  if (!read.ok()) return std::nullopt;
  try {
    return SpecOf(read.value().blob);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// What went into it, whatever it was called.
std::set<std::string> InputsOf(const proto::Job& job) {
  std::set<std::string> inputs;
  for (const auto& [name, hash] : job.input_blobs()) inputs.insert(hash);
  return inputs;
}

// "(a.h5; b.h5, c.h5)": the files of each job, of the first few jobs.
std::string FilesOfEach(const std::vector<std::vector<std::string>>& jobs) {
  constexpr std::size_t kMostJobs = 4;
  std::string text;
  for (std::size_t i = 0; i < std::min(jobs.size(), kMostJobs); ++i)
    text += (i == 0 ? "" : "; ") + NameList(jobs[i]);
  return " (" + text + (jobs.size() > kMostJobs ? "; and so on)" : ")");
}

}  // namespace

std::string JobOf(const Blob& result) {
  if (result.Has("so_far/job")) return result.Text("so_far/job");
  const std::optional<proto::Job> job = SpecOf(result);
  return job ? coordinator::HashOfJob(*job).Hex() : "";
}

std::string SeveralJobs(const std::string& path) {
  if (!fs::is_directory(path)) return "";
  std::map<Hash, std::size_t> known;
  std::vector<std::vector<std::string>> jobs;  // the files of each, in the order of the first of them
  std::set<std::set<std::string>> inputs;
  for (const std::string& file : FilesOf(path)) {
    const std::optional<proto::Job> job = SpecInFile(file);
    if (!job) continue;
    const auto [at, fresh] = known.emplace(coordinator::HashOfJob(*job), jobs.size());
    if (fresh) jobs.emplace_back();
    jobs[at->second].push_back(fs::path(file).filename().string());
    inputs.insert(InputsOf(*job));
  }
  if (jobs.size() < 2) return "";
  return "the results in '" + path + "' belong to " + std::to_string(jobs.size()) + " different jobs" +
         (inputs.size() > 1 ? ", made from different inputs" : " of the same inputs") + FilesOfEach(jobs);
}

void WarnOfSeveralJobs(const std::string& path, const std::string& what) {
  if (const std::string several = SeveralJobs(path); !several.empty())
    std::fprintf(stderr, "cairn: warning: %s: %s\n", Escaped(several).c_str(), what.c_str());
}

}  // namespace cairn::cli
