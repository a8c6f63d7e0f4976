#include "schema/wire/monitor.h"

#include <cstring>
#include <vector>

namespace cairn::wire {

Monitor::Monitor(zmq::context_t& context, zmq::socket_t& watched, int events)
    : watched_(watched), events_(context, zmq::socket_type::pair) {
  const std::string address =
      "inproc://monitor-" + std::to_string(reinterpret_cast<std::uintptr_t>(watched.handle()));
  if (zmq_socket_monitor(watched.handle(), address.c_str(), events) != 0) throw zmq::error_t();
  events_.set(zmq::sockopt::linger, 0);
  events_.set(zmq::sockopt::rcvhwm, 0);  // ZeroMQ's thread waits where an event has no room …
  events_.connect(address);
}

// … and for ever where nobody listens any more, with all that the context's sockets have to do: a socket
// that is closed still tells what becomes of its connections, until it has lingered. So it is told first.
Monitor::~Monitor() { zmq_socket_monitor(watched_.handle(), nullptr, 0); }

std::optional<Monitor::Event> Monitor::Next() {
  // Frame one: kind (16 bits) and value (32); frame two: address. None of a peer's, so no limits apply.
  const std::vector<zmq::message_t> frames = ReceiveFrames(events_, {});
  if (frames.size() != 2) return std::nullopt;
  Event event;
  std::uint16_t kind = 0;
  std::memcpy(&kind, frames[0].data(), sizeof kind);
  std::memcpy(&event.value, frames[0].data<std::byte>() + sizeof kind, sizeof event.value);
  event.kind = kind;
  event.where = frames[1].to_string();
  return event;
}

}  // namespace cairn::wire
