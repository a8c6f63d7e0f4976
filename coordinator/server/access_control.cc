#include "coordinator/server/access_control.h"

#include <pwd.h>
#include <unistd.h>

#include <array>
#include <utility>

#include "schema/text.h"
#include "schema/wire/codec.h"
#include "schema/wire/keys.h"

namespace cairn::coordinator {
namespace {

constexpr std::size_t kSpareBindings = 64;

bool Has(const wire::Roles& roles, Right right) {
  switch (right) {
    case Right::kWork:
      return roles.worker;
    case Right::kSubmit:
      return roles.submitter;
    case Right::kView:
      return roles.viewer;
  }
  return false;
}

std::string What(const wire::Envelope& envelope) {
  const std::string kind = wire::KindName(envelope);
  const std::string& action =
      envelope.has_workers() ? envelope.workers().action() : envelope.query().action();
  return action.empty() ? kind : "'" + action + "'";
}

}  // namespace

AccessControl::AccessControl(const std::filesystem::path& allow_list, const wire::KeyLimits& defaults)
    : defaults_(defaults) {
  if (!allow_list.empty()) list_.emplace(allow_list);
}

std::optional<wire::Refusal> AccessControl::Check(const std::string& peer, const std::string& user,
                                                  const wire::Envelope& envelope, const Fleet& fleet) {
  using wire::RefusalKind;
  std::optional<Right> right = RightNeeded(envelope);
  if (!right && (envelope.has_query() || envelope.has_workers()))
    right = Right::kView;  // it is told which actions there are
  if (!right)
    return wire::Refusal{RefusalKind::kRight, "'" + What(envelope) + "' is no message for a coordinator"};
  if (list_) {
    const wire::Allowed* allowed = list_->Find(user);
    if (allowed == nullptr)
      return wire::Refusal{RefusalKind::kRevoked,
                           list_->IsOver(user) ? "this key's time is over: its owner needs a new one, or "
                                                 "is allowed for longer (cairn keys allow --until)"
                                               : "this key was taken off the list"};
    if (!Has(allowed->roles, *right))
      return wire::Refusal{RefusalKind::kRight,
                           What(envelope) + " is not for a " + wire::RoleText(allowed->roles)};
  }
  return list_ && right == Right::kWork ? CheckIdentity(peer, user, envelope, fleet) : std::nullopt;
}

std::optional<wire::Refusal> AccessControl::CheckIdentity(const std::string& peer, const std::string& user,
                                                          const wire::Envelope& envelope,
                                                          const Fleet& fleet) {
  const auto bound = workers_.find(peer);
  if (bound != workers_.end() && bound->second != user && fleet.Knows(peer))
    return wire::Refusal{wire::RefusalKind::kIdentity,
                         "this connection's name is that of a worker with another key"};
  if (!envelope.has_hello()) return std::nullopt;
  const wire::Hello& hello = envelope.hello();
  if (const Worker* same = fleet.FindProcess(hello); same != nullptr) {
    const auto other = workers_.find(same->peer);
    if (other != workers_.end() && other->second != user)
      return wire::Refusal{wire::RefusalKind::kIdentity, "worker " + std::to_string(hello.pid()) + " on " +
                                                             hello.host() + " is connected with another key"};
  }
  // Not with each Hello: ten thousand come at once.
  if (workers_.size() > kSpareBindings + 2 * fleet.size())
    std::erase_if(workers_, [&](const auto& entry) { return !fleet.Knows(entry.first); });
  workers_[peer] = user;
  return std::nullopt;
}

std::string AccessControl::Warning() const {
  if (!list_ || list_->status().ok()) return "";
  return (list_->WasRead()
              ? "the list of keys cannot be read; the last good one holds, and nothing is revoked: "
              : "nobody is let in until the list of keys can be read: ") +
         list_->status().message();
}

std::string AccessControl::EndWarning() const {
  constexpr std::int64_t kFortnight_s = 14 * 86'400;
  constexpr std::size_t kMostNamed = 3;
  const auto ending = list_ ? list_->Ending(kFortnight_s) : decltype(list_->Ending(0)){};
  std::string text;
  for (std::size_t i = 0; i < std::min(ending.size(), kMostNamed); ++i)
    text += (i == 0 ? "the key of " : ", of ") + NameOf(ending[i].second) + " is good until " +
            wire::UntilText(ending[i].first);
  return ending.size() <= kMostNamed ? text
                                     : text + ", and " + std::to_string(ending.size() - kMostNamed) + " more";
}

wire::KeyLimits AccessControl::LimitsOf(const std::string& user) const {
  const wire::Allowed* allowed = list_ ? list_->Find(user) : nullptr;
  if (allowed == nullptr) return {};
  return allowed->roles.admin ? allowed->limits : allowed->limits.Or(defaults_);
}

// Pieces of an upload come at the pace that they are asked for, and what workers say is no request.
std::optional<TooOften> AccessControl::AsksTooOften(const std::string& user, const wire::Envelope& envelope,
                                                    double now_s) {
  constexpr double kBurst_s = 10;
  if (!list_ || envelope.has_piece() || RightNeeded(envelope) == Right::kWork) return std::nullopt;
  const std::uint64_t per_s = LimitsOf(user).requests;
  if (per_s == 0) return std::nullopt;
  const auto rate_of = [&] {
    const auto many = static_cast<double>(per_s);
    return Rate{per_s, wire::Bucket(many, kBurst_s * many)};
  };
  const auto it = rates_.try_emplace(user, rate_of()).first;
  if (it->second.per_s != per_s) it->second = rate_of();
  if (it->second.bucket.Take(now_s)) return std::nullopt;
  return TooOften{"the key of " + NameOf(user) + " asks more than " + std::to_string(per_s) +
                      " times a second (requests=" + std::to_string(per_s) + "); ask again, less often",
                  it->second.bucket.Wait(now_s)};
}

bool AccessControl::MayWork(const std::string& peer) const {
  const auto bound = workers_.find(peer);
  if (!list_ || bound == workers_.end()) return true;
  const wire::Allowed* allowed = list_->Find(bound->second);
  return allowed != nullptr && allowed->roles.worker;
}

std::optional<std::string> AccessControl::NameOnList(const std::string& user) const {
  if (!list_ || user.empty()) return std::nullopt;
  const wire::Allowed* allowed = list_->Find(user);
  return allowed == nullptr ? "" : allowed->name;
}

// Without keys the socket lies in a folder of the user's own: nobody else comes through it.
std::string AccessControl::OwnerOf(const std::string& user) const {
  if (!list_) {
    std::array<char, 4096> text{};
    passwd entry{}, *found = nullptr;
    const bool known = ::getpwuid_r(::geteuid(), &entry, text.data(), text.size(), &found) == 0 && found;
    return Printable(known ? entry.pw_name : std::to_string(::geteuid()), kMostNameBytes);
  }
  const std::string name = Printable(NameOnList(user).value_or(""), kMostNameBytes);
  return name.empty() ? user : name;
}

bool AccessControl::MaySubmit(const std::string& user) const {
  const wire::Allowed* allowed = list_ ? list_->Find(user) : nullptr;
  return !list_ || (allowed != nullptr && Has(allowed->roles, Right::kSubmit));
}

bool AccessControl::MayCommand(const std::string& user, const std::string& owner) const {
  const wire::Allowed* allowed = list_ ? list_->Find(user) : nullptr;
  if (!list_ || (allowed != nullptr && allowed->roles.admin)) return true;
  return !owner.empty() && owner == OwnerOf(user);
}

std::string AccessControl::NameOf(const std::string& user) const {
  const std::optional<std::string> listed = NameOnList(user);
  if (!listed) return "";
  const std::string name = Printable(*listed, kMostNameBytes);
  return name.empty() ? wire::ShortKey(user) : name + " (" + wire::ShortKey(user) + ")";
}

}  // namespace cairn::coordinator
