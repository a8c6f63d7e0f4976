// A blob as a stream of bytes, as it is uploaded and as a store keeps it then (FORMAT.md, `flat blob`): a
// head that says which arrays come, and their bytes. No files and sockets in here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "schema/blob.h"
#include "schema/wire.pb.h"

namespace cairn {

// Of the list of arrays in the head: about as many as 10,000.
inline constexpr std::size_t kMostFlatMetaBytes = std::size_t{1} << 20;

// All that comes before the arrays' bytes.
std::string FlatHead(const wire::BlobMeta& meta);
// Of the head and the arrays; kCorrupt where there can be no such arrays, kRefused where the head is too
// long.
Result<std::uint64_t> FlatBytes(const wire::BlobMeta& meta);

// What is announced of a blob.
wire::BlobMeta MetaOf(const Hash& hash, const Blob& blob);

// Looks at a flat blob while it comes, in pieces of any size, and keeps no more than its head.
class FlatCheck {
 public:
  explicit FlatCheck(const Hash& hash) : hash_(hash) {}
  // The next bytes.
  // kCorrupt: they are none of a flat blob of this hash.
  // kVersion: they are of a newer kind.
  // kRefused: the head is too long.
  Status Add(std::span<const std::byte> bytes);
  // All has come: kCorrupt where something is missing or the content is not what the hash says.
  Status Finish() const;
  // Once the head has come: what it says, else null; and how many bytes it had.
  const wire::BlobMeta* meta() const { return has_meta_ ? &meta_ : nullptr; }
  std::size_t head_bytes() const { return head_bytes_; }
  const Hash& hash() const { return hash_; }

 private:
  Result<bool> TakeHead(std::span<const std::byte>& bytes);  // false: more of it must come
  Status TakeMeta();
  void BeginArrays();  // those that are next, up to one that has bytes

  const Hash hash_;
  Hasher content_;
  std::string head_;  // what came of it
  std::size_t head_bytes_ = 0;
  bool has_meta_ = false;
  wire::BlobMeta meta_;
  int next_ = 0;            // array
  std::uint64_t left_ = 0;  // bytes of the one before
};

}  // namespace cairn
