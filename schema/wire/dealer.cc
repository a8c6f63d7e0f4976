#include <algorithm>
#include <utility>

#include "schema/wire/endpoint.h"
#include "schema/wire/socket_impl.h"
#include "schema/wire/system_calls.h"

namespace cairn::wire {
namespace {

constexpr int kConnectionEvents = ZMQ_EVENT_CONNECTED | ZMQ_EVENT_HANDSHAKE_SUCCEEDED |
                                  ZMQ_EVENT_DISCONNECTED | ZMQ_EVENT_HANDSHAKE_FAILED_AUTH |
                                  ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL | ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL;

// At least what CURVE and ZMTP add to a frame.
constexpr std::size_t kAddedToAFrame = 64;

// What may wait to be taken: the largest message that may come, and a little more.
std::uint64_t MostUnread(const Limits& limits) {
  constexpr std::uint64_t kLittle = 1 << 20;
  return std::max(limits.envelope_bytes, limits.message_bytes) + limits.frames * kAddedToAFrame + kLittle;
}

// What the ZAP handler of a service says of a key that it does not know (rfc.zeromq.org/spec/27).
constexpr std::uint32_t kZapRefused = 400;

// Only the service's own word is a refusal: a connection that is lost before its handshake is over, or
// through which something else comes, fails too.
LinkEvent Translate(int event, std::uint32_t value, bool with_keys) {
  if (event == ZMQ_EVENT_HANDSHAKE_SUCCEEDED) return LinkEvent::kConnected;
  if (event == ZMQ_EVENT_DISCONNECTED || !with_keys) return LinkEvent::kDisconnected;
  return event == ZMQ_EVENT_HANDSHAKE_FAILED_AUTH && value == kZapRefused ? LinkEvent::kKeyRefused
                                                                          : LinkEvent::kHandshakeFailed;
}

}  // namespace

Status DealerSocket::Impl::Open() {
  again_at.reset();
  connected = told = false;
  descriptor = -1;
  monitor.reset();
  try {
    socket = zmq::socket_t(context->zmq, zmq::socket_type::dealer);
    SetCommonOptions(socket, options);
    // As of the ROUTER's, no queue is full by the number of its messages; their bytes are limited.
    socket.set(zmq::sockopt::rcvhwm, 0);
    LimitUnread(MostUnread(options.limits));
    // Only a connection that stands gets messages: none waits in a queue to reach the coordinator before
    // Hello does.
    socket.set(zmq::sockopt::immediate, true);
    socket.set(zmq::sockopt::ipv6, true);
    // Behind what acknowledges bytes and passes nothing on TCP notices nothing. The ROUTER answers these
    // pings; its own it must not send (RouterSocket::Bind). An answer waits behind the frames that are due
    // before it, and over a slow link a single one takes longer than any patience. ZeroMQ would count whole
    // frames; here every byte is a sign of life (IsSilent).
    socket.set(zmq::sockopt::heartbeat_ivl, options.keepalive_ms);
    socket.set(zmq::sockopt::heartbeat_timeout, 0);
    socket.set(zmq::sockopt::reconnect_ivl, options.reconnect_ms);
    socket.set(zmq::sockopt::reconnect_ivl_max, options.reconnect_max_ms);
    if (security) {
      socket.set(zmq::sockopt::curve_serverkey, security->server_public_key);
      socket.set(zmq::sockopt::curve_publickey, security->keys.public_key);
      socket.set(zmq::sockopt::curve_secretkey, security->keys.secret_key);
    }
    monitor.emplace(context->zmq, socket, kConnectionEvents);
    socket.connect(endpoint);
  } catch (const zmq::error_t& error) {
    return ZmqStatus(endpoint, error);
  }
  return Status::Ok();
}

// By itself ZeroMQ would try again at once where a connection was lost, and never where something else
// answered.
void DealerSocket::Impl::TryLater() {
  zmq_disconnect(socket.handle(), endpoint.c_str());  // fails where ZeroMQ has given up
  pause = std::clamp(2 * pause, std::chrono::milliseconds(options.reconnect_ms),
                     std::chrono::milliseconds(options.reconnect_max_ms));
  again_at = std::chrono::steady_clock::now() + pause;
}

void DealerSocket::Impl::TryAgainIfDue() {
  if (!again_at || std::chrono::steady_clock::now() < *again_at) return;
  again_at.reset();
  told = false;
  if (zmq_connect(socket.handle(), endpoint.c_str()) != 0) TryLater();  // a name that nobody knows just now
}

Result<DealerSocket> DealerSocket::Connect(const Context& context, const std::string& endpoint,
                                           const std::optional<ClientSecurity>& security,
                                           const SocketOptions& options) {
  if (Status s = CheckEndpoint(endpoint, security.has_value()); !s.ok()) return s;
  auto impl = std::make_unique<Impl>();
  impl->context = context.impl();
  impl->options = options;
  impl->endpoint = endpoint;
  impl->security = security;
  if (Status s = impl->Open(); !s.ok()) return s;
  return DealerSocket(std::move(impl));
}

DealerSocket::DealerSocket(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
DealerSocket::DealerSocket(DealerSocket&&) noexcept = default;
DealerSocket& DealerSocket::operator=(DealerSocket&&) noexcept = default;
DealerSocket::~DealerSocket() = default;

std::optional<LinkEvent> DealerSocket::Impl::NextEvent() {
  const std::optional<Monitor::Event> event = monitor ? monitor->Next() : std::nullopt;
  if (!event) return std::nullopt;
  if (event->kind == ZMQ_EVENT_CONNECTED) {
    descriptor = static_cast<int>(event->value);
    return NextEvent();
  }
  return Translate(event->kind, event->value, security.has_value());
}

// By looks, of which each counts little: this process may have been stopped, and what came waits to be read.
bool DealerSocket::Impl::IsSilent() {
  const std::chrono::milliseconds between(options.keepalive_ms);
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_at < between / 4) return false;  // events are asked for with each message
  const auto since = std::min<std::chrono::steady_clock::duration>(now - looked_at, between);
  looked_at = now;
  const std::uint64_t came = wire::BytesCame(descriptor);
  silent = std::exchange(came_bytes, came) == came ? silent + since : std::chrono::steady_clock::duration(0);
  constexpr int kPings = 3;
  return silent > kPings * between;
}

std::optional<LinkEvent> DealerSocket::TryEvent() {
  impl_->TryAgainIfDue();
  while (const std::optional<LinkEvent> event = impl_->NextEvent()) {
    // Of a handshake that failed ZeroMQ tells twice: why, and that the connection is gone; of an answer that
    // is no ZMTP the latter alone.
    const bool gone = *event == LinkEvent::kDisconnected && impl_->security;
    if (gone && std::exchange(impl_->told, false)) continue;
    const bool failed = *event == LinkEvent::kHandshakeFailed || (gone && !impl_->connected);
    impl_->connected = *event == LinkEvent::kConnected;
    impl_->told = *event == LinkEvent::kHandshakeFailed || *event == LinkEvent::kKeyRefused;
    if (impl_->connected) {
      impl_->pause = {};
      impl_->silent = {};
    }
    if (!failed) return event;
    impl_->TryLater();
    return LinkEvent::kHandshakeFailed;
  }
  if (!impl_->connected || !impl_->IsSilent()) return std::nullopt;
  static_cast<void>(Reconnect());  // fails where the process has no descriptors left
  return LinkEvent::kDisconnected;
}

std::uint64_t DealerSocket::BytesCame() const { return wire::BytesCame(impl_->descriptor); }

std::optional<Received> DealerSocket::TryReceive() {
  std::vector<zmq::message_t> frames = ReceiveFrames(impl_->socket, impl_->options.limits);
  if (frames.empty()) return std::nullopt;
  std::uint64_t bytes = 0;
  for (const zmq::message_t& frame : frames) bytes += frame.size() + kAddedToAFrame;
  NoteTaken(zmq_msg_get(frames.back().handle(), ZMQ_SRCFD), bytes);
  Received received;
  Result<Message> message = DecodeFrames(frames, impl_->options.limits);
  if (message.ok()) {
    received.message = std::move(message).value();
  } else {
    received.status = message.status();
    if (Status s = Reconnect(); !s.ok()) received.status = s;
  }
  return received;
}

Status DealerSocket::Send(Message message) {
  // Between the event that tells of a lost connection and its end, ZeroMQ still takes messages for it.
  // Asking for the events makes ZeroMQ take note of a connection that was made or lost since the last call.
  if (!impl_->connected || (impl_->socket.get(zmq::sockopt::events) & ZMQ_POLLOUT) == 0) {
    return {Code::kBusy, "not connected, or the queue is full"};
  }
  return SendFrames(impl_->socket, nullptr, Encode(std::move(message)));
}

Status DealerSocket::Reconnect() { return impl_->Open(); }

}  // namespace cairn::wire
