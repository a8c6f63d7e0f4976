#include "coordinator/cli/common/allow_list_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/folder_lock.h"
#include "schema/store/atomic_file.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

std::string FirstWord(const std::string& line) {
  std::istringstream words(line);
  std::string word;
  words >> word;
  return word;
}

constexpr const char* kEnd = "end";  // schema/wire/allow_list.h

// All lines but the end and those of the keys in `gone`.
std::string LinesWithout(const fs::path& list, const wire::AllowedKeys& gone) {
  std::ifstream file(list);
  std::string kept;
  for (std::string line; std::getline(file, line);)
    if (const std::string first = FirstWord(line); first != kEnd && !gone.contains(first))
      kept += line + "\n";
  return kept;
}

wire::AllowedKeys Read(const fs::path& list) {
  return fs::exists(list) ? Take(wire::ReadAllowList(list)) : wire::AllowedKeys{};
}

// Whoever could read the list that is replaced, the coordinator above all, can read the new one.
FileRights RightsFor(const fs::path& list) {
  struct stat info{};
  if (::stat(list.c_str(), &info) != 0) return {::geteuid(), ::getegid(), 0600};
  return {info.st_uid, info.st_gid, info.st_mode & 0777};
}

// Of the lines of keys.
void Write(const fs::path& list, const std::string& text) {
  RemoveLeftoversOf(list);
  Check(WriteTextAtomically(list, text + kEnd + "\n", RightsFor(list)));
}

// Two that change the list at a time do so one after the other.
FolderLock Lock(const fs::path& folder) {
  if (!fs::is_directory(folder))
    throw InputError(folder.string() + ": no folder of keys (`cairn keys new` makes one)");
  return FolderLock(folder);
}

// What the coordinator reads where the list is a link to one that several share.
fs::path Target(const fs::path& list) {
  if (!fs::is_symlink(fs::symlink_status(list))) return list;
  if (!fs::exists(list)) throw InputError(list.string() + ": a link that leads nowhere");
  return fs::canonical(list);
}

}  // namespace

int AllowKey(const fs::path& named, const std::string& key, const wire::Allowed& allowed) {
  const std::string& name = allowed.name;
  // A line of its own would be another key.
  if (const std::string wrong = WhatIsWrongWithName(name); !wrong.empty())
    throw InputError("the name '" + EscapedName(name) + "' " + wrong + "; --name gives another");
  const fs::path list = Target(named);
  const FolderLock lock = Lock(list.parent_path());
  const wire::AllowedKeys before = Read(list);  // a list that is damaged is not made worse
  const std::string limits = wire::LimitText(allowed.limits);
  const std::string line = key + " " + wire::RoleText(allowed.roles) + (limits.empty() ? "" : "," + limits) +
                           (name.empty() ? "" : " " + name) + "\n";
  Write(list, LinesWithout(list, {{key, {}}}) + line);
  return static_cast<int>(std::ranges::count_if(before, [&](const auto& entry) {
    return entry.first != key && !name.empty() && entry.second.name == name;
  }));
}

int RevokeKeys(const fs::path& named, const std::string& key_or_name) {
  const fs::path list = Target(named);
  const FolderLock lock = Lock(list.parent_path());
  wire::AllowedKeys gone;
  for (const auto& [key, allowed] : Read(list))
    if (key == key_or_name || allowed.name == key_or_name) gone.emplace(key, allowed);
  if (!gone.empty()) Write(list, LinesWithout(list, gone));
  return static_cast<int>(gone.size());
}

}  // namespace cairn::cli
