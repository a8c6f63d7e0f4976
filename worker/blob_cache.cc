#include "worker/blob_cache.h"

namespace cairn::worker {

std::size_t BlobCache::Footprint(const Blob& blob) {
  std::size_t bytes = kBlobBytes + blob.ByteCount();
  for (const auto& [name, array] : blob.fields()) bytes += kArrayBytes + name.size();
  return bytes;
}

void BlobCache::Put(const wire::NamedBlob& named) {
  if (Get(named.hash) != nullptr) return;
  const std::size_t bytes = Footprint(*named.blob);
  if (bytes > max_bytes_) return;
  while (bytes_ + bytes > max_bytes_) DropLast();
  order_.push_front(named);
  index_[named.hash] = order_.begin();
  bytes_ += bytes;
}

BlobPtr BlobCache::Get(const Hash& hash) {
  const auto it = index_.find(hash);
  if (it == index_.end()) return nullptr;
  order_.splice(order_.begin(), order_, it->second);
  return it->second->blob;
}

void BlobCache::DropLast() {
  bytes_ -= Footprint(*order_.back().blob);
  index_.erase(order_.back().hash);
  order_.pop_back();
}

}  // namespace cairn::worker
