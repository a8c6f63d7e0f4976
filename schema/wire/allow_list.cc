#include "schema/wire/allow_list.h"

#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string_view>

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
  if (!S_ISREG(info.st_mode)) return {Code::kRefused, path.string() + ": not a file"};
  if ((info.st_mode & 022) != 0)
    return {Code::kRefused, path.string() + ": others can write this list; chmod go-w it"};
  if (info.st_uid != ::geteuid() && info.st_uid != 0)
    return {Code::kRefused, path.string() + ": this list belongs to user " + std::to_string(info.st_uid) +
                                ", who can write it; do this as that user, or chown it"};
  return Status::Ok();
}

constexpr std::string_view kEnd = "end";
constexpr std::int64_t kSettled_ns =
    1'000'000'000;  // far more than a tick of the clock that files are dated by

bool IsRemark(const std::string& line) {
  const std::string text = Trim(line);
  return text.empty() || text.starts_with('#');
}

std::int64_t Now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  return now.tv_sec * 1'000'000'000 + now.tv_nsec;
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
  constexpr std::uintmax_t kMostBytes = 16 << 20;  // a hundred thousand keys
  std::error_code unknown;
  if (const std::uintmax_t bytes = std::filesystem::file_size(path, unknown); !unknown && bytes > kMostBytes)
    return Status(Code::kCorrupt, path.string() + ": larger than 16 MB: this is no list of keys");
  AllowedKeys keys;
  int number = 0;
  bool ended = false;
  for (std::string line; std::getline(file, line);) {
    ++number;
    std::string wrong = Trim(line) == kEnd ? "a second 'end'" : ReadLine(line, keys);
    if (Trim(line) == kEnd && !ended) {
      wrong.clear();
      ended = true;
    } else if (wrong.empty() && ended && !IsRemark(line)) {
      wrong = "a key after the end; 'end' must be the last line";
    }
    if (!wrong.empty())
      return Status(Code::kCorrupt, path.string() + ":" + std::to_string(number) + ": " + wrong);
  }
  if (!ended)
    return Status(Code::kCorrupt, path.string() +
                                      ": it has no end, so it may be half-written; where it is whole, "
                                      "make 'end' its last line");
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
  if (stamp == stamp_ && settled_) return false;
  stamp_ = stamp;
  Result<AllowedKeys> keys = ReadAllowList(path_);
  // What is changed again within a tick of the clock may look the same.
  settled_ = keys.ok() && Now_ns() - stamp[4] > kSettled_ns;
  bool changed = keys.status().message() != status_.message();
  status_ = keys.status();
  if (!keys.ok()) return changed;
  changed = changed || !was_read_ || keys.value() != keys_;
  was_read_ = true;
  keys_ = std::move(keys).value();
  return changed;
}

const Allowed* AllowList::Find(const std::string& key) const {
  const auto it = keys_.find(key);
  return it == keys_.end() ? nullptr : &it->second;
}

}  // namespace cairn::wire
