// What the worker's I/O loop asks of its link to the coordinator. zmq_transport.h binds it to ZeroMQ, tests
// to a fake.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/wire/codec.h"

namespace cairn::worker {

struct Event {
  enum Kind {
    kConnected,
    kDisconnected,     // what was under way is lost; the transport connects again by itself
    kKeyRefused,       // the coordinator does not know our key
    kHandshakeFailed,  // broken off before the connection was secured; the transport tries again by itself
    kMalformed,        // a message that could not be read; the transport connects again by itself
    kMessage,
  };
  Kind kind = kMessage;
  wire::Message message;  // kMessage
  std::string text;       // kMalformed: why
};

class Transport {
 public:
  virtual ~Transport() = default;
  // What has come; waits up to `timeout_s` where nothing has, or until Wake.
  virtual std::vector<Event> Poll(double timeout_s) = 0;
  // Never waits. False: not now (the queue is full), or not connected.
  virtual bool Send(const wire::Message& message) = 0;
  // Over the connection that stands, those of messages that are not whole yet too.
  virtual std::uint64_t BytesCame() const = 0;
  // From any thread, and from a signal handler.
  virtual void Wake() = 0;
};

}  // namespace cairn::worker
