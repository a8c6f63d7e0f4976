// Who may do what: a file with a line for each public key that may connect, and one that says `end`,
//
//   KEY ROLE[,ROLE] [what it is called]
//   end
//
// where a role is worker, submitter or viewer. Empty lines and lines that begin with '#' are remarks. Without
// its end a list is taken for one that is being written: a part of a list neither revokes a key nor lets one
// in.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "schema/error.h"

namespace cairn::wire {

struct Roles {
  bool worker = false;     // computes tasks
  bool submitter = false;  // submits jobs, and changes them; is a viewer too
  bool viewer = false;     // sees jobs and their results

  bool operator==(const Roles&) const = default;
};

// "worker,viewer" and back. kCorrupt where a word is no role.
Result<Roles> ParseRoles(const std::string& text);
std::string RoleText(const Roles& roles);

struct Allowed {
  Roles roles;
  std::string name;  // for people; may be empty

  bool operator==(const Allowed&) const = default;
};
using AllowedKeys = std::map<std::string, Allowed>;  // by public key

// kNotFound, kCorrupt (names the line, or the end that is missing), kRefused where others than its owner may
// write it.
Result<AllowedKeys> ReadAllowList(const std::filesystem::path& path);

// The list as it was when it could last be read. For one thread.
class AllowList {
 public:
  explicit AllowList(std::filesystem::path path) : path_(std::move(path)) { Refresh(); }

  // Reads the file again where it may have changed since the last call (one stat where it has not); true
  // where what it says, or whether it can be read, has changed. While it cannot be read, the last good one
  // holds, and it is tried again at each call.
  bool Refresh();
  const Status& status() const { return status_; }  // of the last reading
  bool WasRead() const { return was_read_; }        // once at least: else nobody is on it
  // Null: not on the list.
  const Allowed* Find(const std::string& key) const;

 private:
  using Stamp = std::array<std::int64_t, 6>;  // differs where the file was written or replaced

  std::filesystem::path path_;
  std::optional<Stamp> stamp_;
  bool settled_ = false;  // read well, and so long after its last change that another would show
  bool was_read_ = false;
  Status status_;
  AllowedKeys keys_;
};

}  // namespace cairn::wire
