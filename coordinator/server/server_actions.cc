// What the core wants done.
#include <utility>

#include "coordinator/server/server.h"
#include "coordinator/store/result_file.h"
#include "schema/text.h"

namespace cairn::coordinator {
namespace {

constexpr double kProbeAfter = 1.5;  // heartbeats without a sign of life

}  // namespace

void Server::Do(coordinator::Send& send) {
  if (send.message.has_refuse()) last_refusal_ = send.message.refuse().reason();
  if (!transport_.Send(send.peer, wire::Message{std::move(send.message), {}})) gone_.insert(send.peer);
}

// A dead process takes its connection with it, which only shows when something is sent there.
void Server::ProbeSilent(double now_s) {
  for (const auto& [number, worker] : core_.fleet().workers()) {
    if (now_s - worker.heard_s < kProbeAfter * worker.heartbeat_s) continue;
    wire::Message probe;
    probe.envelope.mutable_cancel();  // of no task: ignored
    if (!transport_.Send(worker.peer, std::move(probe))) gone_.insert(worker.peer);
  }
}

// A checkpoint of very many tasks is long: it is handed on, not copied.
void Server::Do(Persist& persist) {
  WriteCheckpointWork work{std::move(persist.checkpoint), {}, {}};
  const proto::Checkpoint& checkpoint = work.checkpoint;
  for (const std::string& binary : checkpoint.blobs()) {
    const Hash hash = Hash::FromBinary(binary).value();
    if (!blobs_.Durable(hash)) work.blobs.push_back({hash, blobs_.Get(hash)});
  }
  for (const Publish& publish : persist.publish) {
    const proto::Stage& stage = checkpoint.job().stages(static_cast<int>(publish.stage));
    const bool must_read = blobs_.MustRead(publish.result);
    const BlobPtr blob = must_read ? nullptr : blobs_.Get(publish.result);
    if (blob == nullptr && !must_read)
      return Handle(
          PersistFailed{checkpoint.job_id(), checkpoint.number(), "a result cannot be read back from disk"});
    work.results.push_back(
        {options_.result_path(checkpoint.job_id(), stage.name()), publish.stage, publish.result, blob});
  }
  writer_.Add(std::move(work));
}

void Server::Do(const DropBlobs& drop) {
  RemoveBlobsWork remove;
  const std::set<Hash> writing = uploads_.Writing();
  for (const Hash& hash : drop.hashes) {
    if (uploads_.Keeps(hash)) continue;
    // Else the file that is being made would go, for it lies there before anybody knows of it.
    if (blobs_.Has(hash) && !writing.contains(hash)) remove.hashes.push_back(hash);
    blobs_.Drop({hash});
  }
  writer_.Add(std::move(remove));
}

void Server::Do(const ForgetJob& forget) {
  waiting_lines_.Forget(forget.job);
  writer_.Add(ForgetWork{
      forget.job, options_.results_folder ? options_.results_folder(forget.job) : std::filesystem::path()});
}

// What is tried again may end once more.
void Server::Do(const JobChanged& changed) {
  const Job* job = core_.FindJob(changed.job);
  index_.File(changed.job, job);
  if (job != nullptr && !job->Ended()) told_ended_.erase(changed.job);
}

void Server::Do(const Answer& answer) {
  SayWhoAsked(answer);
  wire::Message message;
  wire::Reply& reply = *message.envelope.mutable_reply();
  reply.set_ok(answer.refusal.empty());
  reply.set_message(answer.refusal);
  reply.set_known(answer.known);
  reply.set_unable(answer.unable);
  wire::JobInfo gone;
  gone.set_id(answer.job);
  gone.set_state("deleted");
  if (const auto info = core_.Find(answer.job); info || reply.ok()) *reply.add_jobs() = info.value_or(gone);
  for (wire::JobInfo& info : *reply.mutable_jobs()) info.set_foreign(joined_.contains(answer.asker));
  Reply(answer.asker, std::move(message));
}

void Server::WriteServed() {
  served_written_s_ = Now();
  served_ticket_ = writer_.Add(WriteServedWork{core_.served_s()});
}

void Server::Do(const Refused& refused) { refusals_.Add(refused.refusal, Now()); }

void Server::Do(const Report& report) {
  const Severity severity = report.level == Report::kInfo      ? Severity::kInfo
                            : report.level == Report::kWarning ? Severity::kWarning
                                                               : Severity::kError;
  Note(severity, report.job, report.text);
}

void Server::Note(Severity severity, const std::string& job, const std::string& text) {
  log_(severity, job.empty() ? text : job + ": " + text);
  if (job.empty()) return;
  wire::LogLine line;
  line.set_utc(UtcNow());
  line.set_level(severity == Severity::kInfo ? "info" : severity == Severity::kWarning ? "warning" : "alarm");
  line.set_text(Printable(text, kLogLineBytes));
  waiting_lines_.Add(job, std::move(line));
}

void Server::WriteLog() {
  if (!waiting_lines_.empty()) log_ticket_ = writer_.Add(WriteLogWork{waiting_lines_.Take()});
}

}  // namespace cairn::coordinator
