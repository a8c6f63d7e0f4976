#include "schema/wire/keys.h"

#include <cstdio>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "coordinator/cli/common/allow_list_file.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/home.h"
#include "coordinator/cli/common/invocation.h"
#include "schema/store/atomic_file.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct KeysArguments {
  std::string dir;
  std::string name;  // of a pair, or of a key on the list
  std::string key;   // the text, or a .pub file
  std::string roles;
  std::string until, limits;
  bool json = false;
};

fs::path Folder(const KeysArguments& options) {
  return options.dir.empty() ? fs::path(ConfigFolder()) : fs::path(options.dir);
}

// A key as a person gives it: its text, or the file that holds it.
std::string KeyOf(const std::string& given) {
  if (wire::IsPublicKey(given)) return given;
  if (!fs::exists(given)) throw InputError("'" + given + "' is neither a key of 40 characters nor a file");
  return Take(wire::ReadPublicKey(given));
}

int New(const KeysArguments& options, const Invocation&) {
  if (options.name.empty() || options.name.find('/') != std::string::npos || options.name[0] == '.' ||
      !WhatIsWrongWithName(options.name).empty())
    throw InputError("'" + EscapedName(options.name) +
                     "' is no name for a key pair; --dir says where it goes");
  std::error_code error;
  if (fs::create_directories(Folder(options), error))
    fs::permissions(Folder(options), fs::perms::owner_all, error);
  if (error) Throw(SystemFailure(Folder(options), "cannot make the folder", error.value()));
  const wire::KeyPair keys = wire::GenerateKeyPair();
  const std::string stem = (Folder(options) / options.name).string();
  Check(wire::WriteKeyPair(stem, keys));
  std::printf("%s.key: keep it secret\n%s.pub: hand it out: %s\n", stem.c_str(), stem.c_str(),
              keys.public_key.c_str());
  return kExitDone;
}

wire::AllowedKeys ReadList(const KeysArguments& options) {
  const fs::path list = Folder(options) / kAllowListName;
  return fs::exists(list) ? Take(wire::ReadAllowList(list)) : wire::AllowedKeys{};
}

std::map<std::string, std::string> OwnKeys(const KeysArguments& options) {
  std::map<std::string, std::string> keys;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(Folder(options), error))
    if (entry.path().extension() == ".pub")
      keys[entry.path().stem().string()] = Take(wire::ReadPublicKey(entry.path()));
  return keys;
}

int Show(const KeysArguments& options, const Invocation&) {
  if (!options.name.empty()) {
    std::printf("%s\n", Take(wire::ReadPublicKey(Folder(options) / (options.name + ".pub"))).c_str());
    return kExitDone;
  }
  nlohmann::ordered_json json = {{"keys", nlohmann::ordered_json::array()},
                                 {"allowed", nlohmann::ordered_json::array()}};
  std::string text = "keys in " + Folder(options).string() + ":\n";
  for (const auto& [name, key] : OwnKeys(options)) {
    json["keys"].push_back({{"name", name}, {"key", key}});
    text += "  " + key + "  " + Escaped(name) + "\n";
  }
  text += "allowed to connect to a coordinator with these keys:\n";
  for (const auto& [key, allowed] : ReadList(options)) {
    const std::string roles = wire::RoleText(allowed.roles);
    const std::string limits = wire::LimitText(allowed.limits);
    const bool over = allowed.limits.until_s != 0 && allowed.limits.until_s <= ::time(nullptr);
    json["allowed"].push_back(
        {{"key", key}, {"roles", roles}, {"limits", limits}, {"over", over}, {"name", allowed.name}});
    text += "  " + key + "  " + roles + (limits.empty() ? "" : "," + limits) + (over ? " (over)" : "") +
            "  " + allowed.name + "\n";
  }
  std::fputs(options.json ? (json.dump(2) + "\n").c_str() : text.c_str(), stdout);
  return kExitDone;
}

wire::KeyLimits LimitsIn(const KeysArguments& options) {
  std::string text = options.until.empty() ? "" : "until=" + options.until;
  if (!options.limits.empty()) text += (text.empty() ? "" : ",") + options.limits;
  const Result<wire::KeyLimits> limits = wire::ParseLimits(text);
  if (!limits.ok()) throw InputError(limits.status().message());
  if (limits.value().until_s != 0 && limits.value().until_s <= ::time(nullptr))
    throw InputError("--until: " + options.until + " is over; `cairn keys revoke` takes a key off the list");
  return limits.value();
}

int Allow(const KeysArguments& options, const Invocation&) {
  const Result<wire::Roles> roles = wire::ParseRoles(options.roles);
  if (!roles.ok()) throw InputError("--as: " + roles.status().message());
  const std::string key = KeyOf(options.key);
  const bool known = ReadList(options).contains(key);
  std::string name = options.name;
  if (name.empty() && fs::path(options.key).extension() == ".pub")
    name = fs::path(options.key).stem().string();
  const wire::KeyLimits limits = LimitsIn(options);
  const int same = AllowKey(Folder(options) / kAllowListName, key,
                            {.roles = roles.value(), .limits = limits, .name = name});
  const std::string text = wire::LimitText(limits);
  std::printf("%s %s as %s%s\n", known ? "changed" : "allowed", wire::ShortKey(key).c_str(),
              wire::RoleText(roles.value()).c_str(), text.empty() ? "" : (", " + text).c_str());
  if (same > 0 && roles.value().submitter)
    std::printf(
        "%d other key%s called '%s', too: each may end the jobs of the others (--name gives another)\n", same,
        same == 1 ? " is" : "s are", name.c_str());
  return kExitDone;
}

int Revoke(const KeysArguments& options, const Invocation&) {
  const std::string what = fs::path(options.key).extension() == ".pub" && fs::exists(options.key)
                               ? KeyOf(options.key)
                               : options.key;
  const int count = RevokeKeys(Folder(options) / kAllowListName, what);
  if (count == 0) throw InputError("'" + what + "' is not on the list (`cairn keys show`)");
  std::printf("revoked %d; a coordinator that runs refuses %s from its next message on\n", count,
              count == 1 ? "it" : "them");
  return kExitDone;
}

}  // namespace

void AddKeys(Command app, Invocation& call) {
  Command keys = app.AddCommand("keys", "Key pairs, and who may connect, for a fleet that listens on TCP");
  keys.Footer("Example:\n  cairn keys new coordinator\n  cairn keys allow desk.pub --as worker");
  keys.NeedsCommand();
  Command command;
  const auto add = [&](const char* name, const char* summary, const char* example,
                       int (*run)(const KeysArguments&, const Invocation&)) {
    auto options = AddCommand<KeysArguments>(keys, call, name, summary, example, run, &command);
    command.Add("--dir", options->dir, "Folder of keys ($XDG_CONFIG_HOME/cairn, or ~/.config/cairn)");
    return options;
  };
  auto options = add("new", "Makes a key pair: NAME.key stays here, NAME.pub is handed out",
                     "cairn keys new coordinator", New);
  command.Add("NAME", options->name, "coordinator, worker, client or what you like").Required();

  options = add("show", "The keys that are here, and those that are allowed", "cairn keys show", Show);
  command.Add("NAME", options->name, "Prints the public key of this pair alone");
  command.AddFlag("--json", options->json, "As JSON");

  options = add("allow", "Lets a key connect to the coordinator of this folder",
                "cairn keys allow desk.pub --as worker,viewer --name desk\n  "
                "cairn keys allow ann.pub --as submitter --until 2027-06-30 --limits jobs=20,requests=10",
                Allow);
  command.Add("KEY", options->key, "A public key, or the .pub file that holds it").Required();
  command.Add("--as", options->roles, "worker, submitter, admin, viewer; several with commas").Required();
  command.Add("--name", options->name, "What to call it, and whose jobs it submits (the file's name)");
  command.Add("--until", options->until,
              "The last day, YYYY-MM-DD of UTC, on which it is let in, or a moment, YYYY-MM-DDTHH:MM:SSZ");
  command.Add(
      "--limits", options->limits,
      "What it may have: connections=N, requests=N a second, jobs=N that have not ended, inputs-mb=N of "
      "such jobs, memory-mb=N of a task; several with commas");

  options = add("revoke", "Takes a key off the list; it is refused at its next message",
                "cairn keys revoke desk", Revoke);
  command.Add("KEY", options->key, "A public key, a .pub file, or a name on the list").Required();
}

}  // namespace cairn::cli
