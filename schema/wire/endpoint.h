// Which endpoints may be used: ipc inside a private folder, or tcp with keys. Nothing else.
#pragma once

#include <string>

#include "schema/error.h"

namespace cairn::wire {

// kRefused, with what to do, where `endpoint` is
//   ipc: not an absolute path in a folder of mode 0700 that this user owns (an abstract name has no folder),
//   or in one that is a link, or in whose place another user could put one of his own; or something else than
//   this user's socket is there; tcp: without keys; anything else.
// Asked before each bind and connect.
Status CheckEndpoint(const std::string& endpoint, bool has_keys);

}  // namespace cairn::wire
