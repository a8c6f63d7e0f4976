#include "coordinator/server/server.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "coordinator/store/recovery.h"
#include "coordinator/store/served_file.h"
#include "coordinator/store/store_id.h"
#include "schema/process_limits.h"
#include "schema/text.h"
#include "schema/wire/keys.h"

namespace cairn::coordinator {
namespace {

constexpr double kTick_s = 0.1;
constexpr double kFetchesWait_s = 0.005;    // until it is seen who has read what was sent before
constexpr std::size_t kLineBytes = 16'384;  // of the log
// Over one connection: who waits for an answer before it asks again never has so much to read.
constexpr std::size_t kMostUnreadAnswers = 1 << 20;

// What came is written into files in the end, and a result gets its provenance from the coordinator.
std::string WhyNotKept(const wire::Done& done, const std::vector<wire::NamedBlob>& blobs) {
  for (const wire::NamedBlob& named : blobs) {
    if (Status texts = CheckTexts(*named.blob); !texts.ok())
      return "its answer came with a blob that no file holds: " + texts.message();
    if (done.step().result() == named.hash.Binary() && !named.blob->Sub("provenance/").fields().empty())
      return "its result has a provenance already";
  }
  return "";
}

// Empty where none can be read: then jobs are known by what was submitted alone.
std::string IdOf(const StoreFolder& folder) {
  const Result<StoreId> id = ReadStoreId(folder.IdFile());
  return id.ok() ? id.value().id : "";
}

}  // namespace

Server::Server(const StoreFolder& folder, Transport& transport, JobTable table, ServerOptions options,
               LogSink log)
    : folder_(folder),
      store_id_(IdOf(folder)),
      transport_(transport),
      options_(std::move(options)),
      log_([log = std::move(log)](Severity severity, const std::string& line) {
        log(severity, Printable(line, kLineBytes));
      }),
      core_(options_.core),
      index_([this](const Hash& input) { return BytesOnDisk(input); }),
      files_(folder),
      blobs_(files_, options_.memory_bytes > 0 ? options_.memory_bytes
                                               : std::min<std::uint64_t>(4ull << 30, MemoryToHave() / 4)),
      use_(folder.dir(), options_.store_limit_bytes),
      uploads_(options_.uploads,
               [this](const std::string& user, const Hash& hash) { return HasOf(user, hash); }),
      access_control_(options_.allow_list, options_.key_limits),
      refusals_(log_),
      on_its_way_(transport, options_.stalled_s),
      last_job_number_(table.LastNumber()),
      writer_(folder, files_, use_, std::move(table), [&transport] { transport.Wake(); }) {
  Restore();
}

double Server::Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void Server::Restore() {
  const Result<double> served_s = ReadServed(folder_.ServedFile());
  if (!served_s.ok())
    log_(Severity::kWarning, served_s.status().message() + "; jobs that have ended are kept for longer");
  served_written_s_ = Now();
  Handle(Served{served_s.ok() ? served_s.value() : 0});
  const JobLogSink note = [this](Severity severity, const std::string& job, const std::string& line) {
    Note(severity, job, line);
  };
  const auto inputs = options_.given_inputs ? InputsOf::kUser : InputsOf::kStore;
  const PublishedFiles published{options_.result_files, core_.served_s()};
  if (options_.given_inputs)
    for (const wire::NamedBlob& input : *options_.given_inputs) blobs_.Give(input);
  // Of a job that could not be restored, too, no other gets the number.
  for (const std::string& id : folder_.JobsWithCheckpoints())
    last_job_number_ = std::max(last_job_number_, NumberOfJob(id));
  for (const RestoreJob& job : Recover(folder_, files_, inputs, published, note)) {
    for (const std::string& binary : job.checkpoint.blobs())
      if (const Hash blob = Hash::FromBinary(binary).value(); files_.Has(blob)) blobs_.AddDurable(blob);
    for (const Hash& blob : job.previous_blobs) blobs_.AddDurable(blob);
    Handle(job);
    const Job* restored = core_.FindJob(job.checkpoint.job_id());
    if (restored != nullptr && restored->Ended()) told_ended_.insert(restored->id);
  }
}

void Server::Step(double timeout_s) {
  const double wait_s = fetches_.empty() ? timeout_s : std::min(timeout_s, kFetchesWait_s);
  std::vector<Incoming> came = transport_.Poll(gone_.empty() ? wait_s : 0);
  const double began_s = Now();
  // Looked at after the messages came: whoever was taken off the list before he sent one is refused it.
  if (access_control_.Refresh()) EndRevoked();
  const bool behind = !transport_.TookAll();
  const std::set<std::string> gone = behind ? std::set<std::string>() : std::exchange(gone_, {});
  ServeFetches();
  for (Incoming& incoming : came) Receive(incoming);
  // After its last words, an answer or that it leaves, which were on their way when it was found gone.
  for (const std::string& peer : gone) Handle(WorkerLost{peer});
  for (const wire::Refusal& refusal : transport_.TakeRefusals()) refusals_.Add(refusal, Now());
  TakeDiskDone();
  if (const double now_s = Now(); now_s - ticked_s_ >= kTick_s) {
    ticked_s_ = now_s;
    Handle(Tick{behind});
    Carry(uploads_.Tick(now_s));
    if (!behind) ProbeSilent(now_s);  // else whoever seems silent may have said something
    ProbeStore(now_s);
    EndStalled(now_s);
    // A disk that is slow, or hangs, gets no more to do; what waits is bounded.
    if (writer_.Finished(log_ticket_)) WriteLog();
  }
  WriteBlobsWork spill;
  for (const Hash& hash : blobs_.TakeSpills()) spill.blobs.push_back({hash, blobs_.Get(hash)});
  if (!spill.blobs.empty()) writer_.Add(std::move(spill));
  turns_.Add(Now() - began_s);
}

bool Server::Shut(double patience_s) {
  const double end_s = Now() + patience_s;
  WriteServed();
  Handle(SaveNow{});
  while (core_.HasUnsaved() && Now() < end_s) {
    // Answers that still come are for the next start to compute again: a round may not begin now.
    TakeDiskDone();
    static_cast<void>(transport_.Poll(0.005));
  }
  WriteLog();
  for (const auto& [number, worker] : core_.fleet().workers()) {
    wire::Message leave;
    leave.envelope.mutable_leave();
    transport_.Send(worker.peer, std::move(leave));
  }
  return !core_.HasUnsaved();
}

bool Server::HasDrained() const { return index_.running() == 0 && !core_.HasUnsaved(); }

void Server::Submit(const std::string& id, const proto::Job& job, const std::vector<wire::NamedBlob>& blobs) {
  last_job_number_ = std::max(last_job_number_, NumberOfJob(id));
  Handle(SubmitJob{id, job, KeepBlobs(blobs)});
}

void Server::GoOn(const std::string& id) {
  Handle(ResumeJob{id});
  Handle(RetryJob{id});
}

void Server::TellDead(std::int64_t pid) {
  for (const auto& [number, worker] : core_.fleet().workers())
    if (worker.hello.pid() == pid) return Handle(WorkerLost{std::string(worker.peer), true});
}

std::vector<Hash> Server::KeepBlobs(const std::vector<wire::NamedBlob>& blobs) {
  std::vector<Hash> hashes;
  for (const wire::NamedBlob& named : blobs) {
    blobs_.Put(named, writer_.next_ticket());
    hashes.push_back(named.hash);
  }
  return hashes;
}

void Server::Handle(const Event& event) {
  for (Action& action : core_.Handle(event, Now())) std::visit([this](auto& a) { Do(a); }, action);
}

void Server::Receive(Incoming& incoming) {
  if (!incoming.status.ok()) return TakeDamaged(incoming);
  wire::Envelope& envelope = incoming.message.envelope;
  if (std::optional<wire::Refusal> refusal =
          access_control_.Check(incoming.peer, incoming.user, envelope, core_.fleet())) {
    refusal->reason = wire::ShortKey(incoming.user) + ": " + refusal->reason;
    return TurnAway(incoming.peer, *refusal);
  }
  if (const auto often = access_control_.AsksTooOften(incoming.user, envelope, Now()))
    return RefuseAsUnable(incoming.peer, wire::RefusalKind::kQuota, often->why, often->again_s);
  NoteWhoAsks(incoming.peer, incoming.user, envelope);
  if (envelope.has_query() || envelope.has_workers() || envelope.has_have()) {
    if (transport_.Unsent(incoming.peer) >= kMostUnreadAnswers) return;  // it asks again when it has read
    if (const std::string much = WhyTooManyAnswers(incoming.user); !much.empty())
      return RefuseAsUnable(incoming.peer, wire::RefusalKind::kQuota, much);
    Take(incoming.peer, incoming.user, envelope, incoming.message.blobs);
    return on_its_way_.AddAnswer(incoming.peer, incoming.user);
  }
  Take(incoming.peer, incoming.user, envelope, incoming.message.blobs);
}

void Server::Take(const std::string& peer, const std::string& user, wire::Envelope& envelope,
                  const std::vector<wire::NamedBlob>& blobs) {
  const std::size_t most = options_.limits.text_bytes;
  switch (envelope.body_case()) {
    case wire::Envelope::kHello: {
      wire::Hello& hello = *envelope.mutable_hello();
      hello.set_host(Printable(hello.host(), most));
      // With keys it is called as its key is on the list: nobody takes another's name.
      hello.set_name(Printable(access_control_.NameOnList(user).value_or(hello.name()), most));
      hello.set_slots(std::min(hello.slots(), options_.limits.slots));
      return Handle(WorkerHello{peer, hello});
    }
    case wire::Envelope::kHeartbeat:
      return Handle(WorkerHeartbeat{peer, envelope.heartbeat()});
    case wire::Envelope::kLeave:
      return Handle(WorkerLeave{peer});
    case wire::Envelope::kDrain:
      return Handle(DrainWorker{peer});
    case wire::Envelope::kDone: {
      proto::Step* step = envelope.done().has_step() ? envelope.mutable_done()->mutable_step() : nullptr;
      if (step != nullptr) step->set_note(Printable(step->note(), most));
      return Handle(TaskDone{peer, envelope.done(), KeepBlobs(blobs), WhyNotKept(envelope.done(), blobs)});
    }
    case wire::Envelope::kFailed:
      envelope.mutable_failed()->set_message(Printable(envelope.failed().message(), most));
      return Handle(TaskFailed{peer, envelope.failed()});
    case wire::Envelope::kFetch:
      return Serve(peer, envelope.fetch());
    case wire::Envelope::kHave:
      return Serve(peer, user, envelope.have());
    case wire::Envelope::kSubmit:
      return Serve(peer, user, envelope.submit());
    case wire::Envelope::kOffer:
      return Serve(peer, user, envelope.offer());
    case wire::Envelope::kPiece:
      return Carry(uploads_.Came(peer, std::move(*envelope.mutable_piece()), Now()));
    case wire::Envelope::kClean:
      return Serve(peer, envelope.clean());
    case wire::Envelope::kQuery:
      return Serve(peer, user, envelope.query());
    case wire::Envelope::kWorkers:
      return Serve(peer, envelope.workers());
    default:
      return;  // access control lets nothing else through
  }
}

void Server::TakeDurable(const std::string& job, std::uint64_t number) {
  last_checkpoint_utc_s_ =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  Handle(PersistDone{job, number});
  TellEnded(job);
}

void Server::TellEnded(const std::string& id) {
  const Job* job = core_.FindJob(id);
  if (job == nullptr || !job->Ended() || job->saving.under_way || job->saving.saves != job->state) return;
  if (told_ended_.insert(id).second && options_.job_ended) options_.job_ended(*core_.Find(id));
}

void Server::TakeForgotten(const std::string& job) {
  told_ended_.erase(job);
  Handle(ForgetDone{job});
}

Status Server::ForUsers(const Status& status) const {
  const std::string store = folder_.dir().string() + "/";
  if (status.ok() || options_.given_inputs || status.message().find(store) == std::string::npos)
    return status;  // a private run's store is its user's own
  log_(Severity::kWarning, status.message());
  constexpr std::string_view kShown = "store/";
  std::string message = status.message();
  for (std::size_t at = 0; (at = message.find(store, at)) != std::string::npos; at += kShown.size())
    if (at == 0 || std::string_view(" '(").find(message[at - 1]) != std::string_view::npos)
      message.replace(at, store.size(), kShown);
  return {status.code(), message};
}

void Server::TakeDiskDone() {
  for (DiskDone& done : writer_.TakeDone()) {
    done.status = ForUsers(done.status);
    probe_soon_ |= !done.status.ok();
    if (done.ticket == served_ticket_) TakeProbe(done.status);
    blobs_.MarkDurable(done.written, done.ticket);
    if (done.upload != 0) {
      TakeUploadDone(done);
      continue;
    }
    if (!done.loaded.empty() || !done.read.empty()) {
      TakeLoaded(done);
      continue;
    }
    if (!done.asker.empty()) {
      questions_.erase(done.asker);
      wire::Message answer;
      *answer.envelope.mutable_reply() = done.answer;
      Reply(done.asker, std::move(answer));
      continue;
    }
    if (done.job.empty()) {
      if (!done.status.ok()) log_(Severity::kWarning, done.status.message());
      continue;
    }
    const std::string& problem = done.status.message();
    if (done.number == 0 && done.status.ok())
      TakeForgotten(done.job);
    else if (done.number == 0)
      Handle(ForgetFailed{done.job, problem});
    else if (done.status.ok())
      TakeDurable(done.job, done.number);
    else
      Handle(PersistFailed{done.job, done.number, problem});
  }
}

}  // namespace cairn::coordinator
