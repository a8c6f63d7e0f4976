// Changes to a list of allowed keys (schema/wire/allow_list.h): one line at a time, the others stay as they
// are, and so do the list's owner, group and mode. Of a link it is the list behind it that changes.
#pragma once

#include <filesystem>
#include <string>

#include "schema/wire/allow_list.h"

namespace cairn::cli {

// The name of the list in a folder of keys.
inline constexpr const char* kAllowListName = "allowed";

// Lets `key` in as `roles`, or gives it these where it is on the list already; makes the list where there is
// none.
// Throws InputError or WorldError.
void AllowKey(const std::filesystem::path& list, const std::string& key, const wire::Roles& roles,
              const std::string& name);
// Takes off the key, or those of that name; returns how many there were.
// Throws InputError or WorldError.
int RevokeKeys(const std::filesystem::path& list, const std::string& key_or_name);

}  // namespace cairn::cli
