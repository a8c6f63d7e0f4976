// What the coordinator's event loop asks of a socket. zmq_transport.h binds it to ZeroMQ, tests to a fake.
#pragma once

#include <string>
#include <vector>

#include "schema/wire/codec.h"
#include "schema/wire/refusal.h"
#include "schema/wire/socket.h"

namespace cairn::coordinator {

// What came from `peer`: a message, or, where `status` is not ok, why one was refused (its connection is
// dropped, but for kVersion).
struct Incoming {
  std::string peer;  // the socket's name of who sent it; opaque
  Status status;
  wire::Message message;
  std::string user = {};  // the sender's public key, where there are keys
};

class Transport {
 public:
  virtual ~Transport() = default;
  // What has arrived; waits up to `timeout_s`, or until Wake, where nothing has. May return fewer than there
  // are.
  virtual std::vector<Incoming> Poll(double timeout_s) = 0;
  // Whether the last Poll left nothing that had arrived when it was called.
  virtual bool TookAll() const = 0;
  // Queues a message and never waits. False: the peer is known to be gone, though what it sent before may
  // still wait to be taken. True promises nothing: a message that is lost on its way, or because the peer's
  // queue is full, is made up for by leases.
  virtual bool Send(const std::string& peer, wire::Message message) = 0;
  // Bytes of messages that wait to go out to it, but for small ones.
  virtual std::size_t Unsent(const std::string& peer) const = 0;
  // Closes a peer's connection; what it still sends is thrown away.
  virtual void Drop(const std::string& peer) = 0;
  // What was turned away before it could say anything, since the last call.
  virtual std::vector<wire::Refusal> TakeRefusals() = 0;
  virtual wire::Traffic TotalTraffic() const = 0;
  // From any thread.
  virtual void Wake() = 0;
};

}  // namespace cairn::coordinator
