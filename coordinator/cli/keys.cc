#include "schema/wire/keys.h"

#include <cstdio>

#include "coordinator/cli/failure.h"
#include "coordinator/cli/invocation.h"

namespace cairn::cli {
namespace {

struct Options {
  std::string stem;
};

int Keys(const Options& options, const Invocation&) {
  const wire::KeyPair keys = wire::GenerateKeyPair();
  Check(wire::WriteKeyPair(options.stem, keys));
  std::printf("%s.key: keep it secret\n%s.pub: hand it out: %s\n", options.stem.c_str(), options.stem.c_str(),
              keys.public_key.c_str());
  return kExitDone;
}

}  // namespace

void AddKeys(CLI::App& app, Invocation& call) {
  CLI::App* command = nullptr;
  const auto options =
      AddCommand<Options>(app, call, "keys", "Makes a key pair for a fleet that listens on TCP",
                          "cairn keys worker1", Keys, &command);
  command->add_option("STEM", options->stem, "Writes STEM.key (secret) and STEM.pub")->required();
}

}  // namespace cairn::cli
