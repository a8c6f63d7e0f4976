// For tests that attack: connections without any manners, and listeners that take them.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <utility>

#include "schema/error.h"

namespace cairn::wire {

inline int PortOf(const std::string& endpoint) {
  return std::atoi(endpoint.substr(endpoint.rfind(':') + 1).c_str());
}

// A connection, by its descriptor.
class RawTcp {
 public:
  RawTcp(int fd, bool connected) : fd_(fd), connected_(connected) {}
  explicit RawTcp(int port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const sockaddr_in address = Loopback(port);
    connected_ = ::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  RawTcp(RawTcp&& other) noexcept : fd_(std::exchange(other.fd_, -1)), connected_(other.connected_) {}
  RawTcp& operator=(RawTcp&&) = delete;
  ~RawTcp() {
    if (fd_ >= 0) ::close(fd_);
  }
  bool connected() const { return connected_; }
  void Send(const std::string& bytes) const {
    [[maybe_unused]] const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  // Throws away what comes; true where the other side ends the connection within `patience_ms` of silence.
  bool IsEnded(int patience_ms) const {
    pollfd item{fd_, POLLIN, 0};
    char buffer[4096];
    while (::poll(&item, 1, patience_ms) > 0)
      if (::recv(fd_, buffer, sizeof buffer, 0) <= 0) return true;
    return false;
  }
  static sockaddr_in Loopback(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }

 private:
  int fd_;
  bool connected_ = false;
};

inline sockaddr_un UnixAddress(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  return address;
}

inline int ConnectUnix(const std::string& path) {
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_un address = UnixAddress(path);
  CAIRN_DEMAND(::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0, path);
  return fd;
}

// The same over ipc.
class RawIpc : public RawTcp {
 public:
  explicit RawIpc(const std::string& path) : RawTcp(ConnectUnix(path), true) {}
};

// Listens where a coordinator should: at a port of its own of this machine, or, of a path, at a socket file.
class RawListener {
 public:
  RawListener() : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const int on = 1;  // so that whoever comes next may have the port at once
    ::setsockopt(fd_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    sockaddr_in address = RawTcp::Loopback(0);
    socklen_t size = sizeof address;
    Listen(address);
    CAIRN_DEMAND(::getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size) == 0, "no port");
    endpoint_ = "tcp://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  }
  explicit RawListener(const std::string& path)
      : fd_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)), endpoint_("ipc://" + path) {
    Listen(UnixAddress(path));
  }
  ~RawListener() { ::close(fd_); }
  RawListener(const RawListener&) = delete;
  RawListener& operator=(const RawListener&) = delete;
  int fd() const { return fd_; }
  const std::string& endpoint() const { return endpoint_; }
  int AcceptFd() const { return ::accept4(fd_, nullptr, nullptr, SOCK_CLOEXEC); }
  RawTcp Accept() const { return {AcceptFd(), true}; }

 private:
  template <class Address>
  void Listen(const Address& address) const {
    constexpr int kWaiting = 8;
    CAIRN_DEMAND(::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
                     ::listen(fd_, kWaiting) == 0,
                 "nowhere to listen");
  }

  const int fd_;
  std::string endpoint_;
};

// Nobody else's, as far as anybody can know.
inline std::string FreeTcpEndpoint() { return RawListener().endpoint(); }

}  // namespace cairn::wire
