// Errors of what is in a file, with the file's name.
#pragma once

#include <string>

#include "schema/error.h"

namespace cairn::datasets {

// What `read` returns; what it refuses with the file's name before it.
template <class Read>
auto FromFile(const std::string& name, const Read& read) {
  try {
    return read();
  } catch (const InputError& error) {
    throw InputError(name + ": " + error.what());
  }
}

}  // namespace cairn::datasets
