// The last descriptors of a process that serves are not for connections. For this folder alone.
#pragma once

#include <cstddef>

namespace cairn::wire {

// From now on a connection that would take one of the last `spare` descriptors (a quarter of all, at most) is
// closed the moment that it is accepted. ZeroMQ, which accepts, else takes them all: then nothing can be
// saved, its thread spins over a TCP connection that it cannot accept, and aborts the process over one of
// ipc.
void SpareDescriptors(std::size_t spare);

}  // namespace cairn::wire
