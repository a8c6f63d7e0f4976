// Where something listens over HTTP: an address as people write it, and the socket of it.
#pragma once

#include <string>
#include <utility>

#include "schema/error.h"

namespace cairn::coordinator {

// HOST and PORT of PORT (on loopback), HOST:PORT or [ADDRESS]:PORT.
std::pair<std::string, std::string> SplitAddress(const std::string& address);

// True where nobody but this machine reaches it: 127.0.0.0/8, ::1, localhost.
bool IsLoopback(const std::string& host);

// A socket that listens there; port 0: any that is free. `purpose` is for messages: "metrics". kRefused:
// there is no such address. kBusy: it is in use.
Result<int> ListenAt(const std::string& address, const std::string& purpose);

// HOST:PORT that a socket is bound to, [HOST]:PORT where the host is of IPv6.
std::string NameOfSocket(int socket);

}  // namespace cairn::coordinator
