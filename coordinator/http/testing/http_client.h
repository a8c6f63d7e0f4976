// A browser, as far as tests need one: connections to a port of this machine.
#pragma once

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <utility>

namespace cairn::coordinator {

class HttpClient {
 public:
  // `address`: HOST:PORT, of which the port counts.
  explicit HttpClient(const std::string& where) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(where.substr(where.rfind(':') + 1))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{.tv_sec = 60, .tv_usec = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  HttpClient(HttpClient&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  HttpClient& operator=(HttpClient&&) = delete;
  ~HttpClient() {
    if (socket_ >= 0) ::close(socket_);
  }
  // False where the other side is gone.
  bool Say(const std::string& text) const {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
  }
  // All that comes until the other side closes, or breaks off, which it must.
  std::string HearAll() const {
    std::string all;
    while (Hear(&all)) {
    }
    EXPECT_NE(errno, EAGAIN) << "the connection stands";
    return all;
  }
  // What comes until `text` is in it, which must come.
  std::string HearUntil(const std::string& text) const {
    std::string all;
    while (all.find(text) == std::string::npos && Hear(&all)) {
    }
    EXPECT_NE(all.find(text), std::string::npos) << all;
    return all;
  }

 private:
  // Not recv: that of schema/wire, which takes this for a handshake of ZeroMQ's.
  bool Hear(std::string* all) const {
    std::array<char, 65536> bytes{};
    ssize_t size = 0;
    do {
      errno = 0;
      size = ::read(socket_, bytes.data(), bytes.size());
    } while (size < 0 && errno == EINTR);  // by the end of a process that the server started
    if (size > 0) all->append(bytes.data(), static_cast<std::size_t>(size));
    return size > 0;
  }

  int socket_;
};

}  // namespace cairn::coordinator
