// For tests of whatever uses the transport: a folder of mode 0700 that is gone afterwards.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "schema/error.h"

namespace cairn::wire {

class PrivateFolder {
 public:
  PrivateFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "cairn-XXXXXX").string();
    CAIRN_DEMAND(::mkdtemp(name.data()) != nullptr, name);
    path_ = name;
  }
  ~PrivateFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::string Ipc(const std::string& name) const { return "ipc://" + (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace cairn::wire
