// To whom blobs are on their way, and how much of them waits to be read: what of it may be in memory has a
// bound.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "coordinator/server/transport.h"

namespace cairn::coordinator {

class OnItsWay {
 public:
  // Nobody takes what others may have. kQuestions: answers without blobs, to whom no blobs are on their way.
  enum class To { kWorkers, kUsers, kAdministrators, kQuestions };

  // `patience_s`: with a peer that takes nothing of what it asked for.
  OnItsWay(const Transport& transport, double patience_s) : transport_(transport), patience_s_(patience_s) {}

  // After something was sent. `what`: of the same there is one copy, however many get it. `user`: whose
  // `peer` is; empty: nobody's.
  void Add(const std::string& peer, To to, const std::string& user, const std::string& what);
  // The same of an answer without blobs, unless blobs are on their way to `peer`.
  void AddAnswer(const std::string& peer, const std::string& user);
  // The same for a worker, which asked for it by `fetch`. `copied`: it is in memory for it alone.
  void AddFetched(const std::string& worker, const std::string& fetch, std::uint64_t bytes, bool copied);
  // Whether the answer to `fetch` is: its worker may have grown impatient.
  bool HasFetched(const std::string& worker, const std::string& fetch);

  // Bytes that are on their way to all of these but `what`, of the same once.
  std::uint64_t Bytes(To to, const std::string& what) const;
  std::uint64_t BytesOf(const std::string& user) const;        // of blobs
  std::uint64_t AnswerBytesOf(const std::string& user) const;  // of answers without
  // Of copies for workers: as Look saw it, and what was added since.
  std::uint64_t copied_bytes() const { return copied_bytes_; }

  // Forgets who has read all. Those who have taken nothing for too long are returned, and forgotten.
  std::vector<std::string> Look(double now_s);

 private:
  struct Peer {
    To to = To::kWorkers;
    std::string user, what;
    struct Answer {
      std::string fetch;
      std::uint64_t bytes = 0;
      bool copied = false;
    };
    std::deque<Answer> answers;  // that are not out yet
    std::uint64_t answers_bytes = 0;
    std::size_t unsent_bytes = 0;
    double idle_s = 0;  // for so long it has taken nothing, while it was looked at
  };
  Peer& PeerOf(const std::string& peer);
  static void ForgetWhatIsOut(Peer& of, std::size_t unsent_bytes);

  const Transport& transport_;
  const double patience_s_;
  double looked_s_ = 0;
  std::map<std::string, Peer> peers_;
  std::uint64_t copied_bytes_ = 0;
};

}  // namespace cairn::coordinator
