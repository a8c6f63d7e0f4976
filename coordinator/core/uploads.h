// Inputs on their way from clients into the store: who may send how much when, so that what is in memory of
// all of them together stays within a bound, whatever their number and size. A pure state machine as the core
// is one: what came, what the disk did and the time go in, actions come out.
//
// A client announces one upload at a time. It waits until it has a place, then sends no more than it has
// credit for; credit comes back as its pieces reach the disk, and those that have a place share all that
// there is equally. A place goes to the user (the key) who has the fewest, of whose uploads to the first that
// came: who opens many connections waits for himself. What has come whole is kept for its client until that
// hands in its job, or goes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "schema/error.h"
#include "schema/hash.h"
#include "schema/wire.pb.h"
#include "schema/wire/refusal.h"

namespace cairn::coordinator {

struct UploadOptions {
  std::uint64_t piece_bytes = 1 << 20;   // clients send no less at a time, but at the end
  std::uint64_t window_bytes = 8 << 20;  // on its way from one client
  std::uint64_t total_bytes = 32 << 20;  // from all: not yet sent, in memory, or not yet on disk
  std::size_t places = 16;               // uploads that are served at a time, each with an open file
  std::size_t waiting = 1024;
  double silent_s = 30;  // a client that could send and does not has gone
  double told_s = 2;     // clients that wait hear at least so often that they are not forgotten
};

// ---- actions ----
struct OpenUpload {
  std::uint64_t id = 0;
  Hash hash;
  std::uint64_t bytes = 0;
};
struct WritePiece {
  std::uint64_t id = 0;
  std::string data;
};
// Whole: check, sync and publish it; else nothing of it stays. No more comes of this upload.
struct CloseUpload {
  std::uint64_t id = 0;
  Hash hash;
  bool whole = false;
};
struct TellCredit {
  std::string peer;
  wire::Credit credit;
};
struct AnswerOffer {
  std::string peer;
  Hash hash;
  std::string refusal;  // empty: the blob is durable
  bool again = false;   // of a refusal: it may be offered once more
  bool unable = false;  // of a refusal: for what the service lacks, not for what was offered
};
// A blob that was kept for a client is not any more: where nobody else needs it, it goes.
struct ReleaseBlob {
  Hash hash;
};
// It does not keep to what it was allowed: its connection goes.
struct DropUploader {
  std::string peer;
  wire::Refusal refusal;
};
using UploadAction =
    std::variant<OpenUpload, WritePiece, CloseUpload, TellCredit, AnswerOffer, ReleaseBlob, DropUploader>;

class Uploads {
 public:
  using Actions = std::vector<UploadAction>;
  // `has`: whether the store has a blob already of which this user need show no bytes any more. It is asked
  // before a client is let begin.
  using Has = std::function<bool(const std::string& user, const Hash& hash)>;
  Uploads(const UploadOptions& options, Has has) : options_(options), has_(std::move(has)) {}

  // `user`: whose client it is; empty where there are no keys.
  Actions Offered(const std::string& peer, const std::string& user, const Hash& hash, std::uint64_t bytes,
                  double now_s);
  Actions Came(const std::string& peer, wire::Piece&& piece, double now_s);
  // What the disk did: each OpenUpload that fails and each WritePiece in its turn, then a CloseUpload that
  // was whole.
  Actions Wrote(std::uint64_t id, std::uint64_t bytes, const Status& status, double now_s);
  Actions Closed(std::uint64_t id, const Status& status, double now_s);
  // The client's connection is gone.
  Actions Lost(const std::string& peer, double now_s);
  Actions Tick(double now_s);

  // What this client has brought: from now on that is its job's.
  std::vector<Hash> Take(const std::string& peer);
  bool Keeps(const Hash& hash) const;  // for a client
  bool KeepsFor(const std::string& user, const Hash& hash) const;
  // Of this user's: on their way, waiting, or brought and not yet a job's.
  std::uint64_t BytesOf(const std::string& user) const;
  std::set<Hash> Writing() const;    // blobs of which a file is being made
  std::uint64_t held_bytes() const;  // never more than total_bytes
  std::size_t size() const { return uploads_.size(); }
  std::size_t kept() const { return kept_.size(); }

 private:
  enum class Stage { kWaiting, kOpen, kClosing, kGivenUp };
  struct Upload {
    std::uint64_t id = 0;
    std::string peer;  // empty: nobody waits for it any more
    std::string user;
    Hash hash;
    std::uint64_t bytes = 0;
    Stage stage = Stage::kWaiting;
    std::uint64_t granted = 0, received = 0, written = 0;
    double heard_s = 0;
    // What it holds: of one that was given up, what has come alone.
    std::uint64_t Held() const { return (stage == Stage::kGivenUp ? received : granted) - written; }
  };
  struct Kept {
    std::set<Hash> blobs;
    double heard_s = 0;
    std::string user = {};
    std::uint64_t bytes = 0;
  };
  // Pieces of an upload that was given up, which its client could not know when it sent them.
  struct Late {
    Hash hash;
    std::uint64_t bytes = 0;
  };
  using UploadMap = std::map<std::uint64_t, Upload>;  // by id: in the order in which they came

  Upload* OfPeer(const std::string& peer);
  std::size_t Open() const;
  void Answer(const std::string& peer, const Hash& hash, const std::string& refusal, bool again = false);
  void AnswerFailure(const std::string& peer, const Hash& hash, const Status& status);
  void Keep(const std::string& peer, const std::string& user, const Hash& hash, std::uint64_t bytes,
            double now_s);
  void GiveUp(Upload& upload);
  void Offend(const std::string& peer, const std::string& what);
  void Release(const std::string& peer);
  void Settle(double now_s);  // whoever waits and may begin does, and gets credit
  void Begin(double now_s);
  Upload* NextToBegin();  // null: nobody waits who may
  void Grant(double now_s);
  void Tell(const Upload& upload, std::uint64_t ahead);
  void TellAll();
  Actions TakeActions() { return std::exchange(actions_, {}); }

  const UploadOptions options_;
  const Has has_;
  UploadMap uploads_;
  std::map<std::string, std::uint64_t> by_peer_;
  std::map<std::string, Kept> kept_;
  std::map<std::string, Late> late_;
  std::uint64_t next_id_ = 1;
  std::uint64_t last_granted_ = 0;  // id
  double told_s_ = 0;
  Actions actions_;
};

}  // namespace cairn::coordinator
