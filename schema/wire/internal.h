// Shared by this folder's .cc files alone: cppzmq does not leave the folder.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>
#include <zmq.hpp>

#include "schema/wire/codec.h"
#include "schema/wire/context.h"

namespace cairn::wire {

struct Context::Impl {
  zmq::context_t zmq{1};
};

// Of messages that ZeroMQ has not handed to the kernel yet; its threads count down.
using UnsentBytes = std::shared_ptr<std::atomic<std::size_t>>;

std::size_t BytesIn(const Frames& frames);

// An array goes out in frames of so many bytes; what is left, or nothing, is its last frame. ZeroMQ encrypts
// a frame at a time for each peer, so no more than this is in memory again for each that is slow to read.
inline constexpr std::size_t kFrameBytes = 256 << 10;

// Sends all frames, without blocking. kNotFound: no such peer. kBusy: its queue is full, or nobody is
// connected. `unsent`: counts this message, unless it is small.
Status SendFrames(zmq::socket_t& socket, const std::string* peer, Frames frames,
                  const UnsentBytes& unsent = nullptr);

// The frames of the next message; empty where none waits. Frames beyond `limits` are thrown away as they
// come, the first of them kept, so that Decode refuses the message.
std::vector<zmq::message_t> ReceiveFrames(zmq::socket_t& socket, const Limits& limits);

// Takes the frames.
Result<Message> DecodeFrames(std::span<zmq::message_t> frames, const Limits& limits);

Status ZmqStatus(const std::string& what, const zmq::error_t& error);

}  // namespace cairn::wire
