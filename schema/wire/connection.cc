#include "schema/wire/connection.h"

#include <arpa/inet.h>
#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <array>

namespace cairn::wire {
namespace {

// The address that a descriptor is bound to, as endpoints write it; empty where it is no connected stream
// socket.
std::string LocalEndpoint(int fd) {
  sockaddr_storage local{};
  sockaddr_storage remote{};
  socklen_t local_size = sizeof local;
  socklen_t remote_size = sizeof remote;
  if (::getsockname(fd, reinterpret_cast<sockaddr*>(&local), &local_size) != 0 ||
      ::getpeername(fd, reinterpret_cast<sockaddr*>(&remote), &remote_size) != 0) {
    return "";
  }
  switch (local.ss_family) {
    case AF_UNIX:
      return std::string("ipc://") + reinterpret_cast<const sockaddr_un&>(local).sun_path;
    case AF_INET:
      return "tcp::" + std::to_string(ntohs(reinterpret_cast<const sockaddr_in&>(local).sin_port));
    case AF_INET6:
      return "tcp::" + std::to_string(ntohs(reinterpret_cast<const sockaddr_in6&>(local).sin6_port));
    default:
      return "";
  }
}

}  // namespace

std::string PeerAddress(int fd) {
  sockaddr_storage remote{};
  socklen_t size = sizeof remote;
  if (::getpeername(fd, reinterpret_cast<sockaddr*>(&remote), &size) != 0) return "";
  std::array<char, INET6_ADDRSTRLEN> text{};
  const void* address = nullptr;
  if (remote.ss_family == AF_INET) address = &reinterpret_cast<const sockaddr_in&>(remote).sin_addr;
  if (remote.ss_family == AF_INET6) {
    in6_addr& ipv6 = reinterpret_cast<sockaddr_in6&>(remote).sin6_addr;
    if (!IN6_IS_ADDR_V4MAPPED(&ipv6)) std::fill(ipv6.s6_addr + 8, ipv6.s6_addr + 16, std::uint8_t{0});
    address = &ipv6;
  }
  if (address == nullptr || ::inet_ntop(remote.ss_family, address, text.data(), text.size()) == nullptr)
    return "";
  return text.data();
}

bool IsConnectionOf(int fd, const std::string& ours) {
  const bool ipc = ours.starts_with("ipc://");
  return fd >= 0 && LocalEndpoint(fd) == (ipc ? ours : "tcp::" + ours.substr(ours.rfind(':') + 1));
}

void ShutDownConnection(int fd, const std::string& ours) {
  if (IsConnectionOf(fd, ours)) ::shutdown(fd, SHUT_RDWR);
}

std::uint64_t BytesReceived(int fd) {
  tcp_info info{};
  socklen_t size = sizeof info;
  return ::getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 ? info.tcpi_bytes_received : 0;
}

std::uint64_t BytesUnderWay(int fd) {
  int bytes = 0;
  return ::ioctl(fd, SIOCOUTQ, &bytes) == 0 && bytes > 0 ? static_cast<std::uint64_t>(bytes) : 0;
}

}  // namespace cairn::wire
