// Where a store's blobs lie on disk: each in a file of its own (an input as a flat blob, as it came), or,
// where many small ones are written at once, together in a pack, so that saving a long round costs a file and
// not one a partial.
//
// The event loop reads what is small, the writing thread the rest; that writes and removes.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/uploads.h"
#include "coordinator/store/folder.h"
#include "schema/store/flat_file.h"
#include "schema/store/flat_parts.h"
#include "schema/wire/codec.h"

namespace cairn::coordinator {

class BlobFiles {
 public:
  // Looks into the packs that are there; one that is damaged is quarantined.
  explicit BlobFiles(const StoreFolder& folder);

  // True also where that cannot be told now: then Read says why.
  bool Has(const Hash& hash) const;
  // kNotFound; kCorrupt where the file is damaged or its content is not what its name says.
  Result<BlobPtr> Read(const Hash& hash);
  // The same of one that is not packed, on any thread.
  Result<BlobPtr> ReadOwnFile(const Hash& hash) const;
  bool IsPacked(const Hash& hash) const;
  bool IsFlat(const Hash& hash) const { return FileOf(hash) == folder_.FlatFile(hash); }
  // A part of a flat blob, at no more than its cost but for the first of one that was not uploaded since the
  // start, which checks the whole file; of any other blob kNotFound, for it is read whole. As FlatParts says.
  Result<BlobPtr> ReadPart(const Hash& hash, const proto::BlobPart& part);
  void ForgetParts(const Hash& hash);  // it will not be asked for any more
  // Said by the writing thread of what was uploaded.
  void KnowParts(const Hash& hash, FlatParts parts);
  // Whether Read would give it. Costs nothing for what lies in a pack: those were read when they were
  // indexed.
  Status Check(const Hash& hash) const;
  // Appends to `written` those that lie on disk now, also where it fails on the way.
  Status Write(const std::vector<wire::NamedBlob>& blobs, std::vector<Hash>& written);
  // A pack goes with the last of its blobs. What cannot be removed is made up for by the next start.
  void Remove(const std::vector<Hash>& hashes);
  // Renames the file that holds it: with a pack, all of its blobs are gone.
  void Quarantine(const Hash& hash);
  void RemoveAllBut(const std::set<Hash>& named);
  // What a pack holds that somebody may need, without reading it where it is known; none: it cannot be read.
  std::optional<std::vector<Hash>> InPack(const std::filesystem::path& pack) const;
  // Packs that others have removed.
  void ForgetGonePacks();

 private:
  void Index(const std::filesystem::path& pack, const std::vector<wire::NamedBlob>& blobs);
  std::filesystem::path FileOf(const Hash& hash) const;
  Result<BlobPtr> ReadPacked(const std::filesystem::path& pack, const Hash& hash);
  Status WritePack(const std::vector<wire::NamedBlob>& blobs, std::vector<Hash>& written);

  struct OpenPack {
    std::filesystem::path path;
    std::map<Hash, BlobPtr> blobs;
  };
  const StoreFolder& folder_;
  std::deque<OpenPack> open_packs_;                   // read last; of the thread that reads
  FlatPartsCache parts_;                              // the same
  mutable std::mutex mutex_;                          // of what follows
  std::vector<std::pair<Hash, FlatParts>> uploaded_;  // that parts_ does not have yet
  std::map<std::filesystem::path, std::set<Hash>> packs_;
  std::map<Hash, std::filesystem::path> pack_of_;
};

// Whether a blob that has a file of its own is whole: kNotFound, kCorrupt, as BlobFiles::Read says.
Status CheckBlobAlone(const StoreFolder& folder, const Hash& hash);

// The files of inputs that are on their way into a store (core/uploads.h). For the thread that writes.
class UploadFiles {
 public:
  UploadFiles(const StoreFolder& folder, StoreUse& use, BlobFiles& blobs)
      : folder_(folder), use_(use), blobs_(blobs) {}

  // Each fails as schema/store/flat_file.h says, and for good: what follows of the same upload fails too,
  // with the first reason. kNoSpace also by the store's limit.
  Status Do(const OpenUpload& open);
  Status Do(const WritePiece& piece);
  // Whole: its blob is durable. In any case nothing else is left of it.
  Status Do(const CloseUpload& close);

 private:
  struct File {
    std::optional<FlatFileWriter> writer;  // none: it has failed
    Status status;
  };
  const StoreFolder& folder_;
  StoreUse& use_;
  BlobFiles& blobs_;
  std::map<std::uint64_t, File> files_;  // by the upload's number
};

}  // namespace cairn::coordinator
