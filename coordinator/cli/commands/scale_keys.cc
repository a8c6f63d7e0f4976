#include "coordinator/cli/commands/scale_keys.h"

#include <exception>
#include <functional>

#include "coordinator/cli/common/allow_list_file.h"
#include "schema/wire/keys.h"

namespace cairn::cli {
namespace {

cairn::Status Tried(const std::function<void()>& change) {
  try {
    change();
  } catch (const std::exception& error) {
    return {Code::kIo, error.what()};
  }
  return cairn::Status::Ok();
}

}  // namespace

Result<std::vector<std::string>> ListedKeys::Names() {
  const Result<wire::AllowedKeys> allowed = wire::ReadAllowList(list_);
  if (!allowed.ok()) return allowed.status();
  std::vector<std::string> names;
  for (const auto& [key, entry] : allowed.value())
    if (entry.name.starts_with(prefix_)) names.push_back(entry.name);
  return names;
}

// First on the list: of one that is not there a file would be a secret that nobody can use, or revoke.
cairn::Status ListedKeys::Make(const std::string& name) {
  const wire::KeyPair keys = wire::GenerateKeyPair();
  if (cairn::Status listed = Tried(
          [&] { AllowKey(list_, keys.public_key, {.roles = {.worker = true}, .limits = {}, .name = name}); });
      !listed.ok())
    return listed;
  cairn::Status written = wire::WriteKeyPair(folder_ / name, keys);
  if (!written.ok()) static_cast<void>(Revoke(name));
  return written;
}

cairn::Status ListedKeys::Revoke(const std::string& name) {
  std::error_code ignored;
  for (const char* ending : {".key", ".pub"}) std::filesystem::remove(folder_ / (name + ending), ignored);
  return Tried([&] { RevokeKeys(list_, name); });
}

}  // namespace cairn::cli
