// What clients ask, and the blobs that workers fetch.
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
  reply.envelope.mutable_reply()->set_workers(static_cast<std::uint32_t>(core_.fleet().size()));
  transport_.Send(peer, std::move(reply));
}

void Server::Serve(const std::string& peer, const wire::Fetch& fetch) {
  const Result<Hash> hash = Hash::FromBinary(fetch.hash());
  const bool may = hash.ok() && core_.MayRead(peer, hash.value());
  // One that was dropped meanwhile is no offence, nor is a worker that does not know yet that it was given
  // up.
  if (hash.ok() && !may && blobs_.Has(hash.value()) && core_.fleet().Knows(peer))
    refusals_.Add({wire::RefusalKind::kTask, "a fetch of a blob that is not for this worker"}, Now());
  if (may && fetch.has_part()) return ServePart(peer, hash.value(), fetch.part());
  wire::Message answer;
  Status unread;
  if (const BlobPtr blob = may ? blobs_.Get(hash.value(), &unread) : nullptr) {
    answer.envelope.mutable_blob();
    answer.blobs.push_back({hash.value(), blob});
  } else {
    if (!unread.ok()) log_(Severity::kError, unread.message());
    answer.envelope.mutable_missing()->set_hash(hash.ok() ? fetch.hash() : std::string());
    if (fetch.has_part()) *answer.envelope.mutable_missing()->mutable_part() = fetch.part();
  }
  transport_.Send(peer, std::move(answer));
}

void Server::ServePart(const std::string& peer, const Hash& hash, const proto::BlobPart& part) {
  wire::Message answer;
  const Result<BlobPtr> cut = blobs_.GetPart(hash, part);
  if (cut.ok()) {
    wire::BlobData& data = *answer.envelope.mutable_blob();
    data.set_of(hash.Binary());
    *data.mutable_part() = part;
    answer.blobs.push_back(wire::NameBlob(cut.value()));
  } else {
    wire::Missing& missing = *answer.envelope.mutable_missing();
    missing.set_hash(hash.Binary());
    *missing.mutable_part() = part;
    if (cut.status().code() == Code::kRefused)
      missing.set_why(cut.status().message());
    else if (cut.status().code() != Code::kNotFound)
      log_(Severity::kError, cut.status().message());
  }
  transport_.Send(peer, std::move(answer));
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
  if (const std::string* known = index_.Serving(HashOfJob(job)); known != nullptr)
    return Handle(SubmitJob{*known, job, uploads_.Take(peer), peer});  // told twice
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
void Server::RefuseAsUnable(const std::string& peer, wire::RefusalKind kind, const std::string& why) {
  refusals_.Add({kind, why}, Now());
  wire::Message reply = Refusal(why);
  reply.envelope.mutable_reply()->set_unable(true);
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
  if (command) return Obey(peer, query, *command);
  if (query.action() == "logs") return AnswerLog(peer, user, query);
  const std::string& action = query.action();
  if (action == "results" || action == "so_far" || action == "inputs")
    return AnswerWithBlobs(peer, user, query);
  Reply(peer, AboutJobs(user, query.job()));
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
  for (wire::JobInfo& info : *reply.mutable_jobs())
    info.set_foreign(!access_control_.MayCommand(user, info.owner()));
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
  log_(Severity::kInfo,
       clean.dry_run() ? "a client asks what there is to clean" : "a client has the store cleaned");
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
  info.set_foreign(!access_control_.MayCommand(user, info.owner()));
  AddPlan(core_.FindJob(query.job())->spec, &info);
  writer_.Add(ReadLogWork{peer, std::move(info), query.after()});
}

// The core answers, once it is durable: what a service said it did, a crash does not undo.
void Server::Obey(const std::string& peer, const wire::JobQuery& query, JobCommand command) {
  const std::string& id = query.job();
  switch (command) {
    case JobCommand::kPause:
      return Handle(PauseJob{id, peer});
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

// Who asks again while the answer is on its way, or does not read, waits for that. Of what is on its way to
// all there is a bound: each connection has a copy of its own of what it encrypts.
void Server::AnswerWithBlobs(const std::string& peer, const std::string& user, const wire::JobQuery& query) {
  if (transport_.Unsent(peer) > 0) return;
  const bool results = query.action() == "results";
  const std::uint64_t expected = results ? BytesOfResults(*core_.FindJob(query.job())) : 0;
  if (const std::string much = WhyTooMuchOnItsWay(user, expected); !much.empty())
    return RefuseAsUnable(peer, wire::RefusalKind::kQuota, much);
  if (results && WaitsForResults(peer, user, query)) return;
  wire::Message reply = AboutJobs(user, query.job());
  if (results) AddResults(query.job(), reply);
  if (query.action() == "so_far") AddSoFar(query.job(), reply);
  if (query.action() == "inputs") AddInputs(query.job(), reply);
  std::uint64_t bytes = 0;
  for (const wire::NamedBlob& named : reply.blobs) bytes += named.blob->ByteCount();
  if (const std::string much = WhyTooMuchOnItsWay(user, bytes); !much.empty())
    return RefuseAsUnable(peer, wire::RefusalKind::kQuota, much);
  if (bytes > 0) sent_to_[peer] = user;
  Reply(peer, std::move(reply));
}

// Of what one key has asked for no more is on its way than a quarter of all, or one answer.
std::string Server::WhyTooMuchOnItsWay(const std::string& user, std::uint64_t more_bytes) {
  std::uint64_t of_all = 0, of_user = 0;
  std::erase_if(sent_to_, [this](const auto& sent) { return transport_.Unsent(sent.first) == 0; });
  for (const auto& [peer, whose] : sent_to_) {
    const std::uint64_t bytes = transport_.Unsent(peer);
    of_all += bytes;
    of_user += whose == user ? bytes : 0;
  }
  const std::uint64_t most = options_.sent_bytes;
  const std::string again = " of results and inputs are on their way to ";
  if (of_all > 0 && of_all + more_bytes > most)
    return BytesText(of_all) + again + "those who asked before; try again";
  if (!user.empty() && of_user > 0 && of_user + more_bytes > most / 4)
    return BytesText(of_user) + again + access_control_.NameOf(user) + "; try again when they are there";
  return "";
}

std::uint64_t Server::BytesOfResults(const Job& job) const {
  std::uint64_t bytes = 0;
  for (const proto::Stage& stage : job.spec.stages())
    bytes += results_.Bytes(options_.result_path(job.id, stage.name()));
  return bytes;
}

// True: they have to be read, and another's were in this turn. It is answered in a later one.
bool Server::WaitsForResults(const std::string& peer, const std::string& user, const wire::JobQuery& query) {
  constexpr std::size_t kMostWaiting = 1024;
  const Job& job = *core_.FindJob(query.job());
  const bool at_hand = std::ranges::all_of(job.spec.stages(), [&](const proto::Stage& stage) {
    return results_.IsAtHand(options_.result_path(job.id, stage.name()));
  });
  if (at_hand) return false;
  if (!std::exchange(has_read_, true)) return false;
  if (std::ranges::any_of(waiting_, [&](const Waiting& waiting) { return waiting.peer == peer; }))
    return true;
  if (waiting_.size() >= kMostWaiting) {
    RefuseAsUnable(peer, wire::RefusalKind::kQuota, "the service is busy with what others ask; ask again");
    return true;
  }
  wire::JobQuery asked;
  asked.set_job(query.job());
  asked.set_action(query.action());
  waiting_.push_back({peer, user, std::move(asked)});
  return true;
}

void Server::ServeWaiting() {
  for (const Waiting& waiting : std::exchange(waiting_, {})) Serve(waiting.peer, waiting.user, waiting.query);
}

// What a stage of a job has published. kNotFound: nothing yet. kCorrupt: damaged, gone, or not what it made.
Result<wire::NamedBlob> Server::PublishedBy(const Job& job, std::size_t stage,
                                            const std::filesystem::path& path) {
  Result<SharedResult> file = results_.Read(path);
  const bool all_are_there =
      job.state == proto::JOB_DONE && job.saving.unpublished.empty() && !job.saving.under_way;
  if (!file.ok() && file.status().code() == Code::kNotFound && all_are_there)
    return Status(Code::kCorrupt, path.string() + ": is not there any more");
  if (!file.ok()) return file.status();
  if (stage < job.results.size() && file.value().result != job.results[stage])
    return Status(Code::kCorrupt, path.string() + ": is another result than this job made");
  return std::move(file).value().named;
}

// As they are published. Stages whose results are not there, or not what the job made, are named in the
// message.
void Server::AddResults(const std::string& id, wire::Message& reply) {
  const Job& job = *core_.FindJob(id);
  std::string& damaged = *reply.envelope.mutable_reply()->mutable_message();
  for (std::size_t stage = 0; stage < static_cast<std::size_t>(job.spec.stages_size()); ++stage) {
    const std::string& name = job.spec.stages(static_cast<int>(stage)).name();
    Result<wire::NamedBlob> file = PublishedBy(job, stage, options_.result_path(id, name));
    if (file.ok()) {
      reply.envelope.mutable_reply()->add_names(name);
      reply.blobs.push_back(std::move(file).value());
    } else if (file.status().code() != Code::kNotFound) {
      damaged += (damaged.empty() ? "the stage '" : "; the stage '") + name +
                 "': " + ForUsers(file.status()).message();
    }
  }
}

// Of the step under way, durable or not: steps are pure, so that what a crash takes back comes again.
void Server::AddSoFar(const std::string& id, wire::Message& reply) {
  const Job& job = *core_.FindJob(id);
  if (const auto hash = job.SoFar()) AddBlob(job.CurrentStage().name(), *hash, reply);
}

// They are kept as long as the job may need them.
void Server::AddInputs(const std::string& id, wire::Message& reply) {
  const Job& job = *core_.FindJob(id);
  for (const auto& [name, binary] : job.spec.input_blobs())
    if (!job.Final()) AddBlob(name, Hash::FromBinary(binary).value(), reply);
}

void Server::AddBlob(const std::string& name, const Hash& hash, wire::Message& reply) {
  Status unread;
  const BlobPtr blob = blobs_.Get(hash, &unread);
  if (!unread.ok()) log_(Severity::kError, unread.message());
  if (blob == nullptr) return;
  reply.envelope.mutable_reply()->add_names(name);
  reply.blobs.push_back({hash, blob});
}

}  // namespace cairn::coordinator
