// What sockets of one process share: ZeroMQ's I/O thread.
#pragma once

#include <memory>

namespace cairn::wire {

class Context {
 public:
  Context();
  // Waits until closed sockets have sent what they still had, a second at most. Sockets keep the context
  // alive.
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  struct Impl;
  const std::shared_ptr<Impl>& impl() const { return impl_; }

 private:
  std::shared_ptr<Impl> impl_;
};

}  // namespace cairn::wire
