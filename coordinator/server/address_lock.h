// So that no two coordinators serve one ipc address: whoever binds a socket takes its place from another, who
// would serve on, reached by nobody.
#pragma once

#include <string>

#include "schema/error.h"

namespace cairn::coordinator {

class AddressLock {
 public:
  // Of `ipc://PATH`: PATH.lock, which goes with the process that holds it, so that what a killed coordinator
  // left is in nobody's way. Of another endpoint nothing: the system gives it to one process at a time.
  // `what`: what others are told of this process (its store).
  // kBusy: another process serves there; the message says which.
  // Other failures: as wire::CheckEndpoint says.
  static Result<AddressLock> Take(const std::string& endpoint, const std::string& what);
  AddressLock(AddressLock&& other) noexcept;
  AddressLock& operator=(AddressLock&&) = delete;
  ~AddressLock();

 private:
  explicit AddressLock(int file) : file_(file) {}
  int file_ = -1;  // descriptor
};

}  // namespace cairn::coordinator
