#include <algorithm>
#include <cstring>
#include <utility>

#include "schema/wire/endpoint.h"
#include "schema/wire/socket_impl.h"

namespace cairn::wire {
namespace {

constexpr int kWatched = ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_DISCONNECTED |
                         ZMQ_EVENT_HANDSHAKE_FAILED_AUTH | ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL |
                         ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL;

// A connection that is lost before its handshake is over fails without detail. Where there are no keys nobody
// can have refused one, and the socket connects again by itself.
LinkEvent Translate(int event, bool with_keys) {
  if (event == ZMQ_EVENT_HANDSHAKE_SUCCEEDED) return LinkEvent::kConnected;
  return event == ZMQ_EVENT_DISCONNECTED || !with_keys ? LinkEvent::kDisconnected : LinkEvent::kKeyRefused;
}

void OpenMonitor(zmq::context_t& context, zmq::socket_t& socket, zmq::socket_t& monitor) {
  const std::string address =
      "inproc://monitor-" + std::to_string(reinterpret_cast<std::uintptr_t>(socket.handle()));
  if (zmq_socket_monitor(socket.handle(), address.c_str(), kWatched) != 0) throw zmq::error_t();
  monitor = zmq::socket_t(context, zmq::socket_type::pair);
  monitor.set(zmq::sockopt::linger, 0);
  monitor.connect(address);
}

}  // namespace

Status DealerSocket::Impl::Open() {
  try {
    socket = zmq::socket_t(context->zmq, zmq::socket_type::dealer);
    SetCommonOptions(socket, options);
    // Only a connection that stands gets messages: none waits in a queue to reach the coordinator before
    // Hello does.
    socket.set(zmq::sockopt::immediate, true);
    socket.set(zmq::sockopt::ipv6, true);
    socket.set(zmq::sockopt::reconnect_ivl, options.reconnect_ms);
    socket.set(zmq::sockopt::reconnect_ivl_max, options.reconnect_max_ms);
    if (security) {
      socket.set(zmq::sockopt::curve_serverkey, security->server_public_key);
      socket.set(zmq::sockopt::curve_publickey, security->keys.public_key);
      socket.set(zmq::sockopt::curve_secretkey, security->keys.secret_key);
    }
    OpenMonitor(context->zmq, socket, monitor);
    socket.connect(endpoint);
  } catch (const zmq::error_t& error) {
    return ZmqStatus(endpoint, error);
  }
  return Status::Ok();
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

std::optional<LinkEvent> DealerSocket::TryEvent() {
  // Frame one: event (16 bits) and value; frame two: address. None of ours, so no limits apply.
  const std::vector<zmq::message_t> frames = ReceiveFrames(impl_->monitor, {});
  if (frames.empty()) return std::nullopt;
  std::uint16_t event = 0;
  std::memcpy(&event, frames[0].data(), sizeof event);
  return Translate(event, impl_->security.has_value());
}

std::optional<Received> DealerSocket::TryReceive() {
  const std::vector<zmq::message_t> frames = ReceiveFrames(impl_->socket, impl_->options.limits);
  if (frames.empty()) return std::nullopt;
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
  // Asking for the events makes ZeroMQ take note of a connection that was made or lost since the last call.
  if ((impl_->socket.get(zmq::sockopt::events) & ZMQ_POLLOUT) == 0) {
    return {Code::kBusy, "not connected, or the queue is full"};
  }
  return SendFrames(impl_->socket, nullptr, Encode(std::move(message)));
}

Status DealerSocket::Reconnect() { return impl_->Open(); }

}  // namespace cairn::wire
