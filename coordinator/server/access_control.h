// Whether the sender of a message may say it: its key's roles against the table of rights.h, and whether it
// is who it claims to be. No sockets, no clock.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "coordinator/core/fleet.h"
#include "coordinator/server/rights.h"
#include "schema/wire/allow_list.h"
#include "schema/wire/refusal.h"

namespace cairn::coordinator {

// One for each coordinator. Without an allow list whoever reaches the socket may do all: it lies in a folder
// that nobody else may enter (schema/wire/endpoint.h).
class AccessControl {
 public:
  explicit AccessControl(const std::filesystem::path& allow_list);  // empty: none

  // Before messages that have come are looked at: takes note of a list that was changed. True where it was.
  bool Refresh() { return list_ && list_->Refresh(); }
  // What people must know of a list that cannot be read now; empty: nothing.
  std::string Warning() const;
  // Null where `user` may say this through `peer`. A Hello binds the connection, and the worker (host and
  // process) that it names, to the user's key.
  std::optional<wire::Refusal> Check(const std::string& peer, const std::string& user,
                                     const wire::Envelope& envelope, const Fleet& fleet);
  // What that key is called; none where there are no keys.
  std::optional<std::string> NameOnList(const std::string& user) const;
  // "desk (Yx8f…)": who has that key, for a log; empty where there are no keys.
  std::string NameOf(const std::string& user) const;
  // Whether the key that a worker's connection is bound to may still work.
  bool MayWork(const std::string& peer) const;

 private:
  struct Bound {
    std::string user;
    std::uint64_t process =
        0;  // Hello.process: a host's name and a process id two workers may have in common
  };
  std::optional<wire::Refusal> CheckIdentity(const std::string& peer, const std::string& user,
                                             const wire::Envelope& envelope, const Fleet& fleet);

  std::optional<wire::AllowList> list_;
  std::map<std::string, Bound> workers_;  // by peer
};

}  // namespace cairn::coordinator
