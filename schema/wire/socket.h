// The two ends of the transport: a ROUTER that the coordinator binds, a DEALER that workers and clients
// connect. A socket belongs to one thread. Neither blocks: wait with a Poller.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "schema/wire/codec.h"
#include "schema/wire/context.h"
#include "schema/wire/keys.h"
#include "schema/wire/refusal.h"

namespace cairn::wire {

struct SocketOptions {
  Limits limits;
  ConnectionLimits connections;  // Router
  int queue_messages = 1000;     // high-water mark, each way and peer
  int handshake_ms = 5'000;      // a connection that has not shaken hands by then is closed
  // Between TCP's pings, so that a vanished machine is noticed: after three. Dealer: between ZMTP's, too.
  int keepalive_ms = 5'000;
  int linger_ms = 1'000;   // how long a closed socket may still send
  int reconnect_ms = 100;  // Dealer: first pause, doubled up to reconnect_max_ms
  int reconnect_max_ms = 2'000;
};

struct ServerSecurity {
  KeyPair keys;
  std::filesystem::path allow_list;  // allow_list.h; read again whenever it changes
};
struct ClientSecurity {
  KeyPair keys;
  std::string server_public_key;
};

// A message that came in, or, where `status` is not ok, the reason why one was refused (kCorrupt, kRefused:
// its sender's connection is dropped by then, and whatever else it had sent is thrown away; kVersion: it may
// be told).
struct Received {
  std::string peer;     // Router: which connection it came through; opaque, and the sender may have chosen it
  std::string user_id;  // Router with keys: the sender's public key
  Status status;
  Message message;
};

// Of whole messages, without what the transport and its encryption add.
struct Traffic {
  std::uint64_t bytes_in = 0, bytes_out = 0;
};

class RouterSocket {
 public:
  // kRefused by CheckEndpoint; kBusy: the address is in use; what ReadAllowList says. A context holds at most
  // one that has keys.
  static Result<RouterSocket> Bind(Context& context, const std::string& endpoint,
                                   const std::optional<ServerSecurity>& security = {},
                                   const SocketOptions& = {});
  RouterSocket(RouterSocket&&) noexcept;
  RouterSocket& operator=(RouterSocket&&) noexcept;
  ~RouterSocket();

  const std::string& endpoint() const;  // as bound: tcp://…:* with the port that was chosen
  std::optional<Received> TryReceive();
  // kNotFound: the peer is gone, or was dropped. kBusy: its queue is full, or it has not read what was sent
  // before.
  Status Send(const std::string& peer, Message message);
  // Bytes of messages that wait to go out to it, but for small ones, and then those on their way: over a slow
  // link it falls while a frame goes, too.
  std::size_t Unsent(const std::string& peer) const;
  // Closes a peer's connection; what it had sent, and still sends, is thrown away.
  void Drop(const std::string& peer);
  // What was turned away at the door since the last call, by kind. Messages are refused by TryReceive.
  std::vector<Refusal> TakeRefusals();
  std::size_t connections() const;
  Traffic traffic() const;  // since it was bound

  struct Impl;

 private:
  friend class Poller;
  explicit RouterSocket(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

enum class LinkEvent {
  kConnected,     // shaken hands: say Hello
  kDisconnected,  // what was queued to go out is lost; reconnects by itself
  kKeyRefused,    // the service does not know this key; does not try again until Reconnect()
  // With keys: the connection broke before it was secured. The service may be ending, starting or crowded, or
  // have another key than the one that was given; tries again by itself, later and later.
  kHandshakeFailed,
};

class DealerSocket {
 public:
  static Result<DealerSocket> Connect(const Context& context, const std::string& endpoint,
                                      const std::optional<ClientSecurity>& security = {},
                                      const SocketOptions& = {});
  DealerSocket(DealerSocket&&) noexcept;
  DealerSocket& operator=(DealerSocket&&) noexcept;
  ~DealerSocket();

  // Ask this first: an event tells which connection the messages that follow belong to. Ask it again and
  // again: a connection through which nothing came for three keepalive_ms, by its calls, is left here.
  std::optional<LinkEvent> TryEvent();
  // Over the connection that stands, those of messages that are not whole yet too.
  std::uint64_t BytesCame() const;
  std::optional<Received> TryReceive();
  // kBusy: not connected by the events that were taken (a message is never kept for a later connection), or
  // the queue is full.
  Status Send(Message message);
  // Closes the connection and opens a new one. kDisconnected is not reported. Done after a malformed message.
  Status Reconnect();

  struct Impl;

 private:
  friend class Poller;
  explicit DealerSocket(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace cairn::wire
