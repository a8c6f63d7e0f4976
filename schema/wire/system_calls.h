// The C library's calls by which ZeroMQ makes connections and moves their bytes, in our place: what it cannot
// be told to limit is limited here. For this folder alone, but for LeaveAlone.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cairn::wire {

// From now on a connection that would take one of the last `spare` descriptors (a quarter of all, at most) is
// closed the moment that it is accepted. ZeroMQ, which accepts, else takes them all: then nothing can be
// saved, its thread spins over a TCP connection that it cannot accept, and aborts the process over one of
// ipc.
void SpareDescriptors(std::size_t spare);

// What is accepted by this socket is none of ZeroMQ's: but for its descriptor nothing of it is limited. One
// socket at a time; -1: none.
void LeaveAlone(int listener);

// What may come over a connection, accepted or made, before both sides have shaken hands: a greeting of 64
// bytes and two commands, of 202 and at most 700 bytes (rfc.zeromq.org/spec/26). ZeroMQ 4.3.4 would take a
// frame of any size that a message may have from whoever knocks, and keep what comes of it.
constexpr std::size_t kMostHandshakeBytes = 4096;

// Over a connection that is made from now on nothing more is read while so many bytes of it, or more, wait to
// be taken: what this process connects to cannot fill its memory, and has to wait. A message that is larger
// could never be taken. ZeroMQ's own limit counts messages, and one that it stops at ends the process
// (dealer.cc).
void LimitUnread(std::uint64_t bytes);
// Who knows says that so many bytes of a message that came over `fd` were taken. Where it is another's
// connection by now, that one may bring as much more.
void NoteTaken(int fd, std::uint64_t bytes);
// Bytes that have come over a connection since it was made, those of messages that are not whole yet too.
std::uint64_t BytesCame(int fd);

// True, once, of a connection that was read to its end, or until it failed: then its peer ended it, or the
// network, or ShutDownConnection, and not ZeroMQ over what came.
bool TakeEndOf(int fd);

}  // namespace cairn::wire
