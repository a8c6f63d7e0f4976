#include "schema/wire/testing/relay.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace cairn::wire {
namespace {

// Minus one where nobody listens.
int ConnectTcp(int port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in address = RawTcp::Loopback(port);
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
  ::close(fd);
  return -1;
}

}  // namespace

TamperingRelay::TamperingRelay(int port) : port_(port), thread_([this] { Run(); }) {}

TamperingRelay::~TamperingRelay() {
  stop_ = true;
  thread_.join();
}

std::string TamperingRelay::Heard() {
  const std::lock_guard lock(mutex_);
  return heard_;
}

void TamperingRelay::Tamper(std::function<std::string(std::string)> tamper) {
  const std::lock_guard lock(mutex_);
  tamper_ = std::move(tamper);
}

void TamperingRelay::Run() {
  pollfd waiting{listener_.fd(), POLLIN, 0};
  while (!stop_ && ::poll(&waiting, 1, 10) <= 0) {
  }
  if (stop_) return;
  const int client = listener_.AcceptFd();
  const int server = ConnectTcp(port_);
  while (server >= 0 && !stop_ && Pump(client, server)) {
  }
  ::close(client);
  if (server >= 0) ::close(server);
}

bool TamperingRelay::Pump(int client, int server) {
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

std::string TamperingRelay::Hear(std::string bytes) {
  const std::lock_guard lock(mutex_);
  heard_ += bytes;
  return tamper_ ? tamper_(std::move(bytes)) : bytes;
}

StallingRelay::StallingRelay(const std::string& listens, const std::string& goes_to)
    : connect_([goes_to] { return ConnectUnix(goes_to); }), listener_(listens), thread_([this] { Run(); }) {}

StallingRelay::StallingRelay(int port)
    : connect_([port] { return ConnectTcp(port); }), thread_([this] { Run(); }) {}

StallingRelay::~StallingRelay() {
  stop_ = true;
  thread_.join();
  CloseAll();
}

void StallingRelay::Run() {
  while (!stop_) {
    if (breaks_.exchange(false)) CloseAll();
    std::vector<pollfd> waits = ends_;
    waits.push_back({listener_.fd(), POLLIN, 0});
    ::poll(waits.data(), waits.size(), 5);
    if (waits.back().revents != 0) Accept();
    for (std::size_t i = 0; i + 1 < waits.size(); ++i)
      if (waits[i].revents != 0) Pass(i);
  }
}

void StallingRelay::Accept() {
  const int dealer = listener_.AcceptFd(), router = connect_();
  if (router < 0) {
    ::close(dealer);
    return;
  }
  ends_.push_back({dealer, POLLIN, 0});
  ends_.push_back({router, POLLIN, 0});
}

void StallingRelay::Pass(std::size_t from) {
  char bytes[65536];
  const bool of_router = from % 2 == 1;
  const std::size_t room =
      of_router && !stalled
          ? std::min<std::size_t>(sizeof bytes, std::min<std::uint64_t>(most, may_pass) - passed)
          : sizeof bytes;
  if (room == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return;
  }
  const ssize_t count = ::read(ends_[from].fd, bytes, room);
  if (count <= 0) {
    ends_[from].events = 0;  // closed: the other end is left as it is
    return;
  }
  if (stalled) return;
  EXPECT_EQ(::send(ends_[from ^ 1].fd, bytes, static_cast<std::size_t>(count), MSG_NOSIGNAL), count);
  if (of_router && (passed += static_cast<std::uint64_t>(count)) >= most) stalled = true;
}

void StallingRelay::CloseAll() {
  for (const pollfd& end : ends_) ::close(end.fd);
  ends_.clear();
  most = std::numeric_limits<std::uint64_t>::max();
  stalled = false;
}

}  // namespace cairn::wire
