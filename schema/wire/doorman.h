// Watches a listening socket from a thread of its own: says which keys may connect (ZAP), closes connections
// that are too many, too fast or that pile up what nobody takes, and counts what it turned away. For this
// folder alone.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "schema/wire/allow_list.h"
#include "schema/wire/internal.h"
#include "schema/wire/limits.h"
#include "schema/wire/monitor.h"
#include "schema/wire/poller.h"
#include "schema/wire/refusal.h"

namespace cairn::wire {

// So many at once, then so many a second.
class Bucket {
 public:
  Bucket(double per_s, double burst) : per_s_(per_s), burst_(burst), left_(burst) {}
  bool Take(double now_s);
  bool Full(double now_s) const { return left_ + (now_s - then_s_) * per_s_ >= burst_; }

 private:
  double per_s_, burst_, left_;
  double then_s_ = 0;
};

class Doorman {
 public:
  // Before `router` is bound. `allow_list`: of a socket that has keys.
  Doorman(zmq::context_t& context, zmq::socket_t& router, std::optional<std::filesystem::path> allow_list,
          const ConnectionLimits& limits);
  ~Doorman();
  Doorman(const Doorman&) = delete;
  Doorman& operator=(const Doorman&) = delete;

  // Once `router` is bound, to `endpoint`.
  void Start(std::string endpoint);
  // A message of so many bytes and frames was taken from this connection.
  void TellTaken(int fd, std::size_t bytes, std::size_t frames);
  // Since the last call, by kind.
  std::vector<Refusal> TakeRefusals();
  std::size_t connections() const { return open_count_; }

 private:
  struct Connection {
    std::string address;
    std::uint64_t taken_bytes = 0;
  };
  void Loop();
  void AnswerZap();
  void OnEvent(const Monitor::Event& event);
  void OnAccepted(int fd);
  bool WithinRate(const std::string& address);
  std::size_t MostConnections() const;
  void CloseThoseThatPileUp();
  void Count(RefusalKind kind, std::string reason);

  const ConnectionLimits limits_;
  std::optional<AllowList> allow_list_;
  std::string endpoint_;
  zmq::socket_t zap_;
  Monitor monitor_;
  std::map<std::string, Bucket> buckets_;  // by address
  std::atomic<std::size_t> open_count_{0};
  std::mutex mutex_;
  std::map<int, Connection> open_;           // by descriptor; guarded by mutex_
  std::map<RefusalKind, Refusal> refusals_;  // guarded by mutex_
  std::atomic<bool> stop_{false};
  Wakeup wakeup_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace cairn::wire
