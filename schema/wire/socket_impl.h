// The insides of the two sockets, for socket.cc's halves and the poller.
#pragma once

#include <chrono>
#include <deque>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <unordered_map>

#include "schema/wire/internal.h"
#include "schema/wire/monitor.h"
#include "schema/wire/socket.h"
#include "schema/wire/zap_authenticator.h"

namespace cairn::wire {

struct RouterSocket::Impl {
  std::shared_ptr<Context::Impl> context;  // first, so that it goes last
  SocketOptions options;
  zmq::socket_t socket;
  std::string endpoint;
  Traffic traffic;
  std::set<std::string> dropped;       // peers whose messages are thrown away …
  std::deque<std::string> drop_order;  // … of which only the latest are remembered
  struct Peer {
    int descriptor = -1;  // as its last message had it
    UnsentBytes unsent;
  };
  std::unordered_map<std::string, Peer> peers;
  std::unique_ptr<ZapAuthenticator> authenticator;  // goes before the socket that it watches
  bool has_keys = false;                            // only then ZeroMQ says who sent a message

  Received Receive(std::string peer, std::string user, std::span<zmq::message_t> frames);
  Peer& PeerOf(const std::string& peer);
  void Drop(const std::string& peer);
  void ShutDown(const std::string& peer, int fd);
};

struct DealerSocket::Impl {
  std::shared_ptr<Context::Impl> context;
  SocketOptions options;
  std::string endpoint;
  std::optional<ClientSecurity> security;
  zmq::socket_t socket;
  std::optional<Monitor> monitor;  // goes before the socket that it watches
  // After a handshake that failed: when the next is tried, and how long it was put off.
  std::optional<std::chrono::steady_clock::time_point> again_at;
  std::chrono::milliseconds pause{0};

  bool connected = false;
  bool told = false;    // how the last handshake failed
  int descriptor = -1;  // of the connection that was made last
  // What had come by the last look at it, when that was, and for how long nothing has.
  std::uint64_t came_bytes = 0;
  std::chrono::steady_clock::time_point looked_at;
  std::chrono::steady_clock::duration silent{0};

  Status Open();
  std::optional<LinkEvent> NextEvent();
  void TryLater();
  void TryAgainIfDue();
  bool IsSilent();
};

void SetCommonOptions(zmq::socket_t& socket, const SocketOptions& options);

}  // namespace cairn::wire
