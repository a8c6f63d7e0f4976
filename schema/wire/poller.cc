#include "schema/wire/poller.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

#include "schema/wire/socket_impl.h"

namespace cairn::wire {

Wakeup::Wakeup() : fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  CAIRN_DEMAND(fd_ >= 0, "the system gives no eventfd");
}
Wakeup::~Wakeup() { ::close(fd_); }

void Wakeup::Signal() const {
  const std::uint64_t one = 1;
  // Fails only where the counter is full: then the waiter is woken up anyway.
  [[maybe_unused]] const ssize_t written = ::write(fd_, &one, sizeof one);
}

void Wakeup::Clear() const {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t got = ::read(fd_, &count, sizeof count);
}

struct Poller::Impl {
  std::vector<RouterSocket::Impl*> routers;
  std::vector<DealerSocket::Impl*> dealers;
  std::vector<const Wakeup*> wakeups;
};

Poller::Poller() : impl_(std::make_unique<Impl>()) {}
Poller::~Poller() = default;
void Poller::Add(RouterSocket& socket) { impl_->routers.push_back(socket.impl_.get()); }
void Poller::Add(DealerSocket& socket) { impl_->dealers.push_back(socket.impl_.get()); }
void Poller::Add(const Wakeup& wakeup) { impl_->wakeups.push_back(&wakeup); }

bool Poller::Wait(std::chrono::milliseconds timeout) {
  // Made anew each time: a dealer that reconnects has other handles.
  std::vector<zmq::pollitem_t> items;
  for (RouterSocket::Impl* router : impl_->routers)
    items.push_back({router->socket.handle(), 0, ZMQ_POLLIN, 0});
  for (DealerSocket::Impl* dealer : impl_->dealers) {
    items.push_back({dealer->socket.handle(), 0, ZMQ_POLLIN, 0});
    timeout = std::min(timeout, std::chrono::milliseconds(dealer->options.keepalive_ms));
    if (dealer->monitor) items.push_back({dealer->monitor->handle(), 0, ZMQ_POLLIN, 0});
  }
  for (const Wakeup* wakeup : impl_->wakeups) items.push_back({nullptr, wakeup->fd_, ZMQ_POLLIN, 0});
  const int ready = zmq_poll(items.data(), static_cast<int>(items.size()), timeout.count());
  if (ready <= 0) return false;
  for (const Wakeup* wakeup : impl_->wakeups) wakeup->Clear();
  return true;
}

}  // namespace cairn::wire
