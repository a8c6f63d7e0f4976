// Changes to a list of allowed keys (schema/wire/allow_list.h): one line at a time, the others stay as they
// are, and so do the list's owner, group and mode. Of a link it is the list behind it that changes.
#pragma once

#include <filesystem>
#include <string>

#include "schema/wire/allow_list.h"

namespace cairn::cli {

// The name of the list in a folder of keys.
inline constexpr const char* kAllowListName = "allowed";

// Lets `key` in, or changes what it may where it is on the list already; makes the list where there is none.
// Returns how many other keys have its name, if it has one.
// Throws InputError or WorldError.
int AllowKey(const std::filesystem::path& list, const std::string& key, const wire::Allowed& allowed);
// Takes off the key, or those of that name; returns how many there were.
// Throws InputError or WorldError.
int RevokeKeys(const std::filesystem::path& list, const std::string& key_or_name);

}  // namespace cairn::cli
