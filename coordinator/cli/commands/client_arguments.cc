#include "coordinator/cli/commands/client_arguments.h"

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/home.h"
#include "schema/wire/keys.h"

namespace cairn::cli {

void AddClientArguments(Command command, ClientArguments& arguments) {
  command.Add(
      "--connect", arguments.connect,
      "The coordinator: ipc://PATH or tcp://HOST:PORT ($CAIRN_COORDINATOR, else the one in ~/.cairn)");
  command.Add("--key", arguments.key, "This client's key pair (tcp: ~/.config/cairn/client.key)");
  command.Add("--server-key", arguments.server_key,
              "The coordinator's public key (tcp: ~/.config/cairn/coordinator.pub)");
}

coordinator::Client ConnectClient(const ClientArguments& arguments) {
  coordinator::ClientOptions options;
  options.endpoint = arguments.connect.empty() ? DefaultEndpoint() : arguments.connect;
  const bool tcp = options.endpoint.starts_with("tcp://");
  if (tcp || !arguments.key.empty() || !arguments.server_key.empty()) {
    const std::string key = arguments.key.empty() ? DefaultKey("client.key") : arguments.key;
    const std::string server =
        arguments.server_key.empty() ? DefaultKey("coordinator.pub") : arguments.server_key;
    options.security = wire::ClientSecurity{Take(wire::ReadKeyPair(key)), Take(wire::ReadPublicKey(server))};
  }
  return Take(coordinator::Client::Connect(options));
}

}  // namespace cairn::cli
