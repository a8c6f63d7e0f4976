// How a client finds its coordinator.
#pragma once

#include <string>

#include "coordinator/client.h"
#include "schema/command_line/command.h"

namespace cairn::cli {

struct ClientArguments {
  std::string connect;
  std::string key;         // STEM.key of this client; tcp only
  std::string server_key;  // .pub of the coordinator; tcp only
};

void AddClientArguments(Command command, ClientArguments& arguments);

// Throws InputError or WorldError.
coordinator::Client ConnectClient(const ClientArguments& arguments);

}  // namespace cairn::cli
