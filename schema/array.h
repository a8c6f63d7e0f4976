// An immutable, 64-byte-aligned, n-dimensional array: the unit of which blobs are made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "schema/error.h"

namespace cairn {

enum class DType : std::uint8_t {
  kU8 = 1,
  kI32 = 2,
  kI64 = 3,
  kF32 = 4,
  kF64 = 5,
  kText = 6,  // UTF-8, each element of a fixed width in bytes, padded with zeros
};

const char* DTypeName(DType type);

template <class T>
constexpr DType DTypeOf() {
  if constexpr (std::is_same_v<T, std::uint8_t>)
    return DType::kU8;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return DType::kI32;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return DType::kI64;
  else if constexpr (std::is_same_v<T, float>)
    return DType::kF32;
  else {
    static_assert(std::is_same_v<T, double>, "not an array element type");
    return DType::kF64;
  }
}

using Shape = std::vector<std::int64_t>;  // empty: a scalar

class Array {
 public:
  Array() = default;  // an empty kU8 array of shape [0]

  // Copies `values`, row-major, into fresh aligned memory. The product of `shape` must be values.size().
  template <class T>
  static Array Of(const Shape& shape, std::span<const T> values) {
    return Copy(DTypeOf<T>(), sizeof(T), shape, std::as_bytes(values));
  }
  template <class T>
  static Array Of(const Shape& shape, const std::vector<T>& values) {
    return Of<T>(shape, std::span<const T>(values));
  }
  template <class T>
  static Array Vector(const std::vector<T>& values) {
    return Of<T>({static_cast<std::int64_t>(values.size())}, std::span<const T>(values));
  }
  template <class T>
  static Array Scalar(T value) {
    return Of<T>({}, std::span<const T>(&value, 1));
  }
  // Texts of shape [n]; the width is that of the longest (at least 1).
  static Array Texts(const std::vector<std::string>& texts);
  // One text of shape [].
  static Array Text(const std::string& text);
  // Copies raw bytes, as a file or a socket gave them; fails with kCorrupt where the length does not fit.
  static Result<Array> FromBytes(DType type, std::size_t item_bytes, const Shape& shape,
                                 std::span<const std::byte> bytes);

  // The type and the shape of an array whose elements are elsewhere (schema/blob_part.h): whoever reads them
  // has a bug. kCorrupt where there can be no such array.
  static Result<Array> FormAlone(DType type, std::size_t item_bytes, const Shape& shape);

  // The same as FromBytes without a copy: `bytes` begin at a multiple of 64, and do not change while `owner`
  // lives.
  static Result<Array> Over(DType type, std::size_t item_bytes, const Shape& shape,
                            std::span<const std::byte> bytes, const std::shared_ptr<const void>& owner);
  // The same over a file that is mapped, shared, and may be larger than the memory.
  static Result<Array> OverFile(DType type, std::size_t item_bytes, const Shape& shape,
                                std::span<const std::byte> bytes, const std::shared_ptr<const void>& owner);

  DType type() const { return type_; }
  std::size_t item_bytes() const { return item_bytes_; }
  const Shape& shape() const { return shape_; }
  std::int64_t size() const;  // number of elements
  bool is_form_alone() const { return form_alone_; }
  bool is_in_file() const { return in_file_; }
  std::span<const std::byte> bytes() const { return {data_.get(), byte_count_}; }
  // All bytes, in their order, in pieces of whole elements: one; over a file several, of which one at a time
  // is in memory. `take` returns false where it wants no more.
  void TakeInPieces(const std::function<bool(std::span<const std::byte>)>& take) const;
  // What was looked at over a file need not stay in memory: it comes back when it is looked at again.
  void LetGo(std::span<const std::byte> bytes) const;

  // The elements, row-major.
  // Throws InputError where the type is another.
  template <class T>
  std::span<const T> As() const {
    RequireType(DTypeOf<T>());
    CAIRN_DEMAND(!form_alone_, "the elements of an array are read whose form alone is here");
    return {reinterpret_cast<const T*>(data_.get()), byte_count_ / sizeof(T)};
  }
  // Throws InputError where the type is not kText.
  std::vector<std::string> AsTexts() const;
  // Rows [first, first + count) along the first axis, copied, so that they are aligned too.
  Array Rows(std::int64_t first, std::int64_t count) const;

  // Same type, shape and bytes (a NaN equals itself).
  friend bool operator==(const Array& a, const Array& b);

 private:
  static Array Copy(DType type, std::size_t item_bytes, const Shape& shape, std::span<const std::byte> bytes);
  // Without data yet.
  static Result<Array> Form(DType type, std::size_t item_bytes, const Shape& shape, std::size_t byte_count);
  void RequireType(DType type) const;

  DType type_ = DType::kU8;
  std::size_t item_bytes_ = 1;
  Shape shape_{0};
  std::size_t byte_count_ = 0;
  bool form_alone_ = false, in_file_ = false;
  std::shared_ptr<const std::byte> data_;
};

}  // namespace cairn
