#include <cerrno>
#include <utility>

#include "schema/wire/internal.h"

namespace cairn::wire {
namespace {

// Below this a copy costs less than the allocation and the call back that zero-copy needs.
constexpr std::size_t kZeroCopyBytes = 16 * 1024;
constexpr std::size_t kLongestName = 255;  // ZMTP's limit

zmq::message_t FrameOf(const Array& array) {
  const std::span<const std::byte> bytes = array.bytes();
  if (bytes.size() < kZeroCopyBytes) return zmq::message_t(bytes.data(), bytes.size());
  // ZeroMQ's thread lets the array go when the bytes are out. Nobody writes through this pointer.
  auto* keep = new Array(array);
  return zmq::message_t(
      const_cast<std::byte*>(bytes.data()), bytes.size(),
      [](void*, void* hint) { delete static_cast<Array*>(hint); }, keep);
}

}  // namespace

Status ZmqStatus(const std::string& what, const zmq::error_t& error) {
  Code code = Code::kIo;
  switch (error.num()) {
    case EADDRINUSE:
      code = Code::kBusy;
      break;
    // An endpoint that this machine cannot have: another has to be named.
    case EACCES:
    case EPERM:
    case EROFS:
    case ENOENT:
    case ENOTDIR:
    case ENAMETOOLONG:
    case ENODEV:
    case EADDRNOTAVAIL:
    case EINVAL:
    case EPROTONOSUPPORT:
      code = Code::kRefused;
      break;
    default:
      break;
  }
  return {code, what + ": " + error.what()};
}

Status SendFrames(zmq::socket_t& socket, const std::string* peer, Frames frames) {
  std::vector<zmq::message_t> parts;
  if (peer != nullptr) parts.emplace_back(peer->data(), peer->size());
  parts.emplace_back(frames.envelope.data(), frames.envelope.size());
  for (const Array& array : frames.arrays) parts.push_back(FrameOf(array));
  try {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const auto more = i + 1 < parts.size() ? zmq::send_flags::sndmore : zmq::send_flags::none;
      // Only the first part can find the queue full: ZeroMQ counts whole messages.
      if (!socket.send(parts[i], more | zmq::send_flags::dontwait)) {
        return {Code::kBusy, "the peer's queue is full, or it is not connected"};
      }
    }
  } catch (const zmq::error_t& error) {
    if (error.num() == EHOSTUNREACH) return {Code::kNotFound, "no such peer is connected"};
    return ZmqStatus("send", error);
  }
  return Status::Ok();
}

std::vector<zmq::message_t> ReceiveFrames(zmq::socket_t& socket, const Limits& limits) {
  std::vector<zmq::message_t> frames;
  std::size_t bytes = 0;
  bool more = true;
  while (more) {
    zmq::message_t frame;
    const int got = zmq_msg_recv(frame.handle(), socket.handle(), ZMQ_DONTWAIT);
    if (got < 0 && (zmq_errno() == EAGAIN || zmq_errno() == EINTR)) break;
    CAIRN_DEMAND(got >= 0, zmq_strerror(zmq_errno()));
    more = frame.more();
    // A router's first frame, the peer's name, is not the message's: what is kept must still be over the
    // limit.
    if (bytes > limits.message_bytes + kLongestName || frames.size() > limits.frames + 1) continue;
    bytes += frame.size();
    frames.push_back(std::move(frame));
  }
  return frames;
}

Result<Message> DecodeFrames(std::span<const zmq::message_t> frames, const Limits& limits) {
  std::vector<std::span<const std::byte>> views;
  for (const zmq::message_t& frame : frames) views.emplace_back(frame.data<std::byte>(), frame.size());
  return Decode(views, limits);
}

}  // namespace cairn::wire
