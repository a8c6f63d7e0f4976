#include "coordinator/core/uploads.h"

#include <algorithm>
#include <utility>

namespace cairn::coordinator {
namespace {

constexpr std::size_t kMostLate = 4096;  // clients of which late pieces are put up with

}  // namespace

Uploads::Upload* Uploads::OfPeer(const std::string& peer) {
  const auto it = by_peer_.find(peer);
  return it == by_peer_.end() ? nullptr : &uploads_.at(it->second);
}

std::size_t Uploads::Open() const {
  return static_cast<std::size_t>(std::ranges::count_if(uploads_, [](const auto& entry) {
    return entry.second.stage == Stage::kOpen || entry.second.stage == Stage::kClosing;
  }));
}

std::uint64_t Uploads::held_bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& [id, upload] : uploads_) bytes += upload.Held();
  return bytes;
}

bool Uploads::Keeps(const Hash& hash) const {
  return std::ranges::any_of(kept_, [&](const auto& kept) { return kept.second.blobs.contains(hash); });
}

bool Uploads::KeepsFor(const std::string& user, const Hash& hash) const {
  return std::ranges::any_of(
      kept_, [&](const auto& kept) { return kept.second.user == user && kept.second.blobs.contains(hash); });
}

std::set<Hash> Uploads::Writing() const {
  std::set<Hash> hashes;
  for (const auto& [id, upload] : uploads_)
    if (upload.stage == Stage::kOpen || upload.stage == Stage::kClosing) hashes.insert(upload.hash);
  return hashes;
}

void Uploads::Answer(const std::string& peer, const Hash& hash, const std::string& refusal, bool again) {
  if (!peer.empty()) actions_.push_back(AnswerOffer{peer, hash, refusal, again});
}

void Uploads::AnswerFailure(const std::string& peer, const Hash& hash, const Status& status) {
  const bool unable = status.code() != Code::kCorrupt;  // what came was another blob
  if (!peer.empty()) actions_.push_back(AnswerOffer{peer, hash, status.message(), false, unable});
}

std::uint64_t Uploads::BytesOf(const std::string& user) const {
  std::uint64_t bytes = 0;
  for (const auto& [id, upload] : uploads_) bytes += upload.user == user ? upload.bytes : 0;
  for (const auto& [peer, kept] : kept_) bytes += kept.user == user ? kept.bytes : 0;
  return bytes;
}

void Uploads::Keep(const std::string& peer, const std::string& user, const Hash& hash, std::uint64_t bytes,
                   double now_s) {
  Kept& kept = kept_[peer];
  kept.user = user;
  if (kept.blobs.insert(hash).second) kept.bytes += bytes;
  kept.heard_s = now_s;
  Answer(peer, hash, "");
}

Uploads::Actions Uploads::Offered(const std::string& peer, const std::string& user, const Hash& hash,
                                  std::uint64_t bytes, double now_s) {
  if (OfPeer(peer) != nullptr) {
    Offend(peer, "an upload was announced before the one before was answered");
    Settle(now_s);
    return TakeActions();
  }
  late_.erase(peer);
  if (bytes == 0) {
    Answer(peer, hash, "an upload of no bytes");
  } else if (has_(user, hash)) {
    Keep(peer, user, hash, bytes, now_s);
  } else if (uploads_.size() >= options_.waiting) {
    AnswerFailure(
        peer, hash,
        {Code::kBusy, std::to_string(uploads_.size()) + " uploads are under way or wait: try again later"});
  } else {
    const std::uint64_t id = next_id_++;
    uploads_[id] = {id, peer, user, hash, bytes, Stage::kWaiting, 0, 0, 0, now_s};
    by_peer_[peer] = id;
    Settle(now_s);
    if (const Upload* upload = OfPeer(peer); upload != nullptr && upload->stage == Stage::kWaiting)
      Tell(*upload, uploads_.size() - 1);
  }
  return TakeActions();
}

Uploads::Actions Uploads::Came(const std::string& peer, wire::Piece&& piece, double now_s) {
  Upload* upload = OfPeer(peer);
  const std::uint64_t bytes = piece.data().size();
  if (upload == nullptr) {
    const auto late = late_.find(peer);
    const bool expected = late != late_.end() && late->second.hash.Binary() == piece.hash();
    if (!expected || bytes > late->second.bytes)
      Offend(peer, "a piece of an upload that was not announced");
    else
      late->second.bytes -= bytes;
    return TakeActions();
  }
  const bool next = upload->stage == Stage::kOpen && piece.hash() == upload->hash.Binary() &&
                    piece.at() == upload->received && bytes > 0;
  if (!next || bytes > upload->granted - upload->received) {
    Offend(peer, next ? "a piece beyond its credit" : "a piece of an upload out of its order");
  } else {
    upload->received += bytes;
    upload->heard_s = now_s;
    actions_.push_back(WritePiece{upload->id, std::move(*piece.mutable_data())});
    if (upload->received == upload->bytes) {
      upload->stage = Stage::kClosing;
      actions_.push_back(CloseUpload{upload->id, upload->hash, true});
    }
  }
  Settle(now_s);
  return TakeActions();
}

// What it sends from now on is thrown away; what it has sent counts until the disk is done with it.
void Uploads::GiveUp(Upload& upload) {
  if (!upload.peer.empty()) {
    by_peer_.erase(upload.peer);
    if (late_.size() >= kMostLate) late_.clear();
    late_[upload.peer] = {upload.hash, upload.granted - upload.received};
    upload.peer.clear();
  }
  if (upload.stage == Stage::kClosing) return;  // Closed follows
  if (upload.stage == Stage::kOpen) actions_.push_back(CloseUpload{upload.id, upload.hash, false});
  upload.stage = Stage::kGivenUp;
  if (upload.Held() == 0) uploads_.erase(upload.id);
}

Uploads::Actions Uploads::Wrote(std::uint64_t id, std::uint64_t bytes, const Status& status, double now_s) {
  const auto it = uploads_.find(id);
  if (it == uploads_.end()) return {};
  Upload& upload = it->second;
  upload.written += bytes;
  if (upload.stage == Stage::kGivenUp) {
    if (upload.Held() == 0) uploads_.erase(it);
  } else if (!status.ok() && upload.stage == Stage::kOpen) {
    AnswerFailure(upload.peer, upload.hash, status);
    GiveUp(upload);
  }
  Settle(now_s);
  return TakeActions();
}

Uploads::Actions Uploads::Closed(std::uint64_t id, const Status& status, double now_s) {
  const auto it = uploads_.find(id);
  if (it == uploads_.end()) return {};
  const Upload upload = it->second;
  const std::string& peer = upload.peer;
  const Hash& hash = upload.hash;
  by_peer_.erase(peer);
  uploads_.erase(it);
  if (!status.ok())
    AnswerFailure(peer, hash, status);
  else if (peer.empty())
    actions_.push_back(ReleaseBlob{hash});
  else
    Keep(peer, upload.user, hash, upload.bytes, now_s);
  Settle(now_s);
  return TakeActions();
}

void Uploads::Release(const std::string& peer) {
  const auto kept = kept_.extract(peer);
  if (kept.empty()) return;
  for (const Hash& hash : kept.mapped().blobs) actions_.push_back(ReleaseBlob{hash});
}

Uploads::Actions Uploads::Lost(const std::string& peer, double now_s) {
  if (Upload* upload = OfPeer(peer); upload != nullptr) GiveUp(*upload);
  late_.erase(peer);
  Release(peer);
  Settle(now_s);
  return TakeActions();
}

void Uploads::Offend(const std::string& peer, const std::string& what) {
  actions_.push_back(DropUploader{peer, {wire::RefusalKind::kBlob, what}});
  if (Upload* upload = OfPeer(peer); upload != nullptr) GiveUp(*upload);
  late_.erase(peer);
  Release(peer);
}

std::vector<Hash> Uploads::Take(const std::string& peer) {
  const auto kept = kept_.extract(peer);
  if (kept.empty()) return {};
  return {kept.mapped().blobs.begin(), kept.mapped().blobs.end()};
}

void Uploads::Settle(double now_s) {
  Begin(now_s);
  Grant(now_s);
}

// One whose blob another brings waits for that, and is answered with it where that is the same user's.
void Uploads::Begin(double now_s) {
  for (auto it = uploads_.begin(); it != uploads_.end();) {
    const Upload& upload = it->second;
    if (upload.stage != Stage::kWaiting || !has_(upload.user, upload.hash)) {
      ++it;
      continue;
    }
    by_peer_.erase(upload.peer);
    Keep(upload.peer, upload.user, upload.hash, upload.bytes, now_s);
    it = uploads_.erase(it);
  }
  for (std::size_t open = Open(); open < options_.places; ++open) {
    Upload* upload = NextToBegin();
    if (upload == nullptr) return;
    upload->stage = Stage::kOpen;
    upload->heard_s = now_s;
    actions_.push_back(OpenUpload{upload->id, upload->hash, upload->bytes});
  }
}

Uploads::Upload* Uploads::NextToBegin() {
  std::map<std::string, std::size_t> places;  // by user
  for (const auto& [id, upload] : uploads_)
    if (upload.stage != Stage::kWaiting) ++places[upload.user];
  const std::set<Hash> writing = Writing();
  Upload* next = nullptr;
  for (auto& [id, upload] : uploads_)
    if (upload.stage == Stage::kWaiting && !writing.contains(upload.hash) &&
        (next == nullptr || places[upload.user] < places[next->user]))
      next = &upload;
  return next;
}

// In turns, beginning behind whoever was given last.
void Uploads::Grant(double now_s) {
  std::vector<Upload*> open;
  for (auto& [id, upload] : uploads_)
    if (upload.stage == Stage::kOpen) open.push_back(&upload);
  if (open.empty()) return;
  std::ranges::rotate(open,
                      std::ranges::find_if(open, [&](const Upload* u) { return u->id > last_granted_; }));
  const std::uint64_t share = std::clamp(options_.total_bytes / open.size(), options_.piece_bytes,
                                         std::max(options_.window_bytes, options_.piece_bytes));
  std::uint64_t left = options_.total_bytes - std::min(options_.total_bytes, held_bytes());
  for (Upload* upload : open) {
    const std::uint64_t missing = upload->bytes - upload->granted;
    const std::uint64_t room = share - std::min(share, upload->Held());
    const std::uint64_t credit = std::min({missing, room, left});
    if (credit == 0 || credit < std::min(missing, options_.piece_bytes)) continue;
    upload->granted += credit;
    upload->heard_s = now_s;
    left -= credit;
    last_granted_ = upload->id;
    TellCredit tell{upload->peer, {}};
    tell.credit.set_hash(upload->hash.Binary());
    tell.credit.set_bytes(credit);
    actions_.push_back(std::move(tell));
  }
}

Uploads::Actions Uploads::Tick(double now_s) {
  std::vector<std::uint64_t> silent;
  for (auto& [id, upload] : uploads_)
    if (upload.stage == Stage::kOpen && upload.granted > upload.received &&
        now_s - upload.heard_s > options_.silent_s)
      silent.push_back(id);
  for (const std::uint64_t id : silent) {
    Upload& upload = uploads_.at(id);
    Answer(upload.peer, upload.hash, "nothing of the upload came for a while: it was given up", true);
    GiveUp(upload);
  }
  std::vector<std::string> idle;
  for (auto& [peer, kept] : kept_) {
    if (OfPeer(peer) != nullptr) kept.heard_s = now_s;
    if (now_s - kept.heard_s > options_.silent_s) idle.push_back(peer);
  }
  for (const std::string& peer : idle) Release(peer);
  if (now_s - told_s_ >= options_.told_s) {
    told_s_ = now_s;
    TellAll();
  }
  Settle(now_s);
  return TakeActions();
}

void Uploads::Tell(const Upload& upload, std::uint64_t ahead) {
  TellCredit tell{upload.peer, {}};
  tell.credit.set_hash(upload.hash.Binary());
  tell.credit.set_ahead(upload.stage == Stage::kWaiting ? ahead : 0);
  actions_.push_back(std::move(tell));
}

// Whoever is gone shows when something is sent there.
void Uploads::TellAll() {
  std::uint64_t ahead = 0;
  for (const auto& [id, upload] : uploads_) {
    if (!upload.peer.empty()) Tell(upload, ahead);
    ++ahead;
  }
  for (const auto& [peer, kept] : kept_)
    if (OfPeer(peer) == nullptr) actions_.push_back(TellCredit{peer, {}});
}

}  // namespace cairn::coordinator
