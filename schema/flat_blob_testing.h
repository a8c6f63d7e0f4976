// Helper of tests.
#pragma once

#include <string>

#include "schema/flat_blob.h"

namespace cairn::flat_testing {

// A whole flat blob.
inline std::string Flat(const Blob& blob) {
  std::string bytes = FlatHead(MetaOf(blob.ContentHash(), blob));
  for (const auto& [name, array] : blob.fields())
    bytes.append(reinterpret_cast<const char*>(array.bytes().data()), array.bytes().size());
  return bytes;
}

}  // namespace cairn::flat_testing
