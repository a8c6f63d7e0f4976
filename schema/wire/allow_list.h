// Who may do what: a file with a line for each public key that may connect, and one that says `end`,
//
//   KEY ROLE[,ROLE][,LIMIT=VALUE] [what it is called]
//   end
//
// where a role is worker, submitter, admin or viewer, and a limit what KeyLimits has. Empty lines and lines
// that begin with '#' are remarks. Without its end a list is taken for one that is being written: a part of a
// list neither revokes a key nor lets one in.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schema/error.h"

namespace cairn::wire {

struct Roles {
  bool worker = false;     // computes tasks
  bool submitter = false;  // submits jobs, and changes its own; is a viewer too
  bool viewer = false;     // sees jobs and their results
  bool admin = false;      // changes anybody's jobs; is a submitter too

  bool operator==(const Roles&) const = default;
};

// "worker,viewer" and back. kCorrupt where a word is no role.
Result<Roles> ParseRoles(const std::string& text);
std::string RoleText(const Roles& roles);

// What one key may have. 0: as much as there is.
struct KeyLimits {
  std::int64_t until_s = 0;       // until=2027-01-31 (to the end of that day), or 2027-01-31T12:00:00Z: then
                                  // it is refused. Seconds since 1970, of UTC
  std::uint64_t connections = 0;  // connections=4: at a time
  std::uint64_t requests = 0;     // requests=10: a second, and ten times as many at once
  std::uint64_t jobs = 0;         // jobs=20: that have not ended, of all keys of the same name
  std::uint64_t inputs_mb = 0;    // inputs-mb=5000: that jobs which are not done hold, of those keys
  std::uint64_t memory_mb = 0;    // memory-mb=4000: of a task

  bool operator==(const KeyLimits&) const = default;
  // What is not limited here is as in `defaults`.
  KeyLimits Or(const KeyLimits& defaults) const;
};

// "until=2027-01-31,jobs=20" and back. kCorrupt: what is no limit, or stands there twice.
Result<KeyLimits> ParseLimits(const std::string& text);
std::string LimitText(const KeyLimits& limits);
// "2027-01-31", or with the time of day where that is not its end.
std::string UntilText(std::int64_t until_s);

struct Allowed {
  Roles roles;
  KeyLimits limits;
  std::string name;  // for people, and whose jobs are whose; may be empty

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
  // where what it says, or whether it can be read, has changed, or a key's time has come. While it cannot be
  // read, the last good one holds, and it is tried again at each call.
  bool Refresh();
  const Status& status() const { return status_; }  // of the last reading
  bool WasRead() const { return was_read_; }        // once at least: else nobody is on it
  // Null: not on the list, or its time was over at the last Refresh.
  const Allowed* Find(const std::string& key) const;
  bool IsOver(const std::string& key) const;  // on the list, and its time is over
  // Those whose time ends within so many seconds, the first first.
  std::vector<std::pair<std::int64_t, std::string>> Ending(std::int64_t within_s) const;

 private:
  using Stamp = std::array<std::int64_t, 6>;  // differs where the file was written or replaced
  bool ReadAgain();

  std::filesystem::path path_;
  std::optional<Stamp> stamp_;
  bool settled_ = false;  // read well, and so long after its last change that another would show
  bool was_read_ = false;
  Status status_;
  AllowedKeys keys_;
  std::int64_t now_s_ = 0, next_end_s_ = 0;  // of the last Refresh; the next key's time to end, after that
};

}  // namespace cairn::wire
