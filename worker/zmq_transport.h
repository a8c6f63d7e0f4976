// The worker's link over ZeroMQ.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "schema/wire/poller.h"
#include "schema/wire/socket.h"
#include "worker/transport.h"

namespace cairn::worker {

class ZmqTransport : public Transport {
 public:
  static Result<std::unique_ptr<ZmqTransport>> Connect(
      const std::string& endpoint, const std::optional<wire::ClientSecurity>& security = {});
  std::vector<Event> Poll(double timeout_s) override;
  bool Send(const wire::Message& message) override;
  std::uint64_t BytesCame() const override { return socket_.BytesCame(); }
  void Wake() override { wakeup_.Signal(); }

 private:
  explicit ZmqTransport(wire::DealerSocket socket) : socket_(std::move(socket)) {
    poller_.Add(socket_);
    poller_.Add(wakeup_);
  }
  wire::Wakeup wakeup_;
  wire::DealerSocket socket_;
  wire::Poller poller_;
};

}  // namespace cairn::worker
