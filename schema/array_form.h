// What arrays are made of, for code that takes them in piece by piece: memory, the bytes that a form has, and
// what a content hash takes of them.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include "schema/array.h"
#include "schema/hash.h"

namespace cairn {

// Memory for Array::Over: it begins at a multiple of 64.
std::shared_ptr<std::byte> AlignedBytes(std::size_t bytes);

// How many bytes an array of this form has; kCorrupt where there can be no such array.
Result<std::size_t> BytesOfArray(DType type, std::size_t item_bytes, const Shape& shape);

// What the content hash of a blob takes of an array before its bytes.
void AddArrayHead(Hasher& hasher, std::string_view name, DType type, std::size_t item_bytes,
                  const Shape& shape);

}  // namespace cairn
