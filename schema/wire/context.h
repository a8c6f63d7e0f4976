// What sockets of one process share: ZeroMQ's I/O thread, and the thread that says which client keys may
// connect.
#pragma once

#include <filesystem>
#include <memory>

#include "schema/error.h"

namespace cairn::wire {

class Context {
 public:
  Context();
  // Waits until closed sockets have sent what they still had, a second at most. Sockets keep the context
  // alive.
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  // From now on clients connect only with keys that are in this file; it is read at each handshake, so that
  // keys can be added and taken away while a service runs. kCorrupt, kNotFound: it cannot be read now.
  Status AllowClients(const std::filesystem::path& allow_list);

  struct Impl;
  const std::shared_ptr<Impl>& impl() const { return impl_; }

 private:
  std::shared_ptr<Impl> impl_;
};

}  // namespace cairn::wire
