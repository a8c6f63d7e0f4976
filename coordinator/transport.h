// What the coordinator's event loop asks of a socket. schema/wire binds it to ZeroMQ, tests to a fake.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/error.h"
#include "schema/wire.pb.h"

namespace cairn::coordinator {

// A message from `peer`, already checked: every blob has the hash that the envelope announces for it.
struct Incoming {
  std::string peer;  // the socket's name of who sent it; opaque
  wire::Envelope envelope;
  std::vector<BlobPtr> blobs;  // in the order of the envelope's BlobMetas
};

class Transport {
 public:
  virtual ~Transport() = default;
  // What has arrived; waits up to `timeout_s` where nothing has. May return fewer messages than there are.
  virtual std::vector<Incoming> Poll(double timeout_s) = 0;
  // Queues a message and never waits. Fills in the envelope's BlobMetas from `blobs`. A peer that is gone or
  // whose queue is full loses the message: leases repair that.
  virtual void Send(const std::string& peer, wire::Envelope envelope, const std::vector<BlobPtr>& blobs) = 0;
};

}  // namespace cairn::coordinator
