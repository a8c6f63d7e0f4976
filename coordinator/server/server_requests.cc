// What clients ask.
#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "coordinator/server/job_limits.h"
#include "coordinator/server/rights.h"
#include "coordinator/server/server.h"
#include "schema/text.h"

namespace cairn::coordinator {
namespace {

wire::Message Refusal(const std::string& why) {
  wire::Message reply;
  reply.envelope.mutable_reply()->set_ok(false);
  reply.envelope.mutable_reply()->set_message(why);
  return reply;
}

// Of a job's name, what is safe in a file name.
std::string FileNamePart(const std::string& name) {
  std::string part;
  for (const char c : name.substr(0, 40))
    part += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' ? c : '-';
  return part.empty() ? "job" : part;
}

// Enough of a name to know it by; it may be of 64 MB.
std::string FirstOf(const std::string& name) {
  constexpr std::size_t kMost = 200;
  return name.size() <= kMost ? name : CutTo(name, kMost) + "…";
}

// The latest ten, where there are more.
std::string KnownJobs(const std::vector<wire::JobInfo>& jobs) {
  if (jobs.empty()) return "; there are none";
  std::string known;
  for (std::size_t i = jobs.size() - std::min<std::size_t>(jobs.size(), 10); i < jobs.size(); ++i)
    known += (known.empty() ? "; known: " : ", ") + jobs[i].id();
  return known;
}

void AddPlan(const proto::Job& spec, wire::JobInfo* info) {
  std::map<std::string, std::uint32_t> known;
  for (const proto::Stage& stage : spec.stages()) {
    wire::StageInfo& of = *info->add_plan();
    of.set_name(stage.name());
    of.set_pipeline(stage.pipeline());
    std::set<std::uint32_t> after;
    for (const auto& [role, source] : stage.inputs())
      if (const auto earlier = known.find(source); earlier != known.end()) after.insert(earlier->second);
    of.mutable_after()->Assign(after.begin(), after.end());
    known[stage.name()] = static_cast<std::uint32_t>(known.size());
  }
}

}  // namespace

void Server::Reply(const std::string& peer, wire::Message reply) {
  asked_by_.erase(peer);
  joined_.erase(peer);
  reply.envelope.mutable_reply()->set_workers(static_cast<std::uint32_t>(core_.fleet().size()));
  transport_.Send(peer, std::move(reply));
}

void Server::Serve(const std::string& peer, const std::string& user, const wire::Have& have) {
  if (have.hashes_size() > options_.limits.hashes)
    return RefuseJob(peer, wire::RefusalKind::kJob,
                     "a question for more than " + std::to_string(options_.limits.hashes) + " blobs");
  wire::Message reply;
  reply.envelope.mutable_reply()->set_ok(true);
  for (const std::string& binary : have.hashes()) {
    const Result<Hash> hash = Hash::FromBinary(binary);
    if (!hash.ok())
      return RefuseJob(peer, wire::RefusalKind::kJob, "a question for a blob by what is no content hash");
    if (!HasOf(user, hash.value())) reply.envelope.mutable_reply()->add_missing(binary);
  }
  Reply(peer, std::move(reply));
}

void Server::Serve(const std::string& peer, const std::string& user, const wire::Submit& submit) {
  proto::Job job = submit.job();
  if (submit.protocol() != wire::kProtocol)
    return RefuseJob(peer, wire::RefusalKind::kVersion,
                     "this client speaks protocol " + std::to_string(submit.protocol()) + ", here it is " +
                         std::to_string(wire::kProtocol) + " of version " CAIRN_VERSION);
  std::string wrong = CheckLimits(job, options_.limits);
  if (wrong.empty()) wrong = CheckJob(job);
  if (wrong.empty()) wrong = LimitMemory(user, job);
  if (!wrong.empty()) return RefuseJob(peer, wire::RefusalKind::kJob, wrong);
  const auto may_command = [&](const std::string& owner) { return access_control_.MayCommand(user, owner); };
  if (const std::string* known = index_.Serving(HashOfJob(job), may_command); known != nullptr) {
    if (!may_command(core_.FindJob(*known)->owner)) joined_.insert(peer);
    return Handle(SubmitJob{*known, job, uploads_.Take(peer), peer});  // told twice
  }
  if (options_.drains)
    return RefuseAsUnable(
        peer, wire::RefusalKind::kJob,
        "this service takes no new jobs: it finishes those that it has, and ends (--drain)");
  if (const std::string full = use_.WhyNoRoom(0); !full.empty())
    return RefuseAsUnable(peer, wire::RefusalKind::kStore, full);
  std::set<Hash> inputs;
  for (const auto& [name, binary] : job.input_blobs()) inputs.insert(Hash::FromBinary(binary).value());
  for (const std::string& over : {WhyNoMoreJobs(user), WhyNoMoreInputs(user, inputs, 0)})
    if (!over.empty()) return RefuseAsUnable(peer, wire::RefusalKind::kQuota, over);
  wire::Message missing;
  for (const auto& [name, binary] : job.input_blobs()) {
    if (HasOf(user, Hash::FromBinary(binary).value())) continue;
    missing.envelope.mutable_reply()->set_message("the blob of the input '" + name + "' is missing");
    missing.envelope.mutable_reply()->add_missing(binary);
  }
  if (missing.envelope.has_reply()) return Reply(peer, std::move(missing));
  Handle(SubmitJob{NewJobId(job), job, uploads_.Take(peer), peer, access_control_.OwnerOf(user)});
}

void Server::RefuseJob(const std::string& peer, wire::RefusalKind kind, const std::string& why) {
  refusals_.Add({kind, why}, Now());
  Reply(peer, Refusal(why));
}

// It is right, and may be asked again later, or elsewhere.
void Server::RefuseAsUnable(const std::string& peer, wire::RefusalKind kind, const std::string& why,
                            double again_s) {
  refusals_.Add({kind, why}, Now());
  wire::Message reply = Refusal(why);
  reply.envelope.mutable_reply()->set_unable(true);
  reply.envelope.mutable_reply()->set_again_s(again_s);
  Reply(peer, std::move(reply));
}

// Never used before in this store: numbers go on behind all that have left a checkpoint or were deleted.
std::string Server::NewJobId(const proto::Job& job) {
  return std::to_string(++last_job_number_) + "-" + FileNamePart(job.name());
}

std::string Server::WhatIsWrong(const wire::JobQuery& query) const {
  const std::string& action = query.action();
  wire::Envelope envelope;
  *envelope.mutable_query() = query;
  if (!RightNeeded(envelope)) return "there is no action '" + FirstOf(action) + "': " + JobActions();
  if (query.job().empty()) return action.empty() || action == "status" ? "" : "which job?";
  const Job* job = core_.FindJob(query.job());
  if (job == nullptr) return "there is no job '" + FirstOf(query.job()) + "'" + KnownJobs(core_.Jobs());
  const std::optional<JobCommand> command = CommandOf(action);
  if (!command) return "";
  if (command == JobCommand::kPrioritize &&
      (query.priority() < kLowestPriority || query.priority() > kHighestPriority))
    return "a priority is a number from -10 to 10";
  const std::string why = WhyNot(*job, *command);
  const std::string verb = command == JobCommand::kPrioritize ? "change the priority of" : action;
  return why.empty() ? "" : "cannot " + verb + " " + job->id + ": " + why;
}

void Server::Serve(const std::string& peer, const std::string& user, const wire::JobQuery& query) {
  if (const std::string his = WhyNotHis(user, query); !his.empty())
    return RefuseJob(peer, wire::RefusalKind::kRight, his);
  if (const std::string wrong = WhatIsWrong(query); !wrong.empty()) return Reply(peer, Refusal(wrong));
  const auto command = CommandOf(query.action());
  if (const std::string over = command == JobCommand::kRetry ? WhyNoMoreJobs(user) : ""; !over.empty())
    return RefuseAsUnable(peer, wire::RefusalKind::kQuota, over);
  if (command) return Obey(peer, user, query, *command);
  if (query.action() == "logs") return AnswerLog(peer, user, query);
  const std::string& action = query.action();
  if (action == "results" || action == "so_far" || action == "inputs")
    return AnswerWithBlobs(peer, user, query);
  Reply(peer, AboutJobs(user, query.job()));
}

// With what the core does not know of it.
void Server::Complete(const std::string& user, wire::JobInfo& info) const {
  info.set_foreign(!access_control_.MayCommand(user, info.owner()));
  Hasher mark;
  mark.Add(store_id_);
  mark.Add(core_.FindJob(info.id())->hash.Binary());
  info.set_mark(mark.Finish().Binary());
}

// Of one job, or, where none is named, of all; and what there is to know of the service.
wire::Message Server::AboutJobs(const std::string& user, const std::string& job) const {
  wire::Message message;
  wire::Reply& reply = *message.envelope.mutable_reply();
  reply.set_ok(true);
  if (job.empty())
    for (wire::JobInfo& info : core_.Jobs()) *reply.add_jobs() = std::move(info);
  else
    *reply.add_jobs() = *core_.Find(job);
  for (wire::JobInfo& info : *reply.mutable_jobs()) Complete(user, info);
  for (const auto& [kind, count] : refusals_.Counts()) (*reply.mutable_refused())[kind] = count;
  reply.set_may_submit(access_control_.MaySubmit(user));
  reply.set_warning(Warning());
  reply.set_store_fails(!store_trouble_.empty());
  reply.set_store_bytes(use_.bytes());
  reply.set_store_limit_bytes(use_.limit_bytes());
  return message;
}

std::string Server::WhatIsWrong(const wire::WorkerQuery& query) const {
  wire::Envelope envelope;
  *envelope.mutable_workers() = query;
  if (!RightNeeded(envelope))
    return "there is no action '" + FirstOf(query.action()) + "' on workers: " + WorkerActions();
  if (query.worker() == 0 || core_.fleet().workers().contains(query.worker())) return "";
  return "there is no worker " + std::to_string(query.worker()) + "; cairn status lists them";
}

void Server::Serve(const std::string& peer, const wire::WorkerQuery& query) {
  if (const std::string wrong = WhatIsWrong(query); !wrong.empty()) return Reply(peer, Refusal(wrong));
  if (query.action() == "drain") {
    std::vector<std::string> peers;
    for (const auto& [number, worker] : core_.fleet().workers())
      if (query.worker() == 0 || query.worker() == number) peers.push_back(worker.peer);
    for (const std::string& peer_told : peers) Handle(DrainWorker{peer_told});
  }
  wire::Message reply;
  reply.envelope.mutable_reply()->set_ok(true);
  for (const wire::WorkerInfo& info : core_.Workers())
    if (query.worker() == 0 || query.worker() == info.number())
      *reply.envelope.mutable_reply()->add_fleet() = info;
  for (const wire::Demand& demand : core_.Demand()) *reply.envelope.mutable_reply()->add_demand() = demand;
  Reply(peer, std::move(reply));
}

// All that is on disk when the writer comes to it is known here now, or was asked to be removed.
void Server::Serve(const std::string& peer, const wire::Clean& clean) {
  if (!MayAskWriter(peer)) return;
  std::set<Hash> needed = blobs_.Known();
  needed.merge(uploads_.Writing());
  writer_.Add(CleanWork{peer, {clean.damaged(), clean.dry_run(), std::move(needed)}});
}

// One question of each peer at a time, and of few peers: what has to be written waits behind them. The answer
// to the one before answers who asks again.
bool Server::MayAskWriter(const std::string& peer) {
  constexpr std::size_t kMostQuestions = 64;
  if (questions_.contains(peer)) return false;
  if (questions_.size() >= kMostQuestions) {
    wire::Message busy = Refusal("the service is busy with what others ask; ask again");
    busy.envelope.mutable_reply()->set_unable(true);
    Reply(peer, std::move(busy));
    return false;
  }
  questions_.insert(peer);
  return true;
}

// By the thread that writes: it has written what was told so far by then. So where the job is over, as it
// stands now, nothing of how that came is missing.
void Server::AnswerLog(const std::string& peer, const std::string& user, const wire::JobQuery& query) {
  if (!MayAskWriter(peer)) return;
  WriteLog();
  wire::JobInfo info = *core_.Find(query.job());
  Complete(user, info);
  AddPlan(core_.FindJob(query.job())->spec, &info);
  writer_.Add(ReadLogWork{peer, std::move(info), query.after()});
}

// The core answers, once it is durable: what a service said it did, a crash does not undo.
void Server::Obey(const std::string& peer, const std::string& user, const wire::JobQuery& query,
                  JobCommand command) {
  const std::string& id = query.job();
  switch (command) {
    case JobCommand::kPause:
      // Whoever looks after the fleet is told of what no owner did.
      return Handle(PauseJob{
          id, peer,
          access_control_.OwnerOf(user) == core_.FindJob(id)->owner ? "" : access_control_.NameOf(user)});
    case JobCommand::kResume:
      return Handle(ResumeJob{id, peer});
    case JobCommand::kCancel:
      return Handle(CancelJob{id, peer});
    case JobCommand::kRetry:
      return Handle(RetryJob{id, peer});
    case JobCommand::kDelete:
      return Handle(DeleteJob{id, peer});
    case JobCommand::kPrioritize:
      return Handle(PrioritizeJob{id, query.priority(), peer});
  }
}

}  // namespace cairn::coordinator
