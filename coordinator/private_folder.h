// A folder that only this user may enter, for the socket of one run; short enough for a socket's name.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "schema/error.h"

namespace cairn::coordinator {

class PrivateFolder {
 public:
  // Also removes those that killed processes of this user have left.
  static Result<PrivateFolder> Make();
  PrivateFolder(PrivateFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  PrivateFolder& operator=(PrivateFolder&&) = delete;
  ~PrivateFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  explicit PrivateFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

}  // namespace cairn::coordinator
