#include "schema/service_manager.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace cairn {
namespace {

std::string_view Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::int64_t Number(std::string_view text) {
  std::int64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

}  // namespace

ServiceManager::ServiceManager() : path_(Environment("NOTIFY_SOCKET")) {
  const std::string_view watched = Environment("WATCHDOG_PID");
  if (watched.empty() || Number(watched) == ::getpid())
    every_ = std::chrono::microseconds(Number(Environment("WATCHDOG_USEC")) / 3);
}

void ServiceManager::Alive() {
  if (every_.count() <= 0 || (told_ && Clock::now() - *told_ < every_)) return;
  told_ = Clock::now();
  Tell("WATCHDOG=1");
}

// Of a file, or, behind an '@', of Linux's abstract names. It may be another's since the last time: whoever
// manages services may have been started again.
void ServiceManager::Tell(const char* what) const {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path_.empty() || path_.size() >= sizeof address.sun_path || (path_[0] != '/' && path_[0] != '@'))
    return;
  std::memcpy(address.sun_path, path_.data(), path_.size());
  if (path_[0] == '@') address.sun_path[0] = '\0';
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket < 0) return;
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path_.size());
  (void)::sendto(socket, what, std::strlen(what), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&address),
                 size);
  ::close(socket);
}

}  // namespace cairn
