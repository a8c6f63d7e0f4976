#include "schema/wire/allow_list.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "schema/wire/keys.h"

namespace cairn::wire {
namespace {

bool* Find(Roles& roles, const std::string& word) {
  if (word == "worker") return &roles.worker;
  if (word == "submitter") return &roles.submitter;
  return word == "viewer" ? &roles.viewer : nullptr;
}

std::string Trim(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// Whoever can write it can let himself in.
Status CheckOwner(const std::filesystem::path& path) {
  struct stat info{};
  if (::stat(path.c_str(), &info) != 0) return {Code::kNotFound, path.string() + ": " + std::strerror(errno)};
  if ((info.st_mode & 022) != 0 || (info.st_uid != ::geteuid() && info.st_uid != 0)) {
    return {Code::kRefused, path.string() + ": others can write this list; chmod go-w it"};
  }
  return Status::Ok();
}

// Says what is wrong with a line; empty: nothing, also of one that is empty or a remark.
std::string ReadLine(const std::string& line, AllowedKeys& keys) {
  std::istringstream words(line);
  std::string key, role_words, name;
  if (!(words >> key)) return "";
  if (!IsPublicKey(key)) return key.starts_with('#') ? "" : "not a key of 40 characters";
  words >> role_words;
  const Result<Roles> roles = ParseRoles(role_words);
  if (!roles.ok()) return roles.status().message();
  std::getline(words, name);
  if (!keys.emplace(key, Allowed{roles.value(), Trim(name)}).second) return "this key was given already";
  return "";
}

}  // namespace

Result<Roles> ParseRoles(const std::string& text) {
  Roles roles;
  std::istringstream words(text);
  bool any = false;
  for (std::string word; std::getline(words, word, ','); any = true) {
    bool* role = Find(roles, word);
    if (role == nullptr) {
      any = false;
      break;
    }
    *role = true;
  }
  if (!any)
    return Status(Code::kCorrupt, "'" + text + "' are no roles: worker, submitter, viewer, with commas");
  if (roles.submitter) roles.viewer = true;
  return roles;
}

std::string RoleText(const Roles& roles) {
  std::string text = roles.worker ? "worker" : "";
  if (roles.submitter) text += text.empty() ? "submitter" : ",submitter";
  if (roles.viewer && !roles.submitter) text += text.empty() ? "viewer" : ",viewer";
  return text;
}

Result<AllowedKeys> ReadAllowList(const std::filesystem::path& path) {
  if (Status status = CheckOwner(path); !status.ok()) return status;
  std::ifstream file(path);
  if (!file) return Status(Code::kNotFound, path.string() + ": " + std::strerror(errno));
  AllowedKeys keys;
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    const std::string wrong = ReadLine(line, keys);
    if (!wrong.empty())
      return Status(Code::kCorrupt, path.string() + ":" + std::to_string(number) + ": " + wrong);
  }
  return keys;
}

bool AllowList::Refresh() {
  struct stat info{};
  Stamp stamp{};
  if (::stat(path_.c_str(), &info) == 0) {
    stamp = {static_cast<std::int64_t>(info.st_dev),
             static_cast<std::int64_t>(info.st_ino),
             info.st_size,
             info.st_mtim.tv_sec * 1'000'000'000 + info.st_mtim.tv_nsec,
             info.st_ctim.tv_sec * 1'000'000'000 + info.st_ctim.tv_nsec,
             info.st_mode};
  }
  if (stamp == stamp_) return false;
  stamp_ = stamp;
  Result<AllowedKeys> keys = ReadAllowList(path_);
  status_ = keys.status();
  keys_ = keys.ok() ? std::move(keys).value() : AllowedKeys{};
  return true;
}

const Allowed* AllowList::Find(const std::string& key) const {
  const auto it = keys_.find(key);
  return it == keys_.end() ? nullptr : &it->second;
}

}  // namespace cairn::wire
