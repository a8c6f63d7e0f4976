// Watches a listening socket from a thread of its own: says which keys may connect (ZAP), closes connections
// that are too many, too fast or that pile up what nobody takes, and counts what it turned away. For this
// folder alone.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "schema/wire/allow_list.h"
#include "schema/wire/internal.h"
#include "schema/wire/limits.h"
#include "schema/wire/monitor.h"
#include "schema/wire/poller.h"
#include "schema/wire/refusal.h"

namespace cairn::wire {

// The metadata by which each message says after which handshake it came; the ZAP authenticator's, and no peer
// can say another.
inline constexpr const char* kHandshakeProperty = "X-Cairn-Handshake";

class ZapAuthenticator {
 public:
  // Before `router` is bound. `allow_list`: of a socket that has keys.
  ZapAuthenticator(zmq::context_t& context, zmq::socket_t& router,
                   std::optional<std::filesystem::path> allow_list, const ConnectionLimits& limits);
  ~ZapAuthenticator();
  ZapAuthenticator(const ZapAuthenticator&) = delete;
  ZapAuthenticator& operator=(const ZapAuthenticator&) = delete;

  // Once `router` is bound, to `endpoint`.
  void Start(std::string endpoint);
  // A message of so many bytes and frames was taken that came over this descriptor, after the handshake that
  // kHandshakeProperty numbers, from who has the key `user` (without keys: 0 and empty). Messages outlive
  // their connection: where the descriptor is another's by now, nothing is counted. False where the
  // connection is one too many of its key or of its kind.
  bool TellTaken(int fd, std::uint64_t handshake, const std::string& user, std::size_t bytes,
                 std::size_t frames);
  // Since the last call, by kind.
  std::vector<Refusal> TakeRefusals();
  std::size_t connections() const { return open_count_; }

 private:
  enum class Kind { kNewcomer, kWorker, kSubmitter, kViewer };
  struct Connection {
    std::uint64_t number = 0;  // in the order of what happens: of its handshake it is higher
    std::string address;
    double since_s = 0;
    std::uint64_t taken_bytes = 0;
    Kind kind = Kind::kNewcomer;
    std::string user;  // not of a newcomer
  };
  // Of a key on the list that has shaken hands.
  struct Guest {
    Kind kind = Kind::kViewer;
    std::string name;
    Bucket handshakes;
    std::size_t connections = 0;
    std::size_t most = 0;  // of them, by the list; 0: as many as any such key
  };
  void Loop();
  void TakeEvents();
  void AnswerZap();
  void OnEvent(const Monitor::Event& event);
  void OnDisconnected(int fd);
  void OnAccepted(int fd);
  bool WithinRate(const std::string& address);
  std::size_t MostConnections() const;
  std::string WhyTooMany(const std::string& address);
  std::size_t MostUnread(Kind kind) const;
  void CloseThoseThatPileUp();
  void CloseTheSilent();
  // With mutex_ held.
  void Enter(int fd, const std::string& address);
  void Leave(int fd);
  std::string WhyNoPlace(const std::string& key, const Guest& guest) const;
  std::string NoteHandshake(const std::string& key, const Allowed& allowed);
  void Count(RefusalKind kind, std::string reason);

  const ConnectionLimits limits_;
  std::optional<AllowList> allow_list_;
  std::string endpoint_;
  zmq::socket_t zap_;
  Monitor monitor_;
  bool told_ = false;                      // why the connection that is disconnected next was refused
  std::map<std::string, Bucket> buckets_;  // by address
  std::atomic<std::size_t> open_count_{0};
  std::mutex mutex_;
  std::uint64_t last_number_ = 0;                 // of a connection or a handshake
  std::unordered_map<int, Connection> open_;      // by descriptor; guarded by mutex_, as all that follows
  std::map<std::string, Guest> guests_;           // by key
  std::map<Kind, std::size_t> kinds_;             // connections, in all …
  std::map<std::string, std::size_t> newcomers_;  // … and of newcomers by address
  std::map<RefusalKind, Refusal> refusals_;
  std::atomic<bool> stop_{false};
  Wakeup wakeup_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace cairn::wire
