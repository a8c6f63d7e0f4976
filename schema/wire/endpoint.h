// Which endpoints may be used: ipc inside a private folder, or tcp with keys. Nothing else.
#pragma once

#include <string>

#include "schema/error.h"

namespace cairn::wire {

// kRefused, with what to do, where `endpoint` is
//   ipc: not an absolute path below a folder of mode 0700 that this user owns (an abstract name has no
//   folder); tcp: without keys; anything else.
Status CheckEndpoint(const std::string& endpoint, bool has_keys);

}  // namespace cairn::wire
