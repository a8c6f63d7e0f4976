// Watches what becomes of a socket's connections. For this folder alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "schema/wire/internal.h"

namespace cairn::wire {

class Monitor {
 public:
  struct Event {
    int kind = 0;             // ZMQ_EVENT_…
    std::uint32_t value = 0;  // what it means depends on the kind
    std::string where;        // the endpoint
  };

  // Of `watched`, which outlives it and belongs to the thread that makes and ends the monitor: the events of
  // this mask.
  // Throws zmq::error_t.
  Monitor(zmq::context_t& context, zmq::socket_t& watched, int events);
  ~Monitor();
  Monitor(const Monitor&) = delete;
  Monitor& operator=(const Monitor&) = delete;

  std::optional<Event> Next();
  void* handle() { return events_.handle(); }  // to poll

 private:
  zmq::socket_t& watched_;
  zmq::socket_t events_;
};

}  // namespace cairn::wire
