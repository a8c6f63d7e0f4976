// The blobs that the core holds: in memory, and those beyond a cap on disk only.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "coordinator/core/blob_ledger.h"
#include "coordinator/store/blob_files.h"
#include "schema/blob.h"
#include "schema/wire/codec.h"

namespace cairn::coordinator {

class BlobStore {
 public:
  BlobStore(BlobFiles& files, std::uint64_t memory_bytes) : files_(files), cap_bytes_(memory_bytes) {}

  // A blob that whoever starts this process holds, and brings along again with the next start: it is never
  // dropped, written or counted.
  void Give(const wire::NamedBlob& named) { given_[named.hash] = named.blob; }

  // `ticket`: any number that grows; what is made durable under an earlier one does not count for this blob.
  void Put(const wire::NamedBlob& named, std::uint64_t ticket);
  // A blob that lies on disk already, read when it is asked for.
  void AddDurable(const Hash& hash);
  // One that could not be read back does not count: whoever has it may send it again.
  bool Has(const Hash& hash) const;
  // Null where it is unknown, or cannot be read back: then `why` says so, where it is asked for.
  BlobPtr Get(const Hash& hash, Status* why = nullptr);
  // Whether Get, or of a part GetPart, would have to read and unpack what may be large, which is for another
  // thread: BlobFiles::ReadOwnFile.
  bool MustRead(const Hash& hash, bool part = false) const;
  // What was read there: Get and GetPart take it for what they would read, until it is forgotten.
  void TakeRead(std::map<Hash, Result<BlobPtr>> read) { read_ = std::move(read); }
  void ForgetRead() { read_.clear(); }
  bool HasRead(const Hash& hash) const { return read_.contains(hash); }
  // Of an input on disk it reads no more than that. kNotFound: the blob is unknown; kRefused: it has no such
  // part; else it cannot be read back.
  Result<BlobPtr> GetPart(const Hash& hash, const proto::BlobPart& part);
  void Drop(const std::vector<Hash>& hashes);
  void MarkDurable(const std::vector<Hash>& hashes, std::uint64_t ticket);
  bool Durable(const Hash& hash) const;
  std::set<Hash> Known() const;
  // Blobs to be written so that memory comes below the cap; each is named once.
  std::vector<Hash> TakeSpills();

  std::uint64_t memory_bytes() const { return bytes_; }
  std::size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    BlobPtr blob;  // null: on disk only
    std::uint64_t bytes = 0;
    std::uint64_t ticket = 0;
    bool durable = false;
    bool spilling = false;
    bool lost = false;              // could not be read back
    std::list<Hash>::iterator age;  // in ages_, where blob is not null
  };
  void Keep(Entry& entry, const Hash& hash, BlobPtr blob);
  void Evict();

  BlobFiles& files_;
  const std::uint64_t cap_bytes_;
  std::uint64_t bytes_ = 0;
  std::map<Hash, BlobPtr> given_;
  HashMap<Entry> entries_;
  std::map<Hash, Result<BlobPtr>> read_;
  std::list<Hash> ages_;  // least recently used first
};

}  // namespace cairn::coordinator
