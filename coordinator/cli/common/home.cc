#include "coordinator/cli/common/home.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include "coordinator/cli/common/failure.h"
#include "schema/store/atomic_file.h"

namespace cairn::cli {
namespace {

std::string Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

std::string HomeFolder() {
  std::string folder = Environment("CAIRN_HOME");
  if (folder.empty()) {
    const std::string home = Environment("HOME");
    if (home.empty())
      throw InputError("neither CAIRN_HOME nor HOME is set: say --listen, --connect or --store");
    folder = home + "/.cairn";
  }
  folder = std::filesystem::absolute(folder).string();
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    Throw(SystemFailure(folder, "cannot make the folder", errno));
  }
  return folder;
}

std::string ConfigFolder() {
  const std::string config = Environment("XDG_CONFIG_HOME");
  if (config.starts_with('/'))
    return config + "/cairn";  // a relative one counts as unset: XDG base directories
  const std::string home = Environment("HOME");
  if (home.empty()) throw InputError("neither XDG_CONFIG_HOME nor HOME is set: say where the keys are");
  return home + "/.config/cairn";
}

std::string DefaultKey(const std::string& file) {
  std::string path = ConfigFolder() + "/" + file;
  if (std::filesystem::exists(path)) return path;
  throw InputError("TCP needs keys, and there is no " + path + " (see `cairn keys --help`)");
}

std::string DefaultEndpoint() {
  const std::string endpoint = Environment("CAIRN_COORDINATOR");
  return endpoint.empty() ? "ipc://" + HomeFolder() + "/coordinator.ipc" : endpoint;
}

}  // namespace cairn::cli
