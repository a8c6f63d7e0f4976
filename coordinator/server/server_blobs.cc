// Blobs on their way: those that workers fetch; results, maps of jobs that run and inputs, which clients ask
// for.
#include <algorithm>
#include <utility>
#include <vector>

#include "coordinator/server/server.h"
#include "schema/text.h"

namespace cairn::coordinator {

// It waits while its worker has yet to read more than its share, and a part while all of them do.
void Server::Serve(const std::string& peer, const wire::Fetch& fetch) {
  constexpr std::size_t kMostOfOne = 256;  // of a worker, which asks again for what is left out
  const std::string key = fetch.SerializeAsString();
  if (on_its_way_.HasFetched(peer, key)) return;
  const auto waiting = fetches_.find(peer);
  if (waiting == fetches_.end() && !MustWait(peer, fetch)) return Send(peer, fetch);
  std::deque<wire::Fetch>& fetches = fetches_[peer];
  const bool asked = std::ranges::any_of(
      fetches, [&](const wire::Fetch& other) { return other.SerializeAsString() == key; });
  if (!asked && fetches.size() < kMostOfOne) fetches.push_back(fetch);
}

// A whole blob is in memory once, whoever gets it; a part is cut for each. What is on disk alone is read by
// the writer, one at a time.
bool Server::MustWait(const std::string& peer, const wire::Fetch& fetch) {
  const std::uint64_t workers = std::max<std::uint64_t>(1, core_.fleet().size());
  if (const std::size_t unsent = transport_.Unsent(peer);
      unsent > 0 && unsent >= options_.fetched_bytes / workers)
    return true;
  if (fetch.has_part() && on_its_way_.copied_bytes() >= options_.fetched_bytes) return true;
  const Result<Hash> hash = Hash::FromBinary(fetch.hash());
  if (!hash.ok() || blobs_.HasRead(hash.value()) || !blobs_.MustRead(hash.value(), fetch.has_part()))
    return false;
  if (fetch_ticket_ != 0) return true;
  if (!core_.MayRead(peer, hash.value())) return false;
  fetch_ticket_ = writer_.Add(LoadWork{{}, {hash.value()}});
  return true;
}

// In turn: none goes first each time.
void Server::ServeFetches() {
  if (fetches_.empty()) return;
  EndStalled(Now());
  auto it = fetches_.upper_bound(fetched_last_);
  for (std::size_t left = fetches_.size(); left > 0; --left) {
    if (it == fetches_.end()) it = fetches_.begin();
    auto& [peer, fetches] = *it;
    while (!fetches.empty() && !MustWait(peer, fetches.front())) {
      Send(peer, fetches.front());
      fetches.pop_front();
      fetched_last_ = peer;
    }
    it = fetches.empty() ? fetches_.erase(it) : std::next(it);
  }
}

void Server::Send(const std::string& peer, const wire::Fetch& fetch) {
  const Result<Hash> hash = Hash::FromBinary(fetch.hash());
  const bool may = hash.ok() && core_.MayRead(peer, hash.value());
  // One that was dropped meanwhile is no offence, nor is a worker that does not know yet that it was given
  // up.
  if (hash.ok() && !may && blobs_.Has(hash.value()) && core_.fleet().Knows(peer))
    refusals_.Add({wire::RefusalKind::kTask, "a fetch of a blob that is not for this worker"}, Now());
  if (may && fetch.has_part()) return SendPart(peer, hash.value(), fetch);
  wire::Message answer;
  std::uint64_t bytes = 0;
  Status unread;
  if (const BlobPtr blob = may ? blobs_.Get(hash.value(), &unread) : nullptr) {
    answer.envelope.mutable_blob();
    answer.blobs.push_back({hash.value(), blob});
    bytes = blob->ByteCount();
  } else {
    if (!unread.ok()) log_(Severity::kError, unread.message());
    answer.envelope.mutable_missing()->set_hash(hash.ok() ? fetch.hash() : std::string());
    if (fetch.has_part()) *answer.envelope.mutable_missing()->mutable_part() = fetch.part();
  }
  transport_.Send(peer, std::move(answer));
  NoteSent(peer, fetch, bytes);
}

// What is small is not counted, and is soon out.
void Server::NoteSent(const std::string& peer, const wire::Fetch& fetch, std::uint64_t bytes) {
  constexpr std::uint64_t kSmall = 64 << 10;
  if (bytes >= kSmall && transport_.Unsent(peer) > 0)
    on_its_way_.AddFetched(peer, fetch.SerializeAsString(), bytes, fetch.has_part());
}

void Server::SendPart(const std::string& peer, const Hash& hash, const wire::Fetch& fetch) {
  const proto::BlobPart& part = fetch.part();
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
  NoteSent(peer, fetch, cut.ok() ? cut.value()->ByteCount() : 0);
}

// Who takes nothing keeps memory from others: he may ask again.
void Server::EndStalled(double now_s) {
  for (const std::string& peer : on_its_way_.Look(now_s)) {
    refusals_.Add({wire::RefusalKind::kQuota,
                   "a peer has read nothing of what it asked for, for a minute: its "
                   "connection is ended"},
                  now_s);
    transport_.Drop(peer);
    fetches_.erase(peer);
    if (core_.fleet().Knows(peer)) gone_.insert(peer);
  }
}

// Who asks again while the answer is on its way, or does not read, waits for that. Of what is on its way to
// all there is a bound.
void Server::AnswerWithBlobs(const std::string& peer, const std::string& user, const wire::JobQuery& query) {
  if (transport_.Unsent(peer) > 0) return;
  const bool results = query.action() == "results";
  std::string what = results ? query.job() : "";
  const std::uint64_t expected = results ? BytesOfResults(*core_.FindJob(query.job())) : 0;
  if (const std::string much = WhyTooMuchOnItsWay(user, what, expected); !much.empty())
    return RefuseAsUnable(peer, wire::RefusalKind::kQuota, much);
  if (WaitsForDisk(peer, user, query)) return;
  wire::Message reply = AboutJobs(user, query.job());
  if (results) AddResults(query.job(), reply);
  if (query.action() == "so_far") AddSoFar(query.job(), reply);
  if (query.action() == "inputs") AddInputs(query.job(), reply);
  std::uint64_t bytes = 0;
  for (const wire::NamedBlob& named : reply.blobs) bytes += named.blob->ByteCount();
  if (!results && bytes > 0) what = reply.blobs[0].hash.Hex();
  if (const std::string much = WhyTooMuchOnItsWay(user, what, bytes); !much.empty())
    return RefuseAsUnable(peer, wire::RefusalKind::kQuota, much);
  Reply(peer, std::move(reply));
  if (bytes > 0) on_its_way_.Add(peer, KindOfClient(user), user, what);
}

OnItsWay::To Server::KindOfClient(const std::string& user) const {
  return access_control_.MayCommand(user, "") ? OnItsWay::To::kAdministrators : OnItsWay::To::kUsers;
}

// Of what one key has asked for no more is on its way than a quarter of all, or one answer. Administrators
// have a bound of their own, all together.
std::string Server::WhyTooMuchOnItsWay(const std::string& user, const std::string& what,
                                       std::uint64_t more_bytes) const {
  const OnItsWay::To to = KindOfClient(user);
  const std::uint64_t most = options_.sent_bytes, of_others = on_its_way_.Bytes(to, what);
  const std::string again = " of results and inputs are on their way to ";
  if (of_others > 0 && of_others + more_bytes > most)
    return BytesText(of_others) + again + "those who asked before; try again";
  const std::uint64_t of_user = on_its_way_.BytesOf(user);
  if (to == OnItsWay::To::kUsers && of_user > 0 && of_user + more_bytes > most / 4)
    return BytesText(of_user) + again + access_control_.NameOf(user) + "; try again when they are there";
  return "";
}

// Whoever asks and does not read. Administrators, who put that right, are not asked to wait.
std::string Server::WhyTooManyAnswers(const std::string& user) const {
  constexpr std::uint64_t kShare = 8;  // of what may be on its way
  if (KindOfClient(user) == OnItsWay::To::kAdministrators) return "";
  const std::uint64_t of_user = on_its_way_.AnswerBytesOf(user),
                      of_all = on_its_way_.Bytes(OnItsWay::To::kQuestions, "");
  if (of_user > options_.sent_bytes / kShare)
    return BytesText(of_user) + " of answers to " + access_control_.NameOf(user) +
           " are not read yet; try again when they are";
  if (of_all > options_.sent_bytes) return BytesText(of_all) + " of answers are not read yet; try again";
  return "";
}

std::uint64_t Server::BytesOfResults(const Job& job) const {
  std::uint64_t bytes = 0;
  for (const proto::Stage& stage : job.spec.stages())
    bytes += results_.Bytes(options_.result_path(job.id, stage.name()));
  return bytes;
}

// True: they have to be read, and it is answered when they are.
bool Server::WaitsForDisk(const std::string& peer, const std::string& user, const wire::JobQuery& query) {
  constexpr std::size_t kMostWaiting = 1024;
  const Job& job = *core_.FindJob(query.job());
  LoadWork load;
  if (query.action() == "results")
    for (const proto::Stage& stage : job.spec.stages())
      load.files.push_back(options_.result_path(job.id, stage.name()));
  if (const auto so_far = job.SoFar(); so_far && query.action() == "so_far") load.blobs = {*so_far};
  if (query.action() == "inputs" && !job.Final())
    for (const auto& [name, binary] : job.spec.input_blobs())
      load.blobs.push_back(Hash::FromBinary(binary).value());
  std::erase_if(load.blobs, [this](const Hash& hash) { return !blobs_.MustRead(hash); });
  if (std::ranges::all_of(load.files, [this](const auto& file) { return results_.IsAtHand(file); }) &&
      std::ranges::all_of(load.blobs, [this](const Hash& hash) { return blobs_.HasRead(hash); }))
    return false;
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
  if (!std::exchange(is_loading_, true)) writer_.Add(std::move(load));
  return true;
}

// Who waits for others has these read next.
void Server::TakeLoaded(DiskDone& done) {
  for (const SharedResults::Loaded& of : done.loaded) results_.Keep(of);
  blobs_.TakeRead(std::move(done.read));
  if (done.ticket == fetch_ticket_) {
    fetch_ticket_ = 0;
    ServeFetches();
  } else {
    is_loading_ = false;
    for (const Waiting& waiting : std::exchange(waiting_, {}))
      Serve(waiting.peer, waiting.user, waiting.query);
  }
  blobs_.ForgetRead();
  results_.ForgetFailures();
}

// What a stage of a job has published. kNotFound: nothing yet. kCorrupt: damaged, gone, or not what it made.
Result<wire::NamedBlob> Server::PublishedBy(const Job& job, std::size_t stage,
                                            const std::filesystem::path& path) const {
  Result<SharedResult> file = results_.Get(path);
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
  reply.envelope.mutable_reply()->mutable_jobs(0)->set_hash(job.hash.Binary());
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
