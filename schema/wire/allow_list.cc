#include "schema/wire/allow_list.h"

#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <ctime>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>

#include "schema/wire/keys.h"

namespace cairn::wire {
namespace {

bool* Find(Roles& roles, const std::string& word) {
  if (word == "worker") return &roles.worker;
  if (word == "submitter") return &roles.submitter;
  if (word == "admin") return &roles.admin;
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

struct KeyLimit {
  const char* name;
  std::uint64_t KeyLimits::* value;
};
constexpr std::array kKeyLimits = {
    KeyLimit{"connections", &KeyLimits::connections},
    KeyLimit{"requests", &KeyLimits::requests},
    KeyLimit{"jobs", &KeyLimits::jobs},
    KeyLimit{"inputs-mb", &KeyLimits::inputs_mb},
    KeyLimit{"memory-mb", &KeyLimits::memory_mb},
};
constexpr const char* kDay = "%Y-%m-%d";
constexpr const char* kMoment = "%Y-%m-%dT%H:%M:%SZ";
constexpr std::int64_t kDay_s = 86'400;

std::string Format(std::int64_t utc_s, const char* format) {
  const std::time_t seconds = utc_s;
  std::tm utc{};
  std::array<char, 64> text{};
  ::gmtime_r(&seconds, &utc);
  return {text.data(), std::strftime(text.data(), text.size(), format, &utc)};
}

// 0: it is none.
std::int64_t ParseUntil(const std::string& text) {
  for (const char* format : {kDay, kMoment}) {
    std::tm utc{};
    const char* end = ::strptime(text.c_str(), format, &utc);
    if (end == nullptr || *end != '\0') continue;
    const std::int64_t seconds = ::timegm(&utc);
    if (seconds <= 0 || Format(seconds, format) != text) return 0;  // the 31st of February
    return format == kDay ? seconds + kDay_s : seconds;
  }
  return 0;
}

bool ParseLimit(const std::string& word, KeyLimits& limits) {
  constexpr std::uint64_t kMost = 1'000'000'000;
  const std::size_t equals = word.find('=');
  const std::string name = word.substr(0, equals), value = word.substr(equals + 1);
  if (name == "until") {
    if (limits.until_s != 0) return false;
    limits.until_s = ParseUntil(value);
    return limits.until_s != 0;
  }
  for (const KeyLimit& limit : kKeyLimits) {
    if (name != limit.name || limits.*limit.value != 0) continue;
    std::uint64_t number = 0;
    const auto [end, failed] = std::from_chars(value.data(), value.data() + value.size(), number);
    limits.*limit.value = number;
    return failed == std::errc{} && end == value.data() + value.size() && number >= 1 && number <= kMost;
  }
  return false;
}

// "worker,jobs=3" in two.
std::pair<std::string, std::string> RolesAndLimits(const std::string& text) {
  std::string roles, limits;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    std::string& part = word.find('=') == std::string::npos ? roles : limits;
    part += (part.empty() ? "" : ",") + word;
  }
  return {roles, limits};
}

// Says what is wrong with a line; empty: nothing, also of one that is empty or a remark.
std::string ReadLine(const std::string& line, AllowedKeys& keys) {
  std::istringstream words(line);
  std::string key, role_words, name;
  if (!(words >> key)) return "";
  if (!IsPublicKey(key)) return key.starts_with('#') ? "" : "not a key of 40 characters";
  words >> role_words;
  const auto [role_part, limit_part] = RolesAndLimits(role_words);
  const Result<Roles> roles = ParseRoles(role_part);
  if (!roles.ok()) return roles.status().message();
  const Result<KeyLimits> limits = ParseLimits(limit_part);
  if (!limits.ok()) return limits.status().message();
  std::getline(words, name);
  if (!keys.emplace(key, Allowed{roles.value(), limits.value(), Trim(name)}).second)
    return "this key was given already";
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
    return Status(Code::kCorrupt,
                  "'" + text + "' are no roles: worker, submitter, admin, viewer, with commas");
  if (roles.admin) roles.submitter = true;
  if (roles.submitter) roles.viewer = true;
  return roles;
}

std::string RoleText(const Roles& roles) {
  std::string text = roles.worker ? "worker" : "";
  if (roles.submitter) text += (text.empty() ? "" : ",") + std::string(roles.admin ? "admin" : "submitter");
  if (roles.viewer && !roles.submitter) text += text.empty() ? "viewer" : ",viewer";
  return text;
}

KeyLimits KeyLimits::Or(const KeyLimits& defaults) const {
  KeyLimits limits = *this;
  for (const KeyLimit& limit : kKeyLimits)
    if (limits.*limit.value == 0) limits.*limit.value = defaults.*limit.value;
  if (limits.until_s == 0) limits.until_s = defaults.until_s;
  return limits;
}

Result<KeyLimits> ParseLimits(const std::string& text) {
  KeyLimits limits;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');)
    if (!ParseLimit(word, limits))
      return Status(Code::kCorrupt, "'" + word +
                                        "' is no limit, or a second one: until=YYYY-MM-DD, and connections, "
                                        "requests, jobs, inputs-mb, memory-mb, each =NUMBER, with commas");
  return limits;
}

std::string UntilText(std::int64_t until_s) {
  return until_s % kDay_s == 0 ? Format(until_s - kDay_s, kDay) : Format(until_s, kMoment);
}

std::string LimitText(const KeyLimits& limits) {
  std::string text = limits.until_s == 0 ? "" : "until=" + UntilText(limits.until_s);
  for (const KeyLimit& limit : kKeyLimits)
    if (const std::uint64_t value = limits.*limit.value; value != 0)
      text += (text.empty() ? "" : ",") + std::string(limit.name) + "=" + std::to_string(value);
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
  constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  const bool changed = ReadAgain();
  now_s_ = Now_ns() / 1'000'000'000;
  const bool came = now_s_ >= next_end_s_;
  if (!changed && !came) return false;
  const bool of_a_key = came && next_end_s_ != 0;
  next_end_s_ = kNever;
  for (const auto& [key, allowed] : keys_)
    if (allowed.limits.until_s > now_s_) next_end_s_ = std::min(next_end_s_, allowed.limits.until_s);
  return changed || of_a_key;
}

bool AllowList::ReadAgain() {
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
  return it == keys_.end() || IsOver(key) ? nullptr : &it->second;
}

bool AllowList::IsOver(const std::string& key) const {
  const auto it = keys_.find(key);
  return it != keys_.end() && it->second.limits.until_s != 0 && it->second.limits.until_s <= now_s_;
}

std::vector<std::pair<std::int64_t, std::string>> AllowList::Ending(std::int64_t within_s) const {
  std::vector<std::pair<std::int64_t, std::string>> ending;
  for (const auto& [key, allowed] : keys_)
    if (const std::int64_t until_s = allowed.limits.until_s; until_s > now_s_ && until_s - now_s_ <= within_s)
      ending.emplace_back(until_s, key);
  std::ranges::sort(ending);
  return ending;
}

}  // namespace cairn::wire
