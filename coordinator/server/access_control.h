// Whether the sender of a message may say it: its key's roles against the table of rights.h, and whether it
// is who it claims to be. No sockets, no clock.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>

#include "coordinator/core/fleet.h"
#include "coordinator/server/rights.h"
#include "schema/wire/allow_list.h"
#include "schema/wire/limits.h"
#include "schema/wire/refusal.h"

namespace cairn::coordinator {

struct TooOften {
  std::string why;
  double again_s = 0;  // after which it may be asked again
};

// One for each coordinator. Without an allow list whoever reaches the socket may do all: it lies in a folder
// that nobody else may enter (schema/wire/endpoint.h).
class AccessControl {
 public:
  // `allow_list`: empty: none. `defaults`: of keys that say nothing else, and are no administrator's.
  explicit AccessControl(const std::filesystem::path& allow_list, const wire::KeyLimits& defaults = {});

  // Before messages that have come are looked at: takes note of a list that was changed. True where it was.
  bool Refresh() { return list_ && list_->Refresh(); }
  // What people must know of a list that cannot be read now; empty: nothing.
  std::string Warning() const;
  // The same of keys whose time ends within a fortnight.
  std::string EndWarning() const;
  // Null where `user` may say this through `peer`. A Hello binds the connection, and the worker (host and
  // process) that it names, to the user's key.
  std::optional<wire::Refusal> Check(const std::string& peer, const std::string& user,
                                     const wire::Envelope& envelope, const Fleet& fleet);
  // Null where the key may ask this now, too: it asks no more often than it may.
  std::optional<TooOften> AsksTooOften(const std::string& user, const wire::Envelope& envelope, double now_s);
  // Of a key, or, where there are none, of whoever asks: nothing is limited.
  wire::KeyLimits LimitsOf(const std::string& user) const;
  // What that key is called; none where there are no keys.
  std::optional<std::string> NameOnList(const std::string& user) const;
  // "desk (Yx8f…)": who has that key, for a log; empty where there are no keys.
  std::string NameOf(const std::string& user) const;
  // Whose jobs are those that `user` submits: what its key is called, or, where it has no name, that key.
  // Without keys whoever starts the coordinator.
  std::string OwnerOf(const std::string& user) const;
  bool MaySubmit(const std::string& user) const;
  // Whether `user`, who may submit, may command a job of `owner`; where that is empty, it is nobody's.
  bool MayCommand(const std::string& user, const std::string& owner) const;
  // Whether the key that a worker's connection is bound to may still work.
  bool MayWork(const std::string& peer) const;

 private:
  std::optional<wire::Refusal> CheckIdentity(const std::string& peer, const std::string& user,
                                             const wire::Envelope& envelope, const Fleet& fleet);

  std::optional<wire::AllowList> list_;
  struct Rate {
    std::uint64_t per_s = 0;
    wire::Bucket bucket;
  };
  const wire::KeyLimits defaults_;
  std::unordered_map<std::string, std::string> workers_;  // the key that it is bound to, by peer
  std::map<std::string, Rate> rates_;                     // by user
};

}  // namespace cairn::coordinator
