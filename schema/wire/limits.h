// Every limit on what a peer may send or ask, in one place; docs/threat-model.md says what each is against.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace cairn::wire {

// On one message. What is over is refused, and its sender's connection dropped.
struct Limits {
  std::size_t envelope_bytes = std::size_t{64} << 20;
  std::size_t parsed_bytes = std::size_t{512}
                             << 20;  // an envelope takes in memory: Done; others an eighth of it
  std::size_t message_bytes = std::size_t{4} << 30;  // all frames of a message together, and any one of them
  std::size_t frames = std::size_t{1} << 16;         // of a message
};

// On what knocks at a listening socket.
struct ConnectionLimits {
  std::size_t connections = 4096;  // at a time; fewer where the process may not open so many files
  double handshakes_per_s = 100;   // from one address …
  double handshake_burst = 1000;   // … beyond so many at once
  int first_word_ms = 10'000;      // with keys: whoever has said nothing by then is turned away
  std::size_t first_word_bytes = std::size_t{4} << 20;  // with keys: nothing longer is a first word
  std::size_t client_bytes = std::size_t{64} << 20;     // with keys: unread of who is no worker
  std::size_t spare_files = 128;                        // descriptors that are kept for everything else
  std::size_t unread_bytes = std::size_t{8} << 30;  // that came over one connection and were not taken yet
  std::size_t unsent_bytes = std::size_t{1} << 30;  // that wait to go out over one connection, or one message
};

// Of so many connections to a socket with keys, how many may be of whom: nobody takes the places of others.
// Of many the most are workers': people and newcomers do not grow in number as a fleet does.
struct Places {
  static constexpr std::size_t kFew = 4, kManyPeople = 512, kManyNewcomers = 4096;
  explicit Places(std::size_t all)
      : submitters(std::clamp(all / 8, kFew, kManyPeople)),
        viewers(submitters),
        newcomers(std::clamp(all / 4, kFew, kManyNewcomers)),
        workers(std::max(all / 2, all - std::min(all, submitters + viewers + newcomers))),
        of_a_workers_key(std::max(kFew, 3 * workers / 4)),
        of_another_key(std::max(kFew, submitters / 4)),
        of_an_address(std::max(kFew, newcomers / 4)) {}

  std::size_t submitters, viewers;
  std::size_t newcomers;  // that have said nothing yet
  std::size_t workers;
  std::size_t of_a_workers_key, of_another_key;
  std::size_t of_an_address;  // newcomers
};

// So many at once, then so many a second.
class Bucket {
 public:
  Bucket(double per_s, double burst) : per_s_(per_s), burst_(burst), left_(burst) {}
  bool Take(double now_s) {
    left_ = std::min(burst_, left_ + (now_s - then_s_) * per_s_);
    then_s_ = now_s;
    if (left_ < 1) return false;
    left_ -= 1;
    return true;
  }
  // From now until one may be taken, s.
  double Wait(double now_s) const {
    const double lacks = 1 - std::min(burst_, left_ + (now_s - then_s_) * per_s_);
    return lacks <= 0 ? 0 : lacks / per_s_;
  }
  bool Full(double now_s) const { return left_ + (now_s - then_s_) * per_s_ >= burst_; }

 private:
  double per_s_, burst_, left_;
  double then_s_ = 0;
};

// On a job, and on what a worker says of itself and of its tasks.
struct JobLimits {
  std::size_t job_bytes = 1 << 20;  // of a submission, without its blobs
  int stages = 100;
  int values = 4096;              // its inputs and options, of all stages together
  int hashes = 1 << 16;           // of blobs that a client asks for at once: more than a submission can name
  std::size_t text_bytes = 4096;  // of a name, a reason, a note
  std::uint32_t slots = 1000;     // of a worker
};

}  // namespace cairn::wire
