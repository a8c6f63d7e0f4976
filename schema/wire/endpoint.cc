#include "schema/wire/endpoint.h"

#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace cairn::wire {
namespace {

Status CheckIpc(const std::string& path) {
  if (!path.starts_with('/')) return {Code::kRefused, "ipc needs an absolute path, not '" + path + "'"};
  // One byte is the terminating zero's.
  if (path.size() >= sizeof(sockaddr_un::sun_path)) {
    return {Code::kRefused, "the path of this socket is longer than the system's 107 bytes: " + path};
  }
  const std::string folder = std::filesystem::path(path).parent_path();
  struct stat info;
  if (::stat(folder.c_str(), &info) != 0) return {Code::kNotFound, folder + ": " + std::strerror(errno)};
  if (!S_ISDIR(info.st_mode) || info.st_uid != ::geteuid() || (info.st_mode & 0777) != 0700) {
    return {Code::kRefused, folder + ": an ipc socket must lie in a folder of your own with mode 0700"};
  }
  return Status::Ok();
}

}  // namespace

Status CheckEndpoint(const std::string& endpoint, bool has_keys) {
  if (endpoint.starts_with("ipc://")) return CheckIpc(endpoint.substr(6));
  if (!endpoint.starts_with("tcp://")) {
    return {Code::kRefused, "an endpoint is ipc:///FOLDER/NAME or tcp://HOST:PORT, not '" + endpoint + "'"};
  }
  if (!has_keys) return {Code::kRefused, endpoint + ": TCP needs keys (make them with `cairn keys`)"};
  return Status::Ok();
}

}  // namespace cairn::wire
