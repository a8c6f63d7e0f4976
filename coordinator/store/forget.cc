#include "coordinator/store/forget.h"

#include <set>
#include <vector>

#include "coordinator/core/job.h"
#include "coordinator/store/checkpoint_file.h"
#include "coordinator/store/folder.h"
#include "coordinator/store/result_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

// Its regular files that are Cairn's.
std::vector<fs::path> FilesOf(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::path& path : EntriesOf(folder)) {
    std::error_code gone;
    if (path.extension() == ".h5" && fs::is_regular_file(fs::symlink_status(path, gone)))
      files.push_back(path);
  }
  return files;
}

}  // namespace

void RemovePublished(const fs::path& results, const std::string& job, const fs::path& checkpoints) {
  if (!IsPlainName(job)) return;
  std::set<Hash> specs;
  for (const fs::path& file : FilesOf(checkpoints))
    if (const auto checkpoint = ReadCheckpoint(file); checkpoint.ok() && checkpoint.value().job_id() == job)
      specs.insert(HashOfJob(checkpoint.value().job()));
  std::error_code ignored;
  for (const fs::path& file : FilesOf(results))
    if (const Result<PublishedResult> result = ReadPublished(file);
        result.ok() && file.stem() == result.value().stage && specs.contains(HashOfJob(result.value().job)))
      fs::remove(file, ignored);
  fs::remove(results, ignored);
}

}  // namespace cairn::coordinator
