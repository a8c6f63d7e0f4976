// A folder that only this user may enter, for the socket of one run; short enough for a socket's name.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "schema/error.h"

namespace cairn::coordinator {

class PrivateFolder {
 public:
  // Also removes those that killed processes of this user have left: each is locked while its process lives,
  // wherever that runs (a container has process ids of its own), and holds a file that says what it is. One
  // in which anybody else has put something stays.
  static Result<PrivateFolder> Make();
  PrivateFolder(PrivateFolder&& other) noexcept
      : path_(std::exchange(other.path_, {})), lock_(std::exchange(other.lock_, -1)) {}
  PrivateFolder& operator=(PrivateFolder&&) = delete;
  ~PrivateFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  PrivateFolder(std::filesystem::path path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::filesystem::path path_;
  int lock_;  // a descriptor of the folder, locked
};

}  // namespace cairn::coordinator
