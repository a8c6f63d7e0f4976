#include "coordinator/cli/output/path.h"

#include <filesystem>
#include <span>
#include <system_error>

#include "coordinator/cli/common/failure.h"
#include "schema/error.h"
#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {

void CheckOutputIsNoInput(const std::string& path, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    std::error_code ignored;  // of files that are not there: not the same
    if (!input.empty() && std::filesystem::equivalent(path, input, ignored))
      throw InputError("'" + path + "' is an input; it would be overwritten");
  }
}

void CheckOutputIsNotInDataset(const std::string& path, const std::string& folder) {
  namespace fs = std::filesystem;
  if (!fs::is_directory(folder)) return;  // which the import says
  std::vector<std::string> inputs;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    for (const char* ending : {".dat", ".dat.gz", ".txt", ".txt.gz"}) {
      if (name.ends_with(ending)) inputs.push_back(entry.path().string());
    }
  }
  CheckOutputIsNoInput(path, inputs);
}

void CheckOverwrite(const std::string& path, bool force) {
  namespace fs = std::filesystem;
  if (path.empty()) throw InputError("the name of the file to write is empty");
  if (fs::is_directory(path)) throw InputError("'" + path + "' is a folder; a file is needed");
  if (IsNoFile(path)) throw InputError("'" + path + "' is a device, a pipe or a socket; a file is needed");
  if (fs::exists(fs::symlink_status(path)) && !force)
    throw InputError("'" + path + "' is there already (--force replaces it)");
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder)) throw InputError("there is no folder '" + folder.string() + "' to write to");
}

void WriteOutput(const std::string& path, const std::string& kind, const Blob& blob, bool force) {
  const Status written = force ? WriteBlobFile(path, kind, blob) : WriteNewBlobFile(path, kind, blob);
  if (!written.ok()) CheckOverwrite(path, force);
  Check(written);
  RemoveLeftoversOf(path);  // of the same command, killed
}

void WriteOutput(const std::string& path, std::string_view bytes, bool force) {
  const auto span = std::as_bytes(std::span(bytes));
  const Status written = force ? WriteFileAtomically(path, span) : WriteNewFileAtomically(path, span);
  if (!written.ok()) CheckOverwrite(path, force);
  Check(written);
  RemoveLeftoversOf(path);  // of the same command, killed
}

}  // namespace cairn::cli
