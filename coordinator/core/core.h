// The coordinator's logic as one pure state machine: events and the time go in, actions come out. No I/O, no
// clock, no threads, no logging; nothing here depends on what a pipeline computes.
//
//   workers.cc   handshake, heartbeats, leases, workers that hang, drain or leave
//   answers.cc   answers and failures of tasks; rounds and stages end here
//   dispatch.cc  which task goes to which worker, stragglers
//   jobs.cc      submit, restore, how jobs end
//   commands.cc  what a job's owner tells it
//   saving.cc    checkpoints
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/blob_ledger.h"
#include "coordinator/core/census.h"
#include "coordinator/core/events.h"
#include "coordinator/core/fair_share.h"
#include "coordinator/core/fleet.h"
#include "coordinator/core/job.h"
#include "coordinator/core/job_commands.h"

namespace cairn::coordinator {

struct CoreOptions {
  double heartbeat_s = 1;       // workers send heartbeats at least this often
  double lease_s = 10;          // a worker not heard of for this long is lost
  double back_s = 60;           // a worker that is lost and says Hello within this long has not ended
  double unlisted_s = 4;        // a task given this long ago that no heartbeat lists never arrived
  double hung_s = 60;           // a RUN task whose tick count stands still for this long goes elsewhere
  double plan_hung_s = 3600;    // the same of START and ADVANCE, which do not tick while they reduce
  double straggler_factor = 3;  // an idle worker gets a copy of a task that runs this many medians …
  double straggler_min_s = 2;   // … and at least this long
  int max_failures = 3;         // of one task, then the job fails; what is lost with its machine is none
  double checkpoint_interval_s = 1;
  std::uint64_t checkpoint_rounds = 0;  // a checkpoint every so many rounds instead; 0: by the interval
  double save_again_s = 5;  // what could not be saved of a job that has ended is tried again after this long
  double keep_s = 0;        // a job that has ended for longer is deleted; 0: none is
  double task_time_s = 0;   // of a task whose job says nothing; 0: no limit
  std::uint64_t task_memory_mb = 0;  // the same
  std::uint32_t protocol = 3;        // Hello.protocol that is spoken here
  wire::Build build;                 // of the coordinator: bits of another must not be mixed with its own
};

// What a worker ran whose connection is lost.
struct LostAttempt {
  wire::TaskKey key;
  double since_s = 0;
};

class Core {
 public:
  explicit Core(const CoreOptions& options) : options_(options) {}

  // Times never run backwards.
  std::vector<Action> Handle(const Event& event, double now_s);

  std::vector<wire::JobInfo> Jobs() const;  // in the order of submission
  std::optional<wire::JobInfo> Find(const std::string& id) const;
  const Job* FindJob(const std::string& id) const;
  std::vector<wire::WorkerInfo> Workers() const;  // in the order in which they joined
  std::vector<wire::Demand> Demand() const;       // of the jobs that run
  const Fleet& fleet() const { return fleet_; }
  const Tally& tally() const { return tally_; }
  Census TakeCensus() const;  // census.cc
  std::size_t held_blobs() const { return ledger_.size(); }
  // For how long the store has been served, in seconds, by this coordinator and those before it. A job's age
  // is counted in it: the time that Handle is told never jumps, and a restart does not make a job young
  // again.
  double served_s() const { return now_s_ - served_from_s_; }
  bool Holds(const Hash& hash) const { return ledger_.Held(hash); }
  // Whether a worker may get one of the job's tasks that are ready.
  bool MayServe(const Worker& worker, const Job& job) const;
  // Whether a worker was handed a task that reads this blob, or made it.
  bool MayRead(const std::string& peer, const Hash& hash) const;
  // A checkpoint is under way, or SaveNow would begin one.
  bool HasUnsaved() const;

 private:
  using JobMap = std::map<std::uint64_t, Job>;  // by order

  void On(const WorkerHello& event);
  void On(const WorkerHeartbeat& event);
  void On(const WorkerLeave& event);
  void On(const WorkerLost& event);
  void On(const DrainWorker& event);
  void On(const TaskDone& event);
  void On(const TaskFailed& event);
  void On(const SubmitJob& event);
  void On(const PauseJob& event);
  void On(const ResumeJob& event);
  void On(const CancelJob& event);
  void On(const RetryJob& event);
  void On(const DeleteJob& event);
  void On(const PrioritizeJob& event);
  void On(const Served& event);
  void On(const RestoreJob& event);
  void On(const PersistDone& event);
  void On(const PersistFailed& event);
  void On(const ForgetDone& event);
  void On(const ForgetFailed& event);
  void On(const SaveNow& event);
  void On(const Tick& event);
  void LookAtWorkers();

  // workers.cc

  // Null where it may work here.
  std::optional<wire::Refusal> WhyRefused(const wire::Hello& hello) const;
  double HeartbeatSeconds() const;         // of one that joins now
  Worker* Heard(const std::string& peer);  // null, and asked to say Hello, where it is not known
  // It says Hello anew, and has forgotten its tasks. True where it was to leave.
  void SayMoved(Report::Level level, const std::string& what);
  bool Forget(Worker* known, const std::string& how);
  void WarnOfLink(const Worker& worker);  // a task of its was excused
  void BeginDraining(Worker& worker);
  void TellDrain(const Worker& worker);
  void DropUnlisted(Worker& worker, const wire::Heartbeat& heartbeat);
  // Removes it. `what` happened to it; `blame`: why its running task has failed, or empty.
  void Lose(Worker& worker, const std::string& what, const std::string& blame);
  // Its running task has failed, and what it has queued goes elsewhere; it gets nothing until it moves.
  void GiveUp(Worker& worker, const std::string& why);
  std::string WhyGiveUp(const Worker& worker) const;  // empty: there is no reason to
  void LeaveOutStandstill();

  // answers.cc
  void RefuseAnswer(const Worker& worker, const wire::TaskKey& key);
  // True where it is what was waited for.
  bool MayName(const Job& job, const Worker& worker, const Hash& blob) const;
  bool AcceptPartial(Job& job, const TaskDone& event, Worker& worker, bool had_it);
  bool AcceptPlan(Job& job, const TaskDone& event, Worker& worker, bool had_it);
  void CompareSecond(Job& job, const wire::TaskKey& key, const Hash& first, const Hash& second,
                     const Worker& worker);
  void Count(Job& job, const wire::Done& done, const Worker& worker);
  void BeginRound(Job& job, const proto::Step& step);
  void EndStage(Job& job, const Hash& result);
  void EndRoundFacts(Job& job);

  // retries.cc

  // The attempt at `task` has failed, by its worker's fault.
  void Exclude(Job& job, const wire::TaskKey& key, Worker& worker, const std::string& wrong);
  void FailAttempt(Job& job, std::uint32_t task, std::uint64_t worker, const std::string& why);
  // Its running task is about to be blamed, though its process may have lost but its connection.
  void NoteLost(const Worker& worker);
  void TakeBackBlame(const wire::Hello& hello);
  bool Excuse(const Worker& worker);  // of its running task: see Round::Excuse
  // Its machine has gone silent: its running task is counted as lost, not as failed. False where that was
  // said of the task too often.
  bool LoseWithNode(const Worker& worker);
  Job* JobOfRunning(const Worker& worker);

  // dispatch.cc
  void Dispatch();
  void DispatchReady();                                     // ready tasks, to workers that have room
  std::pair<std::uint32_t, Worker*> Place(const Job& job);  // nobody: null
  // None where it has failed all of them, and there are others.
  std::optional<std::uint32_t> NearestReady(const Job& job, const Worker& worker) const;
  void Queue(std::uint64_t order);
  // By a job, and by one of its tasks: whoever has failed that; none where there is nobody else.
  const std::set<std::uint64_t>& ExcludedBy(const Job& job) const;
  std::set<std::uint64_t> ExcludedBy(const Job& job, std::uint32_t task) const;
  bool AreAll(const std::set<std::uint64_t>& workers) const;  // that may get tasks now or later
  void Assign(Job& job, std::uint32_t task, const std::vector<Hash>& inputs, Worker& worker);
  void Withdraw(Job& job, std::uint32_t task, const Attempt& attempt);  // from whoever has it, with a Cancel
  void CallBack(Worker& worker, const wire::TaskKey& key);              // a Cancel, where it has it
  Job* Reclaim(Worker& worker, const wire::TaskKey& key);  // null where it was not under way any more
  void WithdrawOthers(Job& job, std::uint32_t task);       // all attempts that are still under way
  void WithdrawAll(Job& job);
  bool MoveQueued();  // to an idle worker
  void CopyStragglers();
  Job* JobOf(const wire::TaskKey& key);  // null where the task is not part of what is under way

  // commands.cc

  // Null where it is not there or does not obey, which `asker` is told.
  Job* Obeying(const std::string& id, JobCommand command, const std::string& asker);
  bool IsOfThisBuild(Job& job);
  void GoOn(Job& job, const std::string& how);
  // Of a command that has changed the job: `asker` is answered once the next checkpoint is durable. Where
  // that cannot be made durable, the job is put back to what it was `before`.
  void AnswerWhenSaved(Job& job, const std::string& asker, const Standing& before);
  // Of a command that asks for what is so already: `asker` is answered once that is durable.
  void AnswerAsItStands(Job& job, const std::string& asker, bool known = false);
  void AnswerDurable(Job& job, std::uint64_t number);  // those who waited for that checkpoint
  void RefusePending(Job& job, const std::string& why);
  void RefuseSubmission(Job& job, const std::string& why);  // the job goes
  void Undo(Job& job, const Standing& before);
  void Tell(const std::string& asker, const std::string& job, const std::string& refusal, bool known = false);
  void TellUnable(const std::string& asker, const std::string& job, const std::string& refusal);

  // jobs.cc
  Job* FindById(const std::string& id);
  void BeginAgain(Job& job);
  void TakeUpPartials(Job& job, const proto::Checkpoint& saved);
  void HoldRestored(Job& job, const RestoreJob& event);
  void SetState(Job& job, proto::JobState state, const std::string& reason);
  void FailJob(Job& job, const std::string& reason, bool input_error);
  void ReleaseAll(Job& job);
  void Delete(Job& job);
  void Erase(Job& job);
  void DeleteTheOld();

  // saving.cc
  void Save(Job& job);
  void SaveWhatIsDue();
  void SaveIfDue(Job& job);
  void WantSave(Job& job, bool at_once);

  void Say(Report::Level level, std::string text) { actions_.push_back(Report{level, "", std::move(text)}); }
  void Say(Report::Level level, const Job& job, std::string text) {
    actions_.push_back(Report{level, job.id, std::move(text)});
  }
  void Settle();
  void LookAhead();  // what running jobs will take yet

  CoreOptions options_;
  double now_s_ = 0;
  struct {
    double room = 1000, counted_s = 0;
    std::uint64_t unsaid = 0;
  } moves_;                   // of workers that come and go: of how many more the log may say
  double served_from_s_ = 0;  // where now_s_ would have stood when the store was first served
  JobMap jobs_;
  std::map<std::string, std::uint64_t> orders_;  // by job id
  std::uint64_t next_order_ = 1;
  std::set<std::uint64_t> touched_;  // jobs that this event may have changed, by order
  bool all_touched_ = false;
  FairShare share_;
  Fleet fleet_;
  std::map<std::uint64_t, LostAttempt> lost_;  // of the last back_s, by Hello.process
  bool behind_ = false;                        // as the last Tick said
  double caught_up_s_ = 0;  // all that had come by then was read: who was slow or silent is judged by it
  std::optional<double> ticked_s_;  // when it was last seen not to stand still
  std::optional<double> looked_s_;  // when all workers were last looked at
  bool workers_due_ = false;        // they are, with this event
  BlobLedger ledger_;
  Tally tally_;
  std::vector<Action> actions_;
};

}  // namespace cairn::coordinator
