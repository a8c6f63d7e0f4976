#include <cerrno>
#include <memory>
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

// The last frame of a message of so many bytes: when ZeroMQ lets it go, the message is out, or its peer is
// gone.
template <typename Kept>
zmq::message_t LastFrame(Kept kept, std::span<const std::byte> (*bytes_of)(const Kept&),
                         std::size_t message_bytes, const UnsentBytes& unsent) {
  struct Hint {
    Kept kept;
    std::size_t message_bytes;
    UnsentBytes unsent;
  };
  auto hint = std::make_unique<Hint>(Hint{std::move(kept), message_bytes, unsent});
  const std::span<const std::byte> bytes = bytes_of(hint->kept);
  *unsent += message_bytes;
  // Nobody writes through this pointer. On ZeroMQ's thread:
  return zmq::message_t(
      const_cast<std::byte*>(bytes.data()), bytes.size(),
      [](void*, void* kept_by) {
        const std::unique_ptr<Hint> gone(static_cast<Hint*>(kept_by));
        *gone->unsent -= gone->message_bytes;
      },
      hint.release());
}

std::span<const std::byte> BytesOfText(const std::string& text) { return std::as_bytes(std::span(text)); }
std::span<const std::byte> BytesOfArray(const Array& array) { return array.bytes(); }

}  // namespace

std::size_t BytesIn(const Frames& frames) {
  std::size_t bytes = frames.envelope.size();
  for (const Array& array : frames.arrays) bytes += array.bytes().size();
  return bytes;
}

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

Status SendFrames(zmq::socket_t& socket, const std::string* peer, Frames frames, const UnsentBytes& unsent,
                  std::size_t count_as) {
  std::vector<zmq::message_t> parts;
  parts.reserve(2 + frames.arrays.size());
  if (peer != nullptr) parts.emplace_back(peer->data(), peer->size());
  const std::size_t bytes = !unsent ? 0 : count_as > 0 ? count_as : BytesIn(frames);
  const bool counted = bytes >= kZeroCopyBytes;
  if (counted && frames.arrays.empty()) {
    parts.push_back(LastFrame(std::move(frames.envelope), BytesOfText, bytes, unsent));
  } else {
    parts.emplace_back(frames.envelope.data(), frames.envelope.size());
  }
  for (std::size_t i = 0; i < frames.arrays.size(); ++i) {
    const bool last = i + 1 == frames.arrays.size();
    parts.push_back(counted && last ? LastFrame(frames.arrays[i], BytesOfArray, bytes, unsent)
                                    : FrameOf(frames.arrays[i]));
  }
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
  constexpr std::size_t kUsual = 4;
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
    if (frames.empty()) frames.reserve(kUsual);
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
