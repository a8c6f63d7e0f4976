#include <algorithm>
#include <cerrno>
#include <memory>
#include <utility>

#include "schema/wire/internal.h"

namespace cairn::wire {
namespace {

// Below this a copy costs less than the allocation and the call back that zero-copy needs.
constexpr std::size_t kZeroCopyBytes = 16 * 1024;
constexpr std::size_t kCountedBytes = 1024;  // what is smaller is held by the number of messages that wait
constexpr std::size_t kLongestName = 255;    // ZMTP's limit

// What a frame's bytes lie in, and how many it counts for until ZeroMQ lets it go.
struct Kept {
  std::shared_ptr<const void> owner;
  UnsentBytes unsent;  // null: it is not counted
  std::size_t counted = 0;
};

// Nobody writes through this pointer. ZeroMQ's thread lets `kept` go when the bytes are out, or their peer is
// gone.
zmq::message_t FrameOver(std::span<const std::byte> bytes, Kept kept) {
  auto hint = std::make_unique<Kept>(std::move(kept));
  if (hint->unsent) *hint->unsent += hint->counted;
  return zmq::message_t(
      const_cast<std::byte*>(bytes.data()), bytes.size(),
      [](void*, void* kept_by) {
        const std::unique_ptr<Kept> gone(static_cast<Kept*>(kept_by));
        if (gone->unsent) *gone->unsent -= gone->counted;
      },
      hint.release());
}

// A message as ZeroMQ gets it.
struct FrameBytes {
  std::span<const std::byte> bytes;
  std::shared_ptr<const void> owner;
};
std::vector<FrameBytes> SplitIntoFrames(Frames frames) {
  const auto envelope = std::make_shared<const std::string>(std::move(frames.envelope));
  std::vector<FrameBytes> split = {{std::as_bytes(std::span(*envelope)), envelope}};
  for (Array& of : frames.arrays) {
    const auto array = std::make_shared<const Array>(std::move(of));
    std::span<const std::byte> rest = array->bytes();
    for (; rest.size() >= kFrameBytes; rest = rest.subspan(kFrameBytes))
      split.push_back({rest.first(kFrameBytes), array});
    split.push_back({rest, array});
  }
  return split;
}

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

Status SendFrames(zmq::socket_t& socket, const std::string* peer, Frames frames, const UnsentBytes& unsent) {
  const bool counted = unsent != nullptr && BytesIn(frames) >= kCountedBytes;
  const std::vector<FrameBytes> split = SplitIntoFrames(std::move(frames));
  std::vector<zmq::message_t> parts;
  parts.reserve(1 + split.size());
  if (peer != nullptr) parts.emplace_back(peer->data(), peer->size());
  std::size_t copied_bytes = 0;  // they count with the last frame
  for (std::size_t i = 0; i < split.size(); ++i) {
    const std::span<const std::byte> bytes = split[i].bytes;
    const bool last = i + 1 == split.size();
    if (bytes.size() < kZeroCopyBytes && !(counted && last)) {
      parts.emplace_back(bytes.data(), bytes.size());
      copied_bytes += bytes.size();
    } else {
      parts.push_back(FrameOver(
          bytes, {split[i].owner, counted ? unsent : nullptr, bytes.size() + (last ? copied_bytes : 0)}));
    }
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
  const std::size_t most_frames = 1 + limits.frames + limits.message_bytes / kFrameBytes;
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
    if (bytes > limits.message_bytes + kLongestName || frames.size() > most_frames) continue;
    bytes += frame.size();
    if (frames.empty()) frames.reserve(kUsual);
    frames.push_back(std::move(frame));
  }
  return frames;
}

// Lets frames go as it joins them, so that they are not in memory twice.
Result<Message> DecodeFrames(std::span<zmq::message_t> frames, const Limits& limits) {
  std::vector<std::unique_ptr<std::byte[]>> joined;
  std::vector<std::span<const std::byte>> views;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::size_t end = i;  // of the frames that go on after it
    while (i > 0 && end + 1 < frames.size() && frames[end].size() == kFrameBytes) ++end;
    std::size_t bytes = 0;
    for (std::size_t j = i; j <= end; ++j) bytes += frames[j].size();
    if (end == i) {
      views.emplace_back(frames[i].data<std::byte>(), bytes);
      continue;
    }
    std::byte* to = joined.emplace_back(std::make_unique_for_overwrite<std::byte[]>(bytes)).get();
    views.emplace_back(to, bytes);
    for (; i <= end; ++i) {
      to = std::copy_n(frames[i].data<std::byte>(), frames[i].size(), to);
      frames[i].rebuild();
    }
    --i;
  }
  return Decode(views, limits);
}

}  // namespace cairn::wire
