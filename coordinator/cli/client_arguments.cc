#include "coordinator/cli/client_arguments.h"

#include "coordinator/cli/failure.h"
#include "coordinator/cli/home.h"
#include "schema/wire/keys.h"

namespace cairn::cli {

void AddClientArguments(CLI::App& command, ClientArguments& arguments) {
  command.add_option(
      "--connect", arguments.connect,
      "The coordinator: ipc://PATH or tcp://HOST:PORT ($CAIRN_COORDINATOR, else the one in ~/.cairn)");
  command.add_option("--key", arguments.key, "This client's key pair, made by `cairn keys` (tcp)");
  command.add_option("--server-key", arguments.server_key, "The coordinator's public key (tcp)");
}

coordinator::Client ConnectClient(const ClientArguments& arguments) {
  coordinator::ClientOptions options;
  options.endpoint = arguments.connect.empty() ? DefaultEndpoint() : arguments.connect;
  if (arguments.key.empty() != arguments.server_key.empty())
    throw InputError("--key and --server-key go together");
  if (!arguments.key.empty()) {
    options.security = wire::ClientSecurity{Take(wire::ReadKeyPair(arguments.key)),
                                            Take(wire::ReadPublicKey(arguments.server_key))};
  }
  return Take(coordinator::Client::Connect(options));
}

}  // namespace cairn::cli
