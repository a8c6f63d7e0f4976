#include "schema/array.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <new>

#include "schema/array_form.h"
#include "schema/walked.h"

namespace cairn {
namespace {

constexpr std::size_t kAlignment = 64;

// Number of elements, or -1 where a dimension is negative or the product overflows.
std::int64_t CountOf(const Shape& shape) {
  std::int64_t count = 1;
  for (const std::int64_t n : shape) {
    if (n < 0 || (n > 0 && count > std::numeric_limits<std::int64_t>::max() / n)) return -1;
    count *= n;
  }
  return count;
}

}  // namespace

std::shared_ptr<std::byte> AlignedBytes(std::size_t bytes) {
  auto* data =
      static_cast<std::byte*>(::operator new(std::max<std::size_t>(bytes, 1), std::align_val_t{kAlignment}));
  return {data, [](std::byte* p) { ::operator delete(p, std::align_val_t{kAlignment}); }};
}

const char* DTypeName(DType type) {
  switch (type) {
    case DType::kU8:
      return "uint8";
    case DType::kI32:
      return "int32";
    case DType::kI64:
      return "int64";
    case DType::kF32:
      return "float32";
    case DType::kF64:
      return "float64";
    case DType::kText:
      return "text";
  }
  return "unknown";
}

Array Array::Copy(DType type, std::size_t item_bytes, const Shape& shape, std::span<const std::byte> bytes) {
  Result<Array> array = FromBytes(type, item_bytes, shape, bytes);
  CAIRN_DEMAND(array.ok(), array.status().message());
  return std::move(array).value();
}

Result<std::size_t> BytesOfArray(DType type, std::size_t item_bytes, const Shape& shape) {
  const std::size_t fixed = type == DType::kU8                           ? 1
                            : type == DType::kI32 || type == DType::kF32 ? 4
                            : type == DType::kI64 || type == DType::kF64 ? 8
                                                                         : 0;
  const bool known = fixed != 0 || type == DType::kText;
  const std::int64_t count = CountOf(shape);
  if (!known || (fixed != 0 && item_bytes != fixed) || item_bytes == 0 || count < 0 ||
      static_cast<std::uint64_t>(count) > std::numeric_limits<std::size_t>::max() / item_bytes)
    return Status(Code::kCorrupt, std::string("array of ") + DTypeName(type) + ": there is no such shape");
  return static_cast<std::size_t>(count) * item_bytes;
}

Result<Array> Array::Form(DType type, std::size_t item_bytes, const Shape& shape, std::size_t byte_count) {
  const Result<std::size_t> bytes = BytesOfArray(type, item_bytes, shape);
  if (!bytes.ok() || bytes.value() != byte_count) {
    return Status(Code::kCorrupt,
                  std::string("array of ") + DTypeName(type) + ": shape and length do not agree");
  }
  Array array;
  array.type_ = type;
  array.item_bytes_ = item_bytes;
  array.shape_ = shape;
  array.byte_count_ = byte_count;
  return array;
}

Result<Array> Array::FromBytes(DType type, std::size_t item_bytes, const Shape& shape,
                               std::span<const std::byte> bytes) {
  Result<Array> array = Form(type, item_bytes, shape, bytes.size());
  if (!array.ok()) return array;
  std::shared_ptr<std::byte> data = AlignedBytes(bytes.size());
  if (!bytes.empty()) std::memcpy(data.get(), bytes.data(), bytes.size());
  array.value().data_ = std::move(data);
  return array;
}

Result<Array> Array::FormAlone(DType type, std::size_t item_bytes, const Shape& shape) {
  const Result<std::size_t> bytes = BytesOfArray(type, item_bytes, shape);
  if (!bytes.ok()) return bytes.status();
  Result<Array> array = Form(type, item_bytes, shape, bytes.value());
  if (!array.ok()) return array;
  array.value().byte_count_ = 0;
  array.value().form_alone_ = true;
  return array;
}

Result<Array> Array::Over(DType type, std::size_t item_bytes, const Shape& shape,
                          std::span<const std::byte> bytes, const std::shared_ptr<const void>& owner) {
  CAIRN_DEMAND(reinterpret_cast<std::uintptr_t>(bytes.data()) % kAlignment == 0, "not aligned");
  Result<Array> array = Form(type, item_bytes, shape, bytes.size());
  if (array.ok()) array.value().data_ = std::shared_ptr<const std::byte>(owner, bytes.data());
  return array;
}

Result<Array> Array::OverFile(DType type, std::size_t item_bytes, const Shape& shape,
                              std::span<const std::byte> bytes, const std::shared_ptr<const void>& owner) {
  Result<Array> array = Over(type, item_bytes, shape, bytes, owner);
  if (array.ok()) array.value().in_file_ = true;
  return array;
}

void Array::TakeInPieces(const std::function<bool(std::span<const std::byte>)>& take) const {
  constexpr std::size_t kPiece = 1 << 20;
  const std::size_t most = in_file_ ? std::max(kPiece / item_bytes_, std::size_t{1}) * item_bytes_
                                    : std::max<std::size_t>(byte_count_, 1);
  for (std::size_t at = 0; at < byte_count_; at += most) {
    const auto piece = bytes().subspan(at, std::min(most, byte_count_ - at));
    const bool goes_on = take(piece);
    LetGo(piece);
    if (!goes_on) return;
  }
}

void Array::LetGo(std::span<const std::byte> bytes) const {
  if (!in_file_ || bytes.empty()) return;
  LetGoOfMapped(this->bytes(), static_cast<std::size_t>(bytes.data() - data_.get()), bytes.size());
}

Array Array::Texts(const std::vector<std::string>& texts) {
  std::size_t width = 1;
  for (const std::string& text : texts) width = std::max(width, text.size());
  std::vector<std::byte> bytes(width * texts.size());
  for (std::size_t i = 0; i < texts.size(); ++i)
    std::memcpy(bytes.data() + i * width, texts[i].data(), texts[i].size());
  return Copy(DType::kText, width, {static_cast<std::int64_t>(texts.size())}, bytes);
}

Array Array::Text(const std::string& text) {
  Array array = Texts({text});
  array.shape_ = {};
  return array;
}

std::int64_t Array::size() const { return CountOf(shape_); }

void Array::RequireType(DType type) const {
  if (type != type_) {
    throw InputError(std::string("an array holds ") + DTypeName(type_) + " where " + DTypeName(type) +
                     " is needed");
  }
}

std::vector<std::string> Array::AsTexts() const {
  RequireType(DType::kText);
  CAIRN_DEMAND(!form_alone_, "the elements of an array are read whose form alone is here");
  std::vector<std::string> texts;
  for (std::size_t at = 0; at < byte_count_; at += item_bytes_) {
    const char* text = reinterpret_cast<const char*>(data_.get()) + at;
    texts.emplace_back(text, strnlen(text, item_bytes_));
  }
  return texts;
}

Array Array::Rows(std::int64_t first, std::int64_t count) const {
  CAIRN_DEMAND(!form_alone_, "the elements of an array are read whose form alone is here");
  CAIRN_DEMAND(!shape_.empty() && first >= 0 && count >= 0 && first + count <= shape_[0],
               "rows out of range");
  Shape shape = shape_;
  shape[0] = count;
  const std::size_t row_bytes = shape_[0] == 0 ? 0 : byte_count_ / static_cast<std::size_t>(shape_[0]);
  return Copy(type_, item_bytes_, shape,
              bytes().subspan(static_cast<std::size_t>(first) * row_bytes,
                              static_cast<std::size_t>(count) * row_bytes));
}

bool operator==(const Array& a, const Array& b) {
  return a.type_ == b.type_ && a.item_bytes_ == b.item_bytes_ && a.shape_ == b.shape_ &&
         a.form_alone_ == b.form_alone_ && std::ranges::equal(a.bytes(), b.bytes());
}

}  // namespace cairn
