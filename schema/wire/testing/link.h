// For tests of the sockets: a router and a dealer that are connected, what they say, and how it is waited
// for.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <zmq.hpp>

#include "schema/wire/poller.h"
#include "schema/wire/socket.h"
#include "schema/wire/testing/private_folder.h"

namespace cairn::wire {

inline constexpr std::chrono::seconds kPatience{300};  // far more than anything here takes

inline SocketOptions Quick() {
  SocketOptions options;
  options.reconnect_ms = 1;
  options.reconnect_max_ms = 10;
  options.linger_ms = 100;
  return options;
}

// Waits until `take` gives something.
template <class Socket, class Take>
auto Await(Socket& socket, const Take& take) -> decltype(take()) {
  Poller poller;
  poller.Add(socket);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < end) {
    if (auto got = take()) return got;
    poller.Wait(std::chrono::milliseconds(50));
  }
  return {};
}

inline std::optional<Received> AwaitMessage(RouterSocket& s) {
  return Await(s, [&] { return s.TryReceive(); });
}
inline std::optional<Received> AwaitMessage(DealerSocket& s) {
  return Await(s, [&] { return s.TryReceive(); });
}
inline std::optional<LinkEvent> AwaitEvent(DealerSocket& s) {
  return Await(s, [&] { return s.TryEvent(); });
}

inline Message HelloMessage(const std::string& host) {
  Message message;
  message.envelope.mutable_hello()->set_protocol(kProtocol);
  message.envelope.mutable_hello()->set_host(host);
  return message;
}

inline Message BlobMessage(std::size_t doubles) {
  Blob blob;
  blob.PutVector<double>("values", std::vector<double>(doubles, 0.5));
  Message message;
  message.envelope.mutable_blob();
  message.blobs = {NameBlob(std::make_shared<const Blob>(std::move(blob)))};
  return message;
}

struct Link {
  PrivateFolder folder;
  Context context;
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, Quick()).value();
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
};

// A peer that speaks ZeroMQ but not Cairn.
inline void SendRaw(zmq::socket_t& socket, const std::vector<std::string>& frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    socket.send(zmq::buffer(frames[i]),
                i + 1 < frames.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
  }
}

}  // namespace cairn::wire
