// What the system knows of a connection by its descriptor. ZeroMQ owns the descriptors: one may have been
// closed and given to someone else since, so what is done here is only done to connections of the endpoint
// `ours`.
#pragma once

#include <cstdint>
#include <string>

namespace cairn::wire {

// The other end's address without its port, of IPv6 its /64 network: who has one address there has them all.
// Empty for ipc, or where it is gone.
std::string PeerAddress(int fd);
// True where `fd` is a connection that was made to the endpoint `ours`.
bool IsConnectionOf(int fd, const std::string& ours);
// ZeroMQ has no call that drops one peer. The worst that can happen is that another peer of ours has to
// connect again.
void ShutDownConnection(int fd, const std::string& ours);
// Bytes that came over it so far; 0 for ipc.
std::uint64_t BytesReceived(int fd);
// Bytes that were handed to the system and that the other end has not got yet.
std::uint64_t BytesUnderWay(int fd);

}  // namespace cairn::wire
