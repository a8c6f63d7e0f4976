// Transport over a ROUTER socket of schema/wire.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "coordinator/server/transport.h"
#include "schema/wire/socket.h"

namespace cairn::coordinator {

// kRefused: tcp without keys, or ipc outside a private folder.
// kBusy: the address is in use.
Result<std::unique_ptr<Transport>> ListenZmq(const std::string& endpoint,
                                             const std::optional<wire::ServerSecurity>& security = {},
                                             const wire::SocketOptions& options = {});

}  // namespace cairn::coordinator
