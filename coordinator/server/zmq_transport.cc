#include "coordinator/server/zmq_transport.h"

#include <chrono>
#include <utility>

#include "schema/wire/poller.h"

namespace cairn::coordinator {
namespace {

constexpr std::size_t kMostAtOnce = 256;  // so that ticks are not starved

class ZmqTransport : public Transport {
 public:
  ZmqTransport(std::unique_ptr<wire::Context> context, wire::RouterSocket socket)
      : context_(std::move(context)), socket_(std::move(socket)) {
    poller_.Add(socket_);
    poller_.Add(wakeup_);
  }

  std::vector<Incoming> Poll(double timeout_s) override {
    std::vector<Incoming> incoming;
    Drain(incoming);
    if (!incoming.empty()) return incoming;
    poller_.Wait(std::chrono::milliseconds(static_cast<int>(timeout_s * 1000)));
    Drain(incoming);
    return incoming;
  }

  bool TookAll() const override { return took_all_; }
  bool Send(const std::string& peer, wire::Message message) override {
    return socket_.Send(peer, std::move(message)).code() != Code::kNotFound;
  }

  std::size_t Unsent(const std::string& peer) const override { return socket_.Unsent(peer); }
  void Drop(const std::string& peer) override { socket_.Drop(peer); }
  std::vector<wire::Refusal> TakeRefusals() override { return socket_.TakeRefusals(); }
  wire::Traffic TotalTraffic() const override { return socket_.traffic(); }
  void Wake() override { wakeup_.Signal(); }

 private:
  void Drain(std::vector<Incoming>& incoming) {
    took_all_ = false;
    while (incoming.size() < kMostAtOnce) {
      std::optional<wire::Received> received = socket_.TryReceive();
      took_all_ = !received;
      if (took_all_) return;
      incoming.push_back({std::move(received->peer), std::move(received->status),
                          std::move(received->message), std::move(received->user_id)});
    }
  }

  std::unique_ptr<wire::Context> context_;
  wire::RouterSocket socket_;
  bool took_all_ = false;
  wire::Wakeup wakeup_;
  wire::Poller poller_;  // last: what it watches must outlive it
};

}  // namespace

Result<std::unique_ptr<Transport>> ListenZmq(const std::string& endpoint,
                                             const std::optional<wire::ServerSecurity>& security,
                                             const wire::SocketOptions& options) {
  auto context = std::make_unique<wire::Context>();
  Result<wire::RouterSocket> socket = wire::RouterSocket::Bind(*context, endpoint, security, options);
  if (!socket.ok()) return socket.status();
  return std::unique_ptr<Transport>(
      std::make_unique<ZmqTransport>(std::move(context), std::move(socket).value()));
}

}  // namespace cairn::coordinator
