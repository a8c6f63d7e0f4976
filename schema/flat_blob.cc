#include "schema/flat_blob.h"

#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "schema/array_form.h"
#include "schema/text.h"

namespace cairn {
namespace {

constexpr std::array<char, 8> kMagic{'C', 'A', 'I', 'R', 'N', 'B', 'L', 'B'};
constexpr std::uint64_t kFlatVersion = 1;
constexpr std::size_t kFixedBytes = kMagic.size() + 16;  // magic, version, length of the list of arrays

Status Corrupt(const std::string& why) { return {Code::kCorrupt, "not a flat blob: " + why}; }

std::string Little(std::uint64_t value) {
  std::string bytes;
  for (int i = 0; i < 8; ++i) bytes += static_cast<char>(value >> (8 * i));
  return bytes;
}

std::uint64_t FromLittle(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i)
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  return value;
}

Shape ShapeOf(const wire::ArrayMeta& array) { return {array.shape().begin(), array.shape().end()}; }

Result<std::size_t> BytesOf(const wire::ArrayMeta& array) {
  if (array.type() > static_cast<std::uint32_t>(DType::kText)) return Corrupt("an array of an unknown type");
  return BytesOfArray(static_cast<DType>(array.type()), array.item_bytes(), ShapeOf(array));
}

// Strictly ascending names: one given twice would shadow the first, and the hash runs in this order.
Status CheckMeta(const wire::BlobMeta& meta) {
  for (int i = 0; i < meta.arrays_size(); ++i) {
    const wire::ArrayMeta& array = meta.arrays(i);
    if (i > 0 && array.name() <= meta.arrays(i - 1).name()) return Corrupt("array names out of order");
    if (array.form_alone()) return Corrupt("an array without its elements");
    if (const std::string wrong = WhatIsWrongWithName(array.name(), kMostDatasetBytes); !wrong.empty())
      return Corrupt("the name of an array " + wrong);
    if (const Result<std::size_t> bytes = BytesOf(array); !bytes.ok()) return bytes.status();
  }
  return Status::Ok();
}

}  // namespace

std::string FlatHead(const wire::BlobMeta& meta) {
  const std::string arrays = meta.SerializeAsString();
  return std::string(kMagic.data(), kMagic.size()) + Little(kFlatVersion) + Little(arrays.size()) + arrays;
}

Result<std::uint64_t> FlatBytes(const wire::BlobMeta& meta) {
  if (const std::size_t bytes = meta.ByteSizeLong(); bytes > kMostFlatMetaBytes)
    return Status(Code::kRefused, "too many arrays: their list has " + std::to_string(bytes) +
                                      " bytes, and may have " + std::to_string(kMostFlatMetaBytes));
  if (Status good = CheckMeta(meta); !good.ok()) return good;
  std::uint64_t sum = kFixedBytes + meta.ByteSizeLong();
  for (const wire::ArrayMeta& array : meta.arrays())
    if (__builtin_add_overflow(sum, BytesOf(array).value(), &sum)) return Corrupt("more than can be");
  return sum;
}

wire::BlobMeta MetaOf(const Hash& hash, const Blob& blob) {
  wire::BlobMeta meta;
  meta.set_hash(hash.Binary());
  for (const auto& [name, array] : blob.fields()) {
    wire::ArrayMeta& a = *meta.add_arrays();
    a.set_name(name);
    a.set_type(static_cast<std::uint32_t>(array.type()));
    a.set_item_bytes(array.item_bytes());
    a.mutable_shape()->Assign(array.shape().begin(), array.shape().end());
    if (array.is_form_alone()) a.set_form_alone(true);
  }
  return meta;
}

Result<bool> FlatCheck::TakeHead(std::span<const std::byte>& bytes) {
  while (true) {
    std::size_t needed = kFixedBytes;
    if (head_.size() >= kFixedBytes) {
      if (std::memcmp(head_.data(), kMagic.data(), kMagic.size()) != 0) return Corrupt("it begins otherwise");
      if (FromLittle(std::string_view(head_).substr(8)) != kFlatVersion)
        return Status(Code::kVersion, "a flat blob of another version than " + std::to_string(kFlatVersion));
      const std::uint64_t arrays = FromLittle(std::string_view(head_).substr(16));
      if (arrays > kMostFlatMetaBytes)
        return Status(Code::kRefused, "a flat blob with too long a list of arrays");
      needed += static_cast<std::size_t>(arrays);
      if (head_.size() == needed) return true;
    }
    const std::size_t more = std::min(needed - head_.size(), bytes.size());
    if (more == 0) return false;
    head_.append(reinterpret_cast<const char*>(bytes.data()), more);
    bytes = bytes.subspan(more);
  }
}

Status FlatCheck::TakeMeta() {
  const google::protobuf::LogSilencer quiet;  // a peer must not fill our log with protobuf's complaints
  if (!meta_.ParseFromArray(head_.data() + kFixedBytes, static_cast<int>(head_.size() - kFixedBytes)))
    return Corrupt("its list of arrays cannot be parsed");
  if (meta_.hash() != hash_.Binary()) return Corrupt("of another hash than " + hash_.Hex());
  if (Status good = CheckMeta(meta_); !good.ok()) return good;
  head_bytes_ = head_.size();
  head_ = std::string();
  has_meta_ = true;
  BeginArrays();
  return Status::Ok();
}

void FlatCheck::BeginArrays() {
  while (left_ == 0 && next_ < meta_.arrays_size()) {
    const wire::ArrayMeta& array = meta_.arrays(next_++);
    left_ = BytesOf(array).value();
    AddArrayHead(content_, array.name(), static_cast<DType>(array.type()), array.item_bytes(),
                 ShapeOf(array));
  }
}

Status FlatCheck::Add(std::span<const std::byte> bytes) {
  if (!has_meta_) {
    const Result<bool> whole = TakeHead(bytes);
    if (!whole.ok()) return whole.status();
    if (!whole.value()) return Status::Ok();
    if (Status meta = TakeMeta(); !meta.ok()) return meta;
  }
  while (!bytes.empty()) {
    if (left_ == 0) return Corrupt("more bytes than its arrays have");
    const auto part = bytes.first(static_cast<std::size_t>(std::min<std::uint64_t>(left_, bytes.size())));
    content_.Add(part);
    left_ -= part.size();
    bytes = bytes.subspan(part.size());
    BeginArrays();
  }
  return Status::Ok();
}

Status FlatCheck::Finish() const {
  if (!has_meta_ || left_ > 0) return Corrupt("truncated");
  if (content_.Finish() != hash_)
    return {Code::kCorrupt, "a blob's bytes do not match its hash " + hash_.Hex()};
  return Status::Ok();
}

}  // namespace cairn
