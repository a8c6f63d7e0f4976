// Blobs that may be asked for again, by content hash: the least recently used go first. For one thread.
#pragma once

#include <cstddef>
#include <list>
#include <map>

#include "schema/wire/codec.h"

namespace cairn::worker {

class BlobCache {
 public:
  // Of a blob beside its arrays' bytes, about: what it is kept in, and its arrays and their names.
  static constexpr std::size_t kBlobBytes = 256, kArrayBytes = 256;
  static std::size_t Footprint(const Blob& blob);

  explicit BlobCache(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  // A blob larger than the whole cache is not kept.
  void Put(const wire::NamedBlob& named);
  BlobPtr Get(const Hash& hash);                // null where it is not here
  std::size_t bytes() const { return bytes_; }  // with what blobs take beside their arrays' bytes
  std::size_t size() const { return order_.size(); }

 private:
  using Order = std::list<wire::NamedBlob>;  // most recently used first
  void DropLast();

  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  Order order_;
  std::map<Hash, Order::iterator> index_;
};

}  // namespace cairn::worker
