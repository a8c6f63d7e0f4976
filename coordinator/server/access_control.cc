#include "coordinator/server/access_control.h"

#include <utility>

#include "schema/text.h"
#include "schema/wire/codec.h"
#include "schema/wire/keys.h"

namespace cairn::coordinator {
namespace {

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

AccessControl::AccessControl(const std::filesystem::path& allow_list) {
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
    if (allowed == nullptr) return wire::Refusal{RefusalKind::kRevoked, "this key was taken off the list"};
    if (!Has(allowed->roles, *right))
      return wire::Refusal{RefusalKind::kRight,
                           What(envelope) + " is not for a " + wire::RoleText(allowed->roles)};
  }
  return right == Right::kWork ? CheckIdentity(peer, user, envelope, fleet) : std::nullopt;
}

std::optional<wire::Refusal> AccessControl::CheckIdentity(const std::string& peer, const std::string& user,
                                                          const wire::Envelope& envelope,
                                                          const Fleet& fleet) {
  const auto bound = workers_.find(peer);
  if (bound != workers_.end() && bound->second.user != user && fleet.Knows(peer))
    return wire::Refusal{wire::RefusalKind::kIdentity,
                         "this connection's name is that of a worker with another key"};
  if (!envelope.has_hello()) return std::nullopt;
  const wire::Hello& hello = envelope.hello();
  std::erase_if(workers_, [&](const auto& entry) { return !fleet.Knows(entry.first); });
  for (const auto& [other, worker] : workers_)
    if (hello.process() != 0 && worker.process == hello.process() && worker.user != user)
      return wire::Refusal{wire::RefusalKind::kIdentity, "worker " + std::to_string(hello.pid()) + " on " +
                                                             hello.host() + " is connected with another key"};
  workers_[peer] = {user, hello.process()};
  return std::nullopt;
}

std::string AccessControl::Warning() const {
  if (!list_ || list_->status().ok()) return "";
  return (list_->WasRead()
              ? "the list of keys cannot be read; the last good one holds, and nothing is revoked: "
              : "nobody is let in until the list of keys can be read: ") +
         list_->status().message();
}

bool AccessControl::MayWork(const std::string& peer) const {
  const auto bound = workers_.find(peer);
  if (!list_ || bound == workers_.end()) return true;
  const wire::Allowed* allowed = list_->Find(bound->second.user);
  return allowed != nullptr && allowed->roles.worker;
}

std::optional<std::string> AccessControl::NameOnList(const std::string& user) const {
  if (!list_ || user.empty()) return std::nullopt;
  const wire::Allowed* allowed = list_->Find(user);
  return allowed == nullptr ? "" : allowed->name;
}

std::string AccessControl::NameOf(const std::string& user) const {
  const std::optional<std::string> listed = NameOnList(user);
  if (!listed) return "";
  const std::string name = Printable(*listed, kMostNameBytes);
  return name.empty() ? wire::ShortKey(user) : name + " (" + wire::ShortKey(user) + ")";
}

}  // namespace cairn::coordinator
