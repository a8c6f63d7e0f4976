#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <utility>

#include "schema/wire/endpoint.h"
#include "schema/wire/socket_impl.h"

namespace cairn::wire {
namespace {

constexpr std::size_t kDroppedPeersKept = 4096;

// The address that a descriptor is bound to, as endpoints write it; empty where it is not a connected stream
// socket.
std::string LocalEndpoint(int fd) {
  sockaddr_storage local{};
  sockaddr_storage remote{};
  socklen_t local_size = sizeof local;
  socklen_t remote_size = sizeof remote;
  if (::getsockname(fd, reinterpret_cast<sockaddr*>(&local), &local_size) != 0 ||
      ::getpeername(fd, reinterpret_cast<sockaddr*>(&remote), &remote_size) != 0) {
    return "";
  }
  switch (local.ss_family) {
    case AF_UNIX:
      return std::string("ipc://") + reinterpret_cast<const sockaddr_un&>(local).sun_path;
    case AF_INET:
      return "tcp::" + std::to_string(ntohs(reinterpret_cast<const sockaddr_in&>(local).sin_port));
    case AF_INET6:
      return "tcp::" + std::to_string(ntohs(reinterpret_cast<const sockaddr_in6&>(local).sin6_port));
    default:
      return "";
  }
}

// ZeroMQ has no call that drops one peer of a ROUTER, but a frame knows the descriptor that it came through.
// The descriptor may have been closed and given to someone else since, so only one that is connected to our
// own address is shut down: the worst that can happen is that another peer has to connect again.
void ShutDownConnection(const zmq::message_t& frame, const std::string& endpoint) {
  const int fd = zmq_msg_get(const_cast<zmq_msg_t*>(frame.handle()), ZMQ_SRCFD);
  const bool ipc = endpoint.starts_with("ipc://");
  const std::string ours = ipc ? endpoint : "tcp::" + endpoint.substr(endpoint.rfind(':') + 1);
  if (fd >= 0 && LocalEndpoint(fd) == ours) ::shutdown(fd, SHUT_RDWR);
}

std::string UserId(const zmq::message_t& frame) {
  const char* id = zmq_msg_gets(frame.handle(), "User-Id");
  return id == nullptr ? "" : id;
}

}  // namespace

void SetCommonOptions(zmq::socket_t& socket, const SocketOptions& options) {
  const std::size_t largest = std::max(options.limits.envelope_bytes, options.limits.message_bytes);
  socket.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(largest));
  socket.set(zmq::sockopt::sndhwm, options.queue_messages);
  socket.set(zmq::sockopt::rcvhwm, options.queue_messages);
  socket.set(zmq::sockopt::handshake_ivl, options.handshake_ms);
  socket.set(zmq::sockopt::heartbeat_ivl, options.heartbeat_ms);
  socket.set(zmq::sockopt::heartbeat_timeout, 3 * options.heartbeat_ms);
  socket.set(zmq::sockopt::linger, options.linger_ms);
}

Result<RouterSocket> RouterSocket::Bind(Context& context, const std::string& endpoint,
                                        const std::optional<ServerSecurity>& security,
                                        const SocketOptions& options) {
  if (Status s = CheckEndpoint(endpoint, security.has_value()); !s.ok()) return s;
  if (security) {
    if (Status s = context.AllowClients(security->allowed_clients); !s.ok()) return s;
  }
  auto impl = std::make_unique<Impl>();
  impl->context = context.impl();
  impl->options = options;
  try {
    impl->socket = zmq::socket_t(impl->context->zmq, zmq::socket_type::router);
    SetCommonOptions(impl->socket, options);
    impl->socket.set(zmq::sockopt::router_mandatory, true);
    impl->socket.set(zmq::sockopt::ipv6, true);
    if (security) {
      impl->socket.set(zmq::sockopt::curve_server, true);
      impl->socket.set(zmq::sockopt::curve_secretkey, security->keys.secret_key);
      impl->socket.set(zmq::sockopt::zap_domain, "cairn");
    }
    impl->socket.bind(endpoint);
    impl->endpoint = impl->socket.get(zmq::sockopt::last_endpoint);
  } catch (const zmq::error_t& error) {
    return ZmqStatus(endpoint, error);
  }
  return RouterSocket(std::move(impl));
}

RouterSocket::RouterSocket(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RouterSocket::RouterSocket(RouterSocket&&) noexcept = default;
RouterSocket& RouterSocket::operator=(RouterSocket&&) noexcept = default;
RouterSocket::~RouterSocket() = default;

const std::string& RouterSocket::endpoint() const { return impl_->endpoint; }
std::uint64_t RouterSocket::refused_messages() const { return impl_->refused; }

void RouterSocket::Impl::Drop(const std::string& peer, const zmq::message_t& from) {
  ++refused;
  ShutDownConnection(from, endpoint);
  if (!dropped.insert(peer).second) return;
  drop_order.push_back(peer);
  if (drop_order.size() <= kDroppedPeersKept) return;
  dropped.erase(drop_order.front());
  drop_order.pop_front();
}

Received RouterSocket::Impl::Receive(std::vector<zmq::message_t> frames) {
  Received received;
  received.peer = frames[0].to_string();
  const zmq::message_t& last = frames.back();
  received.user_id = UserId(last);
  Result<Message> message = DecodeFrames(std::span(frames).subspan(1), options.limits);
  if (message.ok()) {
    received.message = std::move(message).value();
  } else {
    received.status = message.status();
    Drop(received.peer, last);
  }
  return received;
}

std::optional<Received> RouterSocket::TryReceive() {
  while (true) {
    std::vector<zmq::message_t> frames = ReceiveFrames(impl_->socket, impl_->options.limits);
    if (frames.empty()) return std::nullopt;
    if (!impl_->dropped.contains(frames[0].to_string())) return impl_->Receive(std::move(frames));
  }
}

Status RouterSocket::Send(const std::string& peer, Message message) {
  if (impl_->dropped.contains(peer)) return {Code::kNotFound, "this peer was dropped"};
  return SendFrames(impl_->socket, &peer, Encode(std::move(message)));
}

}  // namespace cairn::wire
