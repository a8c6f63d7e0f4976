#include "coordinator/server/address_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "schema/store/atomic_file.h"
#include "schema/wire/endpoint.h"

namespace cairn::coordinator {
namespace {

// Whether somebody listens at that socket, who may know of no locks.
bool IsServed(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) return false;
  std::ranges::copy(path, address.sun_path);
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return false;
  const bool connected =
      ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 || errno == EAGAIN;
  ::close(probe);
  return connected;
}

std::string ReadLine(int file) {
  std::array<char, 4096> text;
  const ssize_t count = ::pread(file, text.data(), text.size(), 0);
  std::string line(text.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
  return line.substr(0, line.find('\n'));
}

void WriteLine(int file, const std::string& line) {
  // For people only: that it is locked says all.
  if (::ftruncate(file, 0) == 0) static_cast<void>(!::pwrite(file, line.data(), line.size(), 0));
}

}  // namespace

Result<AddressLock> AddressLock::Take(const std::string& endpoint, const std::string& what) {
  const std::string scheme = "ipc://";
  if (!endpoint.starts_with(scheme)) return AddressLock(-1);
  if (Status status = wire::CheckEndpoint(endpoint, false); !status.ok()) return status;
  const std::string path = endpoint.substr(scheme.size()), lock_path = path + ".lock";
  const int file = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file < 0) return SystemFailure(lock_path, "open", errno);
  AddressLock lock(file);
  const std::string advice = "; stop it first, or serve at another address (--listen)";
  if (::flock(file, LOCK_EX | LOCK_NB) != 0)
    return Status(Code::kBusy, endpoint + " is served by another coordinator: " + ReadLine(file) + advice);
  if (IsServed(path)) return Status(Code::kBusy, endpoint + " is served by another process" + advice);
  WriteLine(file, "process " + std::to_string(::getpid()) + ", " + what + "\n");
  return lock;
}

AddressLock::AddressLock(AddressLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

AddressLock::~AddressLock() {
  if (file_ >= 0) ::close(file_);  // and with it the lock
}

}  // namespace cairn::coordinator
