#include "schema/wire/accept.h"

#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>

namespace cairn::wire {
namespace {

std::atomic<std::size_t> g_spare{0};
constexpr unsigned kPause_us = 10'000;

// The system gives the lowest number that is free: one this high says that the others are taken.
bool IsSpare(int fd) {
  rlimit files{};
  if (g_spare == 0 || ::getrlimit(RLIMIT_NOFILE, &files) != 0) return false;
  const rlim_t spare = std::min<rlim_t>(g_spare, files.rlim_cur / 4);
  return static_cast<rlim_t>(fd) >= files.rlim_cur - spare;
}

}  // namespace

void SpareDescriptors(std::size_t spare) { g_spare = spare; }

}  // namespace cairn::wire

// In the place of the C library's, for ZeroMQ calls it by this name. It reports ENFILE as a connection that
// could not be accepted, and goes on, whatever the transport.
extern "C" int accept4(int listener, sockaddr* address, socklen_t* length, int flags) {
  const int fd = static_cast<int>(::syscall(SYS_accept4, listener, address, length, flags));
  if (fd >= 0 && !cairn::wire::IsSpare(fd)) return fd;
  if (fd >= 0) {
    ::close(fd);
    errno = ENFILE;
  } else if (errno == EMFILE) {
    ::usleep(cairn::wire::kPause_us);  // it knocks on
    errno = ENFILE;
  }
  return -1;
}
