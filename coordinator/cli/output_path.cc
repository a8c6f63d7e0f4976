#include "coordinator/cli/output_path.h"

#include <filesystem>

#include "schema/error.h"

namespace cairn::cli {

void RefuseToOverwrite(const std::string& path, bool force) {
  namespace fs = std::filesystem;
  if (path.empty()) throw InputError("the name of the file to write is empty");
  if (fs::is_directory(path)) throw InputError("'" + path + "' is a folder; a file is needed");
  if (fs::exists(path) && !force) throw InputError("'" + path + "' is there already (--force replaces it)");
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder)) throw InputError("there is no folder '" + folder.string() + "' to write to");
}

}  // namespace cairn::cli
