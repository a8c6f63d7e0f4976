// What was refused, by kind: counted, logged, and shown by `cairn list`.
#pragma once

#include <cstdint>
#include <string>

namespace cairn::wire {

enum class RefusalKind {
  // At the door.
  kConnections,  // one connection too many
  kRate,         // too many connections from one address in a short time
  kHandshake,    // no handshake in time, no ZMTP, or bytes that were forged or replayed
  kKey,          // a key that is not on the list
  // Of a message.
  kMalformed,
  kOversized,
  kVersion,  // of a kind, or a protocol, that is not known here
  kBuild,    // a worker of another build than the coordinator's
  // Of what a message asks for.
  kRevoked,   // the key was taken off the list since it shook hands
  kRight,     // the key's roles do not allow it
  kIdentity,  // it claims to be a worker that another key has, or uses another's connection
  kTask,      // an answer to, or a fetch for, a task that is not its own
  kBlob,      // an upload that nobody asked for
  kJob,       // a job that cannot be, or is over a limit
  kStore,     // a job that the store has no room for
  kQuota,     // more than one key may have or ask
};
const char* KindName(RefusalKind kind);  // "key"

struct Refusal {
  RefusalKind kind = RefusalKind::kMalformed;
  std::string reason;  // for logs, of the latest of them
  std::uint64_t count = 1;
};

}  // namespace cairn::wire
