// The shell around the core: turns messages, the disk's answers and the clock into events, and carries out
// actions. One thread; it never waits for a disk, except to read back a small blob that memory had no room
// for.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/core.h"
#include "coordinator/core/uploads.h"
#include "coordinator/server/access_control.h"
#include "coordinator/server/job_index.h"
#include "coordinator/server/metrics.h"
#include "coordinator/server/on_its_way.h"
#include "coordinator/server/refusals.h"
#include "coordinator/server/transport.h"
#include "coordinator/store/blob_store.h"
#include "coordinator/store/disk_writer.h"
#include "coordinator/store/folder.h"
#include "coordinator/store/log.h"
#include "coordinator/store/shared_results.h"

namespace cairn::coordinator {

struct ServerOptions {
  CoreOptions core;
  std::filesystem::path allow_list;  // of the keys that may connect; empty: there are no keys
  wire::JobLimits limits;
  wire::KeyLimits key_limits;  // of keys that say nothing else
  UploadOptions uploads;
  std::uint64_t largest_input_bytes = wire::Limits().message_bytes;  // a worker gets it as one message
  // Blobs beyond this are kept on disk only; 0: beyond a quarter of MemoryToHave, or 4 GiB.
  std::uint64_t memory_bytes = 0;
  // Of results and inputs, on their way to clients; as much again to administrators.
  std::uint64_t sent_bytes = 256ull << 20;
  // Of blobs, on their way to workers, each of which has an equal share; of parts, to all of them.
  std::uint64_t fetched_bytes = 1ull << 30;
  double stalled_s = 60;                // with who reads nothing of what he asked for
  std::uint64_t store_limit_bytes = 0;  // on disk; 0: none
  bool drains = false;                  // takes no new jobs
  // The inputs of a private run, which whoever starts it has in files and brings along each time: the store
  // has no copies. None: jobs bring their inputs, and the store keeps them.
  std::optional<std::vector<wire::NamedBlob>> given_inputs;
  // Where the result of a job's stage is published.
  std::function<std::filesystem::path(const std::string& job, const std::string& stage)> result_path;
  // The files of a job's results that are there, of whatever stages; none: nobody knows.
  std::function<std::vector<std::filesystem::path>(const std::string& job)> result_files;
  // Told of each job that has ended, once that is durable; of those that had ended before a start it is not.
  // None: nobody asks.
  std::function<void(const wire::JobInfo& job)> job_ended;
  // The folder of a job's results, which goes with the job; none: they are not this server's to remove.
  std::function<std::filesystem::path(const std::string& job)> results_folder;
};

class Server {
 public:
  // `folder` and `transport` must outlive it. Restores the jobs that it finds in the store.
  Server(const StoreFolder& folder, Transport& transport, JobTable table, ServerOptions options, LogSink log);

  // Waits for messages for up to `timeout_s`, then does all that there is to do. `now_s` after the wait: see
  // clock.
  void Step(double timeout_s);
  // Saves what is unsaved, for at most `patience_s`, and sends the workers Leave. True where all is saved.
  bool Shut(double patience_s);

  // No job runs or waits for workers, and all is saved: those that are left have ended, or are paused.
  bool HasDrained() const;

  // A job from this process.
  void Submit(const std::string& id, const proto::Job& job, const std::vector<wire::NamedBlob>& blobs);
  // Goes on with a job that is paused or has failed; does nothing where it runs.
  void GoOn(const std::string& id);
  // A worker of this process's own is known to be dead.
  void TellDead(std::int64_t pid);

  const Core& core() const { return core_; }
  const std::string& last_refusal() const {
    return last_refusal_;
  }  // why a worker was refused; empty: none was
  const Refusals& refusals() const { return refusals_; }
  const Uploads& uploads() const { return uploads_; }
  Metrics TakeMetrics() const;  // server_watch.cc
  // Why the store cannot be written; empty: it can, as far as is known.
  const std::string& store_trouble() const { return store_trouble_; }

 private:
  static double Now();  // monotonic
  void Restore();
  void Handle(const Event& event);
  void Receive(Incoming& incoming);
  void Take(const std::string& peer, const std::string& user, wire::Envelope& envelope,
            const std::vector<wire::NamedBlob>& blobs);
  // As users may read it: what is wrong in the store, but not where that lies, which the log says.
  Status ForUsers(const Status& status) const;
  void TakeDiskDone();
  void TakeDurable(const std::string& job, std::uint64_t number);
  void TellEnded(const std::string& job);
  void TakeForgotten(const std::string& job);

  // server_actions.cc
  void Do(coordinator::Send& send);
  void Do(Persist& persist);
  void Do(const DropBlobs& drop);
  void Do(const ForgetJob& forget);
  void Do(const JobChanged& changed);
  void Do(const Answer& answer);
  void Do(const Report& report);
  void Do(const Refused& refused);
  void WriteServed();

  // server_watch.cc
  void ProbeStore(double now_s);
  void TakeProbe(const Status& status);
  std::string Warning() const;

  // A line for the service's log and, where it names a job, for that job's.
  void Note(Severity severity, const std::string& job, const std::string& text);
  void WriteLog();
  void ProbeSilent(double now_s);

  // server_uploads.cc
  void Serve(const std::string& peer, const std::string& user, const wire::Offer& offer);
  void Carry(Uploads::Actions actions);
  void Do(OpenUpload open);
  void Do(WritePiece piece);
  void Do(CloseUpload close);
  void Do(const TellCredit& tell);
  void Do(const AnswerOffer& answer);
  void Do(const ReleaseBlob& release);
  void Do(const DropUploader& drop);
  void RemoveUnknown(const Hash& hash);
  void TakeUploadDone(const DiskDone& done);

  // server_rights.cc
  void TakeDamaged(const Incoming& incoming);
  void TurnAway(const std::string& peer, const wire::Refusal& refusal);
  void EndRevoked();
  void NoteWhoAsks(const std::string& peer, const std::string& user, const wire::Envelope& asked);
  void SayWhoAsked(const Answer& answer);
  std::string WhyNotHis(const std::string& user, const wire::JobQuery& query) const;
  bool HasOf(const std::string& user, const Hash& hash) const;

  // server_quotas.cc
  std::string WhyNoMoreJobs(const std::string& user) const;
  std::string WhyNoMoreInputs(const std::string& user, const std::set<Hash>& more,
                              std::uint64_t more_bytes) const;
  std::uint64_t BytesOnDisk(const Hash& input) const;
  std::string LimitMemory(const std::string& user, proto::Job& job) const;

  // server_blobs.cc
  void Serve(const std::string& peer, const wire::Fetch& fetch);
  bool MustWait(const std::string& peer, const wire::Fetch& fetch);
  void ServeFetches();
  void Send(const std::string& peer, const wire::Fetch& fetch);
  void SendPart(const std::string& peer, const Hash& hash, const wire::Fetch& fetch);
  void NoteSent(const std::string& peer, const wire::Fetch& fetch, std::uint64_t bytes);
  void EndStalled(double now_s);
  void AnswerWithBlobs(const std::string& peer, const std::string& user, const wire::JobQuery& query);
  bool WaitsForDisk(const std::string& peer, const std::string& user, const wire::JobQuery& query);
  void TakeLoaded(DiskDone& done);
  std::uint64_t BytesOfResults(const Job& job) const;
  std::string WhyTooManyAnswers(const std::string& user) const;
  std::string WhyTooMuchOnItsWay(const std::string& user, const std::string& what,
                                 std::uint64_t more_bytes) const;
  OnItsWay::To KindOfClient(const std::string& user) const;
  Result<wire::NamedBlob> PublishedBy(const Job& job, std::size_t stage,
                                      const std::filesystem::path& path) const;
  void AddResults(const std::string& id, wire::Message& reply);
  void AddSoFar(const std::string& id, wire::Message& reply);
  void AddInputs(const std::string& id, wire::Message& reply);
  void AddBlob(const std::string& name, const Hash& hash, wire::Message& reply);

  // server_requests.cc
  void Serve(const std::string& peer, const std::string& user, const wire::Have& have);
  void Serve(const std::string& peer, const std::string& user, const wire::Submit& submit);
  void Serve(const std::string& peer, const std::string& user, const wire::JobQuery& query);
  void Serve(const std::string& peer, const wire::Clean& clean);
  void Serve(const std::string& peer, const wire::WorkerQuery& query);
  void RefuseJob(const std::string& peer, wire::RefusalKind kind, const std::string& why);
  void RefuseAsUnable(const std::string& peer, wire::RefusalKind kind, const std::string& why,
                      double again_s = 0);
  void Complete(const std::string& user, wire::JobInfo& info) const;
  wire::Message AboutJobs(const std::string& user, const std::string& job) const;
  bool MayAskWriter(const std::string& peer);
  void AnswerLog(const std::string& peer, const std::string& user, const wire::JobQuery& query);
  std::string WhatIsWrong(const wire::JobQuery& query) const;
  std::string WhatIsWrong(const wire::WorkerQuery& query) const;
  void Obey(const std::string& peer, const std::string& user, const wire::JobQuery& query,
            JobCommand command);
  void Reply(const std::string& peer, wire::Message reply);
  std::string NewJobId(const proto::Job& job);
  std::vector<Hash> KeepBlobs(const std::vector<wire::NamedBlob>& blobs);

  const StoreFolder& folder_;
  const std::string store_id_;  // empty: it has none, as a private run's
  Transport& transport_;
  const ServerOptions options_;
  const LogSink log_;
  Core core_;
  JobIndex index_;  // of the core's jobs
  BlobFiles files_;
  BlobStore blobs_;
  StoreUse use_;
  Uploads uploads_;
  std::set<std::string> gone_uploaders_;  // clients that a message could not be sent to
  double ticked_s_ = 0, served_written_s_ = 0;
  std::uint64_t served_ticket_ = 0;  // of the last WriteServed, by which the store is probed
  bool probe_soon_ = false;
  std::string store_trouble_;
  double last_checkpoint_utc_s_ = 0;
  Histogram turns_;
  std::set<std::string> gone_;  // peers that a message could not be sent to
  std::string last_refusal_;
  AccessControl access_control_;
  Refusals refusals_;
  std::map<std::string, std::string> asked_by_;  // "cancelled by desk (Yx8…)", by peer, until it is answered
  std::set<std::string> joined_;  // peers that submitted what another has, until they are answered
  // Who asked for results or blobs that have yet to be read; the writer reads those of one question at a
  // time.
  struct Waiting {
    std::string peer, user;
    wire::JobQuery query;
  };
  std::deque<Waiting> waiting_;
  bool is_loading_ = false;
  std::uint64_t fetch_ticket_ = 0;  // of what the writer reads for a worker; 0: nothing
  SharedResults results_;
  OnItsWay on_its_way_;
  std::map<std::string, std::deque<wire::Fetch>> fetches_;  // that wait, by worker's peer
  std::string fetched_last_;                                // the peer of whom some were answered last
  std::set<std::string> questions_;                         // peers whose question is with the writer
  std::set<std::string> told_ended_;                        // jobs of which job_ended was told
  std::set<std::string> warned_;   // peers that were told once that they have no business here
  std::uint64_t last_job_number_;  // that was ever given, or lies in the store
  WaitingLines waiting_lines_;     // of jobs' logs
  std::uint64_t log_ticket_ = 0;   // of the lines that were written last
  DiskWriter writer_;              // last: it is joined first
};

}  // namespace cairn::coordinator
