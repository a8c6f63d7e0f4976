#include "worker/zmq_transport.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cairn::worker {
namespace {

// At most this many messages a call, so that heartbeats go out whatever comes in.
constexpr int kMessagesAtOnce = 256;
// And of messages with blobs no more than make so many bytes, or one that is larger: the others wait where
// the socket limits them.
constexpr std::size_t kBytesAtOnce = std::size_t{64} << 20;
constexpr double kLongestPoll_s = 60;

std::size_t BytesIn(const wire::Message& message) {
  std::size_t bytes = 0;
  for (const wire::NamedBlob& named : message.blobs)
    for (const auto& [name, array] : named.blob->fields()) bytes += array.bytes().size();
  return bytes;
}

Event::Kind KindOf(wire::LinkEvent event) {
  switch (event) {
    case wire::LinkEvent::kConnected:
      return Event::kConnected;
    case wire::LinkEvent::kDisconnected:
      return Event::kDisconnected;
    case wire::LinkEvent::kHandshakeFailed:
      return Event::kHandshakeFailed;
    default:
      return Event::kKeyRefused;
  }
}

}  // namespace

Result<std::unique_ptr<ZmqTransport>> ZmqTransport::Connect(
    const std::string& endpoint, const std::optional<wire::ClientSecurity>& security) {
  const wire::Context context;
  Result<wire::DealerSocket> socket = wire::DealerSocket::Connect(context, endpoint, security);
  if (!socket.ok()) return socket.status();
  return std::unique_ptr<ZmqTransport>(new ZmqTransport(std::move(socket).value()));
}

std::vector<Event> ZmqTransport::Poll(double timeout_s) {
  const double wait_s = timeout_s > 0 ? std::min(timeout_s, kLongestPoll_s) : 0;  // NaN: 0
  poller_.Wait(std::chrono::milliseconds(static_cast<long>(std::ceil(wait_s * 1000))));
  std::vector<Event> events;
  while (const std::optional<wire::LinkEvent> event = socket_.TryEvent()) {
    events.push_back({.kind = KindOf(*event), .message = {}, .text = {}});
  }
  std::size_t bytes = 0;
  for (int i = 0; i < kMessagesAtOnce && bytes < kBytesAtOnce; ++i) {
    std::optional<wire::Received> received = socket_.TryReceive();
    if (!received) break;
    const bool ok = received->status.ok();
    bytes += BytesIn(received->message);
    events.push_back({.kind = ok ? Event::kMessage : Event::kMalformed,
                      .message = std::move(received->message),
                      .text = received->status.message()});
    if (!ok) break;  // what follows belongs to the next connection
  }
  return events;
}

bool ZmqTransport::Send(const wire::Message& message) { return socket_.Send(message).ok(); }

}  // namespace cairn::worker
