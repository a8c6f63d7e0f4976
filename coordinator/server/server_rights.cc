// Those who are turned away: what they are told, and when their connection goes. Those who are not: who asked
// for what.
#include <optional>
#include <utility>
#include <vector>

#include "coordinator/server/rights.h"
#include "coordinator/server/server.h"
#include "schema/wire/codec.h"
#include "schema/wire/keys.h"

namespace cairn::coordinator {
namespace {

constexpr std::size_t kMostWarned = 4096;

wire::RefusalKind KindOf(Code code) {
  if (code == Code::kVersion) return wire::RefusalKind::kVersion;
  return code == Code::kRefused ? wire::RefusalKind::kOversized : wire::RefusalKind::kMalformed;
}

// A client that asks for too much may ask for something else next; these have no business here at all.
bool IsUnauthenticated(wire::RefusalKind kind) {
  return kind == wire::RefusalKind::kRevoked || kind == wire::RefusalKind::kIdentity ||
         kind == wire::RefusalKind::kVersion;
}

// Of what a client asks for that changes something; empty: of nothing.
std::string DoneBy(const wire::Envelope& asked) {
  if (asked.has_submit()) return "submitted";
  const std::optional<JobCommand> command =
      asked.has_query() ? CommandOf(asked.query().action()) : std::nullopt;
  if (!command) return "";
  switch (*command) {
    case JobCommand::kPause:
      return "paused";
    case JobCommand::kResume:
      return "resumed";
    case JobCommand::kCancel:
      return "cancelled";
    case JobCommand::kRetry:
      return "tried again";
    case JobCommand::kDelete:
      return "deleted";
    case JobCommand::kPrioritize:
      return "its priority is set";
  }
  return "";
}

// The same, of what is no job's.
std::string DoneToAll(const wire::Envelope& asked) {
  if (asked.has_clean())
    return asked.clean().dry_run() ? " asks what there is to clean" : " has the store cleaned";
  if (!asked.has_workers() || asked.workers().action() != "drain") return "";
  const std::uint64_t worker = asked.workers().worker();
  return worker == 0 ? " has all workers drained" : " has worker " + std::to_string(worker) + " drained";
}

}  // namespace

void Server::TakeDamaged(const Incoming& incoming) {
  const wire::RefusalKind kind = KindOf(incoming.status.code());
  if (kind == wire::RefusalKind::kVersion)
    return TurnAway(incoming.peer,
                    {kind, incoming.status.message() + "; here it is protocol " +
                               std::to_string(wire::kProtocol) + " of version " CAIRN_VERSION});
  refusals_.Add({kind, incoming.status.message()}, Now());
}

// It is told why. A connection that is closed at once would lose that, so that of an unknown key goes when it
// says more.
void Server::TurnAway(const std::string& peer, const wire::Refusal& refusal) {
  refusals_.Add(refusal, Now());
  if (IsUnauthenticated(refusal.kind)) {
    if (warned_.contains(peer)) return transport_.Drop(peer);
    if (warned_.size() >= kMostWarned) warned_.clear();
    warned_.insert(peer);
  }
  wire::Message answer;
  answer.envelope.mutable_refuse()->set_reason(refusal.reason);
  transport_.Send(peer, std::move(answer));
}

// The list, or whether it can be read, has changed. A worker whose key is gone need not say anything more to
// lose its tasks.
void Server::EndRevoked() {
  if (const std::string warning = access_control_.Warning(); !warning.empty())
    log_(Severity::kError, warning);
  else
    log_(Severity::kInfo, "the list of keys has changed, or a key's time is over: it holds from now on");
  std::vector<std::string> revoked;
  for (const auto& [number, worker] : core_.fleet().workers())
    if (!access_control_.MayWork(worker.peer)) revoked.push_back(worker.peer);
  for (const std::string& peer : revoked) {
    Handle(WorkerLeave{peer});
    TurnAway(peer,
             {wire::RefusalKind::kRevoked, "a worker's key was taken off the list, or its time is over"});
  }
}

void Server::NoteWhoAsks(const std::string& peer, const std::string& user, const wire::Envelope& asked) {
  const std::string what = DoneBy(asked), of_all = DoneToAll(asked);  // nothing, of nearly all that comes
  if (what.empty() && of_all.empty()) return;
  const std::string who = access_control_.NameOf(user);
  if (!of_all.empty()) log_(Severity::kInfo, (who.empty() ? "a client" : who) + of_all);
  if (!what.empty() && !who.empty()) asked_by_[peer] = what + " by " + who;
}

// Empty: the job is his who asks, or he administers, or nothing of it is changed.
std::string Server::WhyNotHis(const std::string& user, const wire::JobQuery& query) const {
  const bool is_his_alone = CommandOf(query.action()) || query.action() == "inputs";
  const Job* job = is_his_alone ? core_.FindJob(query.job()) : nullptr;
  if (job == nullptr || access_control_.MayCommand(user, job->owner)) return "";
  const std::string owner =
      wire::IsPublicKey(job->owner) ? "the key " + wire::ShortKey(job->owner) : job->owner;
  const std::string what = query.action() == "inputs" ? "hand out the inputs of" : query.action();
  return "cannot " + what + " " + job->id + ": it " +
         (owner.empty() ? "has no owner" : "belongs to " + owner) + ", and the key of " +
         access_control_.NameOf(user) + " is no administrator's (role admin)";
}

// Whether the store has a blob that this user need not bring, for it came from him. Of another's it is as if
// there were none: by its hash, which every result tells, nobody gets what he does not have.
bool Server::HasOf(const std::string& user, const Hash& hash) const {
  if (!blobs_.Has(hash)) return false;
  return access_control_.MayCommand(user, "") || uploads_.KeepsFor(user, hash) ||
         index_.Of(access_control_.OwnerOf(user)).inputs.contains(hash);
}

// In the job's log, but where that is gone with it.
void Server::SayWhoAsked(const Answer& answer) {
  const auto asked = asked_by_.find(answer.asker);
  if (asked == asked_by_.end()) return;
  const std::string line = asked->second;
  asked_by_.erase(asked);
  if (!answer.refusal.empty() || answer.known) return;
  if (core_.Find(answer.job))
    Note(Severity::kInfo, answer.job, line);
  else
    log_(Severity::kInfo, answer.job + ": " + line);
}

}  // namespace cairn::coordinator
