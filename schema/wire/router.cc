#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "schema/wire/connection.h"
#include "schema/wire/endpoint.h"
#include "schema/wire/socket_impl.h"
#include "schema/wire/system_calls.h"

namespace cairn::wire {
namespace {

constexpr std::size_t kDroppedPeersKept = 4096;

int Descriptor(const zmq::message_t& frame) {
  return zmq_msg_get(const_cast<zmq_msg_t*>(frame.handle()), ZMQ_SRCFD);
}

std::string UserId(const zmq::message_t& frame) {
  const char* id = zmq_msg_gets(frame.handle(), "User-Id");
  return id == nullptr ? "" : id;
}

std::uint64_t Handshake(const zmq::message_t& frame) {
  const char* number = zmq_msg_gets(frame.handle(), kHandshakeProperty);
  return number == nullptr ? 0 : std::strtoull(number, nullptr, 10);
}

}  // namespace

void SetCommonOptions(zmq::socket_t& socket, const SocketOptions& options) {
  const std::size_t largest = std::max(options.limits.envelope_bytes, options.limits.message_bytes);
  socket.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(largest));
  socket.set(zmq::sockopt::sndhwm, options.queue_messages);
  socket.set(zmq::sockopt::rcvhwm, options.queue_messages);
  socket.set(zmq::sockopt::handshake_ivl, options.handshake_ms);
  // By TCP, not by ZMTP's pings: a ROUTER's are what is due there by itself (RouterSocket::Bind).
  constexpr int kPings = 3;
  const int between_s = std::max(1, options.keepalive_ms / 1000);
  socket.set(zmq::sockopt::tcp_keepalive, 1);
  socket.set(zmq::sockopt::tcp_keepalive_idle, between_s);
  socket.set(zmq::sockopt::tcp_keepalive_intvl, between_s);
  socket.set(zmq::sockopt::tcp_keepalive_cnt, kPings);
  socket.set(zmq::sockopt::tcp_maxrt, kPings * options.keepalive_ms);
  socket.set(zmq::sockopt::linger, options.linger_ms);
}

Result<RouterSocket> RouterSocket::Bind(Context& context, const std::string& endpoint,
                                        const std::optional<ServerSecurity>& security,
                                        const SocketOptions& options) {
  if (Status s = CheckEndpoint(endpoint, security.has_value()); !s.ok()) return s;
  if (security) {
    if (const auto keys = ReadAllowList(security->allow_list); !keys.ok()) return keys.status();
  }
  auto impl = std::make_unique<Impl>();
  impl->context = context.impl();
  impl->options = options;
  impl->has_keys = security.has_value();
  try {
    impl->socket = zmq::socket_t(impl->context->zmq, zmq::socket_type::router);
    SetCommonOptions(impl->socket, options);
    impl->socket.set(zmq::sockopt::router_mandatory, true);
    // ZeroMQ 4.3.4 aborts the process over a connection that ends while its queue is full and something is
    // due to be sent on it. So no queue is: what comes is limited by connection, in bytes (unread_bytes).
    impl->socket.set(zmq::sockopt::rcvhwm, 0);
    impl->socket.set(zmq::sockopt::ipv6, true);
    // A fleet comes back at once; whom the system turns away (it has a limit of its own) tries again later
    // and later.
    impl->socket.set(zmq::sockopt::backlog, static_cast<int>(options.connections.connections));
    if (security) {
      impl->socket.set(zmq::sockopt::curve_server, true);
      impl->socket.set(zmq::sockopt::curve_secretkey, security->keys.secret_key);
      impl->socket.set(zmq::sockopt::zap_domain, "cairn");
    }
    impl->authenticator = std::make_unique<ZapAuthenticator>(
        impl->context->zmq, impl->socket, security ? std::optional(security->allow_list) : std::nullopt,
        options.connections);
    SpareDescriptors(options.connections.spare_files / 2);  // the ZAP authenticator, who counts, comes first
    impl->socket.bind(endpoint);
    impl->endpoint = impl->socket.get(zmq::sockopt::last_endpoint);
    impl->authenticator->Start(impl->endpoint);
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
std::size_t RouterSocket::connections() const { return impl_->authenticator->connections(); }
Traffic RouterSocket::traffic() const { return impl_->traffic; }
std::vector<Refusal> RouterSocket::TakeRefusals() { return impl_->authenticator->TakeRefusals(); }
void RouterSocket::Drop(const std::string& peer) { impl_->Drop(peer); }

RouterSocket::Impl::Peer& RouterSocket::Impl::PeerOf(const std::string& peer) {
  if (const auto known = peers.find(peer); known != peers.end()) return known->second;
  // Whoever is forgotten here and dropped before it sends again keeps a connection through which nothing
  // comes.
  if (peers.size() > 2 * options.connections.connections)
    std::erase_if(peers, [](const auto& of) { return *of.second.unsent == 0; });
  return peers.emplace(peer, Peer{-1, std::make_shared<std::atomic<std::size_t>>(0)}).first->second;
}

// Messages outlive the connection that they came over, and its descriptor is another's by then. ZeroMQ knows:
// it begins no message to a peer that is gone. One that it begins is ended after its connection is shut down,
// and goes nowhere.
void RouterSocket::Impl::ShutDown(const std::string& peer, int fd) {
  (void)socket.get(zmq::sockopt::events);  // it learns here what has ended
  zmq::message_t name(peer.data(), peer.size());
  bool begun = false;
  try {
    begun = socket.send(name, zmq::send_flags::sndmore | zmq::send_flags::dontwait).has_value();
  } catch (const zmq::error_t& error) {
    if (error.num() == EHOSTUNREACH) return;
    throw;
  }
  ShutDownConnection(fd, endpoint);
  if (begun) (void)socket.send(zmq::message_t(), zmq::send_flags::dontwait);
}

void RouterSocket::Impl::Drop(const std::string& peer) {
  if (const auto known = peers.find(peer); known != peers.end() && known->second.descriptor >= 0)
    ShutDown(peer, known->second.descriptor);
  if (!dropped.insert(peer).second) return;
  drop_order.push_back(peer);
  if (drop_order.size() <= kDroppedPeersKept) return;
  dropped.erase(drop_order.front());
  drop_order.pop_front();
}

Received RouterSocket::Impl::Receive(std::string peer, std::string user, std::span<zmq::message_t> frames) {
  Received received;
  received.peer = std::move(peer);
  received.user_id = std::move(user);
  Result<Message> message = DecodeFrames(frames, options.limits);
  if (message.ok()) {
    received.message = std::move(message).value();
  } else {
    received.status = message.status();
    if (received.status.code() != Code::kVersion) Drop(received.peer);
  }
  return received;
}

std::optional<Received> RouterSocket::TryReceive() {
  while (true) {
    std::vector<zmq::message_t> frames = ReceiveFrames(impl_->socket, impl_->options.limits);
    if (frames.empty()) return std::nullopt;
    const std::size_t bytes = std::accumulate(frames.begin(), frames.end(), std::size_t{0},
                                              [](std::size_t sum, const auto& f) { return sum + f.size(); });
    impl_->traffic.bytes_in += bytes - frames[0].size();
    const zmq::message_t& last = frames.back();
    const int fd = Descriptor(last);
    std::string peer = frames[0].to_string(), user = impl_->has_keys ? UserId(last) : "";
    impl_->PeerOf(peer).descriptor = fd;
    const std::uint64_t handshake = impl_->has_keys ? Handshake(last) : 0;
    if (!impl_->authenticator->TellTaken(fd, handshake, user, bytes, frames.size())) impl_->Drop(peer);
    if (!impl_->dropped.contains(peer))
      return impl_->Receive(std::move(peer), std::move(user), std::span(frames).subspan(1));
  }
}

Status RouterSocket::Send(const std::string& peer, Message message) {
  if (impl_->dropped.contains(peer)) return {Code::kNotFound, "this peer was dropped"};
  Frames frames = Encode(std::move(message));
  const std::size_t bytes = BytesIn(frames);
  const UnsentBytes unsent = impl_->PeerOf(peer).unsent;
  if (*unsent > 0 && *unsent + bytes > impl_->options.connections.unsent_bytes)
    return {Code::kBusy, "the peer has not read what was sent before"};
  Status sent = SendFrames(impl_->socket, &peer, std::move(frames), unsent);
  if (sent.ok()) impl_->traffic.bytes_out += bytes;
  return sent;
}

std::size_t RouterSocket::Unsent(const std::string& peer) const {
  const auto known = impl_->peers.find(peer);
  const std::size_t waits = known == impl_->peers.end() ? 0 : known->second.unsent->load();
  return waits == 0 ? 0 : waits + BytesUnderWay(known->second.descriptor);
}

}  // namespace cairn::wire
