#include "schema/wire/endpoint.h"

#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace cairn::wire {
namespace {

namespace fs = std::filesystem;

// Whoever can write to a folder can put another in the place of what lies in it, unless it is sticky.
bool OthersCanSwap(const struct stat& info) {
  if (info.st_uid != 0 && info.st_uid != ::geteuid()) return true;
  if ((info.st_mode & S_ISVTX) != 0) return false;
  const bool group = (info.st_mode & S_IWGRP) != 0 && info.st_gid != ::getegid();
  return group || (info.st_mode & S_IWOTH) != 0;
}

// Of all folders above `folder`.
Status CheckAbove(const fs::path& folder) {
  for (fs::path above = folder.parent_path();; above = above.parent_path()) {
    struct stat info;
    if (::stat(above.c_str(), &info) != 0)
      return {Code::kNotFound, above.string() + ": " + std::strerror(errno)};
    if (OthersCanSwap(info))
      return {Code::kRefused,
              above.string() + ": others can write here, so " + folder.string() + " is not safe"};
    if (above == above.parent_path()) return Status::Ok();
  }
}

Status CheckFolder(const fs::path& folder) {
  struct stat info;
  if (::lstat(folder.c_str(), &info) != 0)
    return {Code::kNotFound, folder.string() + ": " + std::strerror(errno)};
  if (S_ISLNK(info.st_mode))
    return {Code::kRefused, folder.string() + ": a link; an ipc socket needs the folder itself"};
  if (!S_ISDIR(info.st_mode) || info.st_uid != ::geteuid() || (info.st_mode & 07777) != 0700) {
    return {Code::kRefused,
            folder.string() + ": an ipc socket must lie in a folder of your own with mode 0700"};
  }
  std::error_code error;
  const fs::path real = fs::canonical(folder, error);
  if (error) return {Code::kNotFound, folder.string() + ": " + error.message()};
  if (Status above = CheckAbove(folder.lexically_normal()); !above.ok()) return above;
  return CheckAbove(real);
}

Status CheckIpc(const std::string& path) {
  if (!path.starts_with('/')) return {Code::kRefused, "ipc needs an absolute path, not '" + path + "'"};
  // One byte is the terminating zero's.
  if (path.size() >= sizeof(sockaddr_un::sun_path)) {
    return {Code::kRefused, "the path of this socket is longer than the system's 107 bytes: " + path};
  }
  if (Status folder = CheckFolder(fs::path(path).parent_path()); !folder.ok()) return folder;
  struct stat info;
  if (::lstat(path.c_str(), &info) != 0) return Status::Ok();  // not there yet
  if (S_ISSOCK(info.st_mode) && info.st_uid == ::geteuid()) return Status::Ok();
  return {Code::kRefused, path + ": is there already, and no socket of your own"};
}

}  // namespace

Status CheckEndpoint(const std::string& endpoint, bool has_keys) {
  if (endpoint.starts_with("ipc://")) return CheckIpc(endpoint.substr(6));
  if (!endpoint.starts_with("tcp://")) {
    return {Code::kRefused, "an endpoint is ipc:///FOLDER/NAME or tcp://HOST:PORT, not '" + endpoint + "'"};
  }
  if (!has_keys) return {Code::kRefused, endpoint + ": TCP needs keys (make them with `cairn keys new`)"};
  return Status::Ok();
}

}  // namespace cairn::wire
