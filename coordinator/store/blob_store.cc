#include "coordinator/store/blob_store.h"

#include <utility>

#include "schema/blob_part.h"

namespace cairn::coordinator {

void BlobStore::Put(const wire::NamedBlob& named, std::uint64_t ticket) {
  if (given_.contains(named.hash)) return;
  const auto [it, is_new] = entries_.try_emplace(named.hash);
  if (!is_new && !it->second.lost) return;
  it->second = Entry();
  it->second.ticket = ticket;
  Keep(it->second, named.hash, named.blob);
  Evict();
}

void BlobStore::AddDurable(const Hash& hash) {
  if (given_.contains(hash)) return;
  entries_[hash].durable = true;
  entries_[hash].lost = false;
}

bool BlobStore::Has(const Hash& hash) const {
  const auto entry = entries_.find(hash);
  return given_.contains(hash) || (entry != entries_.end() && !entry->second.lost);
}

void BlobStore::Keep(Entry& entry, const Hash& hash, BlobPtr blob) {
  entry.bytes = blob->ByteCount();
  entry.blob = std::move(blob);
  entry.age = ages_.insert(ages_.end(), hash);
  bytes_ += entry.bytes;
}

BlobPtr BlobStore::Get(const Hash& hash, Status* why) {
  if (const auto given = given_.find(hash); given != given_.end()) return given->second;
  const auto it = entries_.find(hash);
  if (it == entries_.end()) return nullptr;
  Entry& entry = it->second;
  if (entry.blob != nullptr) {
    ages_.splice(ages_.end(), ages_, entry.age);
    return entry.blob;
  }
  const auto there = read_.find(hash);
  Result<BlobPtr> read = there != read_.end() ? there->second : files_.Read(hash);
  entry.lost = !read.ok();
  if (entry.lost) {
    if (why != nullptr) *why = read.status();
    return nullptr;
  }
  BlobPtr blob = std::move(read).value();
  Keep(entry, hash, blob);
  Evict();
  return blob;
}

bool BlobStore::MustRead(const Hash& hash, bool part) const {
  constexpr std::uint64_t kSmallBytes = 1 << 20;
  const auto it = entries_.find(hash);
  if (given_.contains(hash) || it == entries_.end() || it->second.blob != nullptr) return false;
  const std::uint64_t bytes = it->second.bytes;  // 0: it was never in memory
  if ((bytes > 0 && bytes <= kSmallBytes) || files_.IsPacked(hash)) return false;
  return !part || !files_.IsFlat(hash);
}

Result<BlobPtr> BlobStore::GetPart(const Hash& hash, const proto::BlobPart& part) {
  const auto it = entries_.find(hash);
  if (it != entries_.end() && it->second.blob == nullptr) {
    Result<BlobPtr> read = files_.ReadPart(hash, part);
    if (read.ok() || read.status().code() != Code::kNotFound) {
      it->second.lost = !read.ok() && read.status().code() != Code::kRefused;
      return read;
    }
  }
  Status unread(Code::kNotFound, "there is no such blob");
  const BlobPtr whole = Get(hash, &unread);
  if (whole == nullptr) return unread;
  return CutPart(*whole, part);
}

// Those on disk too go first come first out; the rest waits until it is spilled.
void BlobStore::Evict() {
  for (auto age = ages_.begin(); bytes_ > cap_bytes_ && age != ages_.end();) {
    Entry& entry = entries_.at(*age);
    if (!entry.durable) {
      ++age;
      continue;
    }
    bytes_ -= entry.bytes;
    entry.blob.reset();
    age = ages_.erase(age);
  }
}

std::vector<Hash> BlobStore::TakeSpills() {
  std::vector<Hash> spills;
  std::uint64_t left_bytes = bytes_;
  for (const Hash& hash : ages_) {
    if (left_bytes <= cap_bytes_) break;
    Entry& entry = entries_.at(hash);
    left_bytes -= entry.bytes;
    if (!entry.spilling) spills.push_back(hash);
    entry.spilling = true;
  }
  return spills;
}

void BlobStore::Drop(const std::vector<Hash>& hashes) {
  for (const Hash& hash : hashes) {
    const auto it = entries_.find(hash);
    if (it == entries_.end()) continue;
    files_.ForgetParts(hash);
    if (it->second.blob != nullptr) {
      bytes_ -= it->second.bytes;
      ages_.erase(it->second.age);
    }
    entries_.erase(it);
  }
}

void BlobStore::MarkDurable(const std::vector<Hash>& hashes, std::uint64_t ticket) {
  for (const Hash& hash : hashes) {
    const auto it = entries_.find(hash);
    if (it != entries_.end() && ticket >= it->second.ticket) it->second.durable = true;
  }
  Evict();
}

std::set<Hash> BlobStore::Known() const {
  std::set<Hash> known;
  for (const auto& [hash, entry] : entries_) known.insert(hash);
  return known;
}

bool BlobStore::Durable(const Hash& hash) const {
  if (given_.contains(hash)) return true;
  const auto it = entries_.find(hash);
  return it != entries_.end() && it->second.durable;
}

}  // namespace cairn::coordinator
