// From a failed Status to an exit code: what the user named and is not there or is damaged is bad input, the
// rest is the world's fault.
#pragma once

#include <stdexcept>
#include <utility>

#include "schema/error.h"

namespace cairn::cli {

// The world failed: a full disk, a socket. Ends the command with exit code 1.
class WorldError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// kNoSpace, kIo; the others are the user's choice of a file or an endpoint.
bool IsTheWorldsFault(const Status& status);

// Throws InputError (kNotFound, kCorrupt, kVersion, kBusy, kRefused) or WorldError (kNoSpace, kIo).
[[noreturn]] void Throw(const Status& status);

inline void Check(const Status& status) {
  if (!status.ok()) Throw(status);
}

template <class T>
T Take(Result<T> result) {
  if (!result.ok()) Throw(result.status());
  return std::move(result).value();
}

}  // namespace cairn::cli
