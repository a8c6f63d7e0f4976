// For tests that attack: a TCP connection without any manners, and a relay that listens in and tampers.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
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

// The same over ipc.
class RawIpc : public RawTcp {
 public:
  explicit RawIpc(const std::string& path) : RawTcp(Connected(path), true) {}

 private:
  static int Connected(const std::string& path) {
    const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    CAIRN_DEMAND(::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0, path);
    return fd;
  }
};

// Listens where a coordinator should.
class Impostor {
 public:
  Impostor() : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = RawTcp::Loopback(0);
    socklen_t size = sizeof address;
    CAIRN_DEMAND(::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                     ::listen(listener_, 1) == 0 &&
                     ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) == 0,
                 "no port to listen at");
    endpoint_ = "tcp://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  }
  ~Impostor() { ::close(listener_); }
  Impostor(const Impostor&) = delete;
  Impostor& operator=(const Impostor&) = delete;
  const std::string& endpoint() const { return endpoint_; }
  RawTcp Accept() const { return {::accept(listener_, nullptr, nullptr), true}; }

 private:
  const int listener_;
  std::string endpoint_;
};

// Relays one connection to `port`. What the client sends goes through `tamper` first.
class Relay {
 public:
  explicit Relay(int port) : port_(port), listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = RawTcp::Loopback(0);
    socklen_t size = sizeof address;
    CAIRN_DEMAND(::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                     ::listen(listener_, 1) == 0 &&
                     ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) == 0,
                 "no port to relay from");
    endpoint_ = "tcp://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    thread_ = std::thread([this] { Run(); });
  }
  ~Relay() {
    stop_ = true;
    thread_.join();
    ::close(listener_);
  }
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;
  const std::string& endpoint() const { return endpoint_; }
  std::string Heard() {  // from the client, so far
    const std::lock_guard lock(mutex_);
    return heard_;
  }
  void Tamper(std::function<std::string(std::string)> tamper) {
    const std::lock_guard lock(mutex_);
    tamper_ = std::move(tamper);
  }

 private:
  void Run() {
    pollfd waiting{listener_, POLLIN, 0};
    while (!stop_ && ::poll(&waiting, 1, 10) <= 0) {
    }
    if (stop_) return;
    const int client = ::accept(listener_, nullptr, nullptr);
    const int server = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const sockaddr_in address = RawTcp::Loopback(port_);
    if (::connect(server, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
      while (!stop_ && Pump(client, server)) {
      }
    }
    ::close(client);
    ::close(server);
  }
  bool Pump(int client, int server) {
    pollfd items[2] = {{client, POLLIN, 0}, {server, POLLIN, 0}};
    ::poll(items, 2, 10);
    for (const pollfd& item : items) {
      if (item.revents == 0) continue;
      std::string bytes(65536, '\0');
      const ssize_t got = ::recv(item.fd, bytes.data(), bytes.size(), 0);
      if (got <= 0) return false;
      bytes.resize(static_cast<std::size_t>(got));
      if (item.fd == client) bytes = Hear(std::move(bytes));
      if (::send(item.fd == client ? server : client, bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0)
        return false;
    }
    return true;
  }
  std::string Hear(std::string bytes) {
    const std::lock_guard lock(mutex_);
    heard_ += bytes;
    return tamper_ ? tamper_(std::move(bytes)) : bytes;
  }

  const int port_;
  const int listener_;
  std::string endpoint_;
  std::mutex mutex_;
  std::string heard_;
  std::function<std::string(std::string)> tamper_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace cairn::wire
