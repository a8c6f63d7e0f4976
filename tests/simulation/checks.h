// What must hold in every world, at every step. The first thing that does not is kept.
//
//   checks.cc         a job's way: rounds one by one, what is durable stays, states change for a cause
//   answer_checks.cc  what a job takes for true, lies, and two answers that differ
//   table_checks.cc   the core's tables: nobody's tasks, no task forgotten, no worker idle, nothing that
//   grows
//   worker_checks.cc  workers that are to leave, are broken, or are lost and come back
//   user_checks.cc    what users are told
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/core/core.h"
#include "tests/simulation/toy.h"

namespace cairn::simulation {

class World;

// What a user asked of a job, and waits to be answered.
struct Asked {
  enum What { kSubmit, kPause, kResume, kCancel, kRetry, kDelete, kPrioritize };
  What what = kSubmit;
  std::string id;
  int priority = 0;  // of kPrioritize
};

class Checks {
 public:
  explicit Checks(World& world) : world_(world) {}
  void Fail(const std::string& what) {
    if (violation_.empty()) violation_ = what;
  }
  bool Deceived(const std::string& id) const { return jobs_.at(id).deceived; }
  const std::string& violation() const { return violation_; }

  void AddJob(const std::string& id, const proto::Job& job, ToyKind kind);
  // Around each event that the core handles. `process` counts the coordinator's.
  void Before(const coordinator::Core& core, const coordinator::Event& event);
  void After(const coordinator::Core& core, const coordinator::Event& event,
             const std::vector<coordinator::Action>& actions, std::uint64_t process, double now_s);
  // Who asks; he is told by SeeAnswer, if ever.
  std::string Ask(Asked::What what, const std::string& id, int priority = 0);
  // `saved`: what the store has of the job (null: nothing).
  void SeeAnswer(const coordinator::Core& core, const coordinator::Answer& answer,
                 const proto::Checkpoint* saved);
  // A coordinator has restored what it found.
  void SeeStarted(const coordinator::Core& core);
  // The store: a checkpoint is durable; the newest was damaged, what is left is this; none is left.
  void SeeDurable(const proto::Checkpoint& checkpoint);
  void SeeDamaged(const proto::Checkpoint& checkpoint);
  void SeeLost(const std::string& id);
  void SeeResult(const std::string& id, std::uint32_t stage, const Hash& result);
  void SeeMemory(std::size_t blobs);
  // All is over: how the job ended, and what the store says of it (null: nothing).
  void SeeEnd(const coordinator::Job& job, const proto::Checkpoint* saved, bool given_up);

 private:
  struct Lost {
    wire::TaskKey key;
    double since_s = 0;
  };
  using Place = std::pair<std::uint32_t, std::uint64_t>;  // stage; round + 1, or 0 before START is answered
  struct Known {
    ToyKind kind = ToyKind::kGood;
    bool leaving = false;
    std::uint32_t stages = 0;
    ToyTruth truth;
    // The last that is durable.
    Place durable{0, 0};
    std::uint64_t durable_number = 0;
    proto::JobState durable_state = proto::JOB_RUNNING;
    std::map<std::uint32_t, Hash> published;
    // How it stood after the last event.
    std::uint64_t process = 0;
    Place seen{0, 0};
    proto::JobState state = proto::JOB_RUNNING;
    // Work of its own and of others that were dispatched while its own was ready, in seconds by share.
    double largest_turn = 0, passed_over = 0;
    // Wrong answers that came for it, and whether each could be believed: it had the right form, and came
    // from one who had been given the task.
    std::map<Hash, bool> lies;
    bool deceived = false;     // it believed one: its truth is no longer known
    std::string asker;         // who asked last
    std::uint64_t number = 0;  // that its users were told; 0: nobody was told that it is there
    bool deletion_asked = false, gone = false;  // and that it is deleted was said
  };
  enum class Alarm { kNever, kMay, kMust };

  static Place PlaceOf(const proto::Checkpoint& checkpoint);
  void See(const coordinator::Job& job, const coordinator::Event& event, std::uint64_t process);
  void SeeRestored(const coordinator::Job& job, const proto::Checkpoint& saved, Known& known);
  void SeeState(const coordinator::Job& job, const coordinator::Event& event, Known& known);
  void SeeOrders(const coordinator::Core& core, const coordinator::Event& event);
  // answer_checks.cc
  void Weigh(const coordinator::Core& core, const coordinator::TaskDone& event);
  void NoteMalformed(const coordinator::Core& core, const coordinator::TaskDone& event);
  Hash TruthOf(const Known& known, const wire::TaskKey& key) const;
  // user_checks.cc
  void SeeDone(const Asked& asked, const std::string& asker, const coordinator::Core& core,
               const proto::Checkpoint* saved);
  void SeeRefused(const Asked& asked, const coordinator::Core& core, const proto::Checkpoint* saved);
  void SeeAlarms(const std::vector<coordinator::Action>& actions);
  void SeeTruth(const coordinator::Job& job, Known& known);
  bool Believed(const std::string& id, Known& known, const Hash& hash);
  // table_checks.cc
  void SeeTables(const coordinator::Core& core, bool ticked, double now_s);
  void SeeHeartbeat(const coordinator::Core& core, const coordinator::WorkerHeartbeat& event, double now_s);
  void SeeJobTables(const coordinator::Job& job);
  void SeeTurns(const coordinator::Core& core, const std::vector<coordinator::Action>& actions);
  void CountActions(const coordinator::Core& core, const std::vector<coordinator::Action>& actions);

  // worker_checks.cc
  std::uint64_t Retries(const coordinator::Core& core) const;  // attempts that failed, of all jobs
  void SeeExcluded(const coordinator::Core& core, const std::vector<coordinator::Action>& actions);
  void ForgetWorkers();  // the coordinator's process is another
  void NoteLost(const coordinator::Core& core, const coordinator::Event& event);
  const coordinator::TaskRecord* FindLost(const coordinator::Core& core, const Lost& lost) const;
  void SeeBack(const coordinator::Core& core, const coordinator::Event& event);
  void NoteRunning(const coordinator::Core& core, const coordinator::Event& event);
  void SeeSilent(const coordinator::Core& core);
  void SeeStandstill(const coordinator::Core& core, bool ticked, double now_s);
  void SeeDraining(const coordinator::Core& core, const coordinator::Event& event,
                   const std::vector<coordinator::Action>& actions);

  World& world_;
  std::map<std::string, Known> jobs_;
  std::map<std::string, Asked> asked_;  // by asker; not yet answered
  std::uint64_t questions_ = 0;
  std::string violation_;
  // Of the event under way.
  Alarm alarm_ = Alarm::kNever;
  std::set<std::string> ready_before_;  // jobs that run and have a task to dispatch
  std::uint64_t retries_before_ = 0;
  std::pair<std::string, std::uint64_t> broken_;  // a worker that gives this job a malformed answer
  std::uint64_t events_ = 0;
  std::optional<int> blamed_before_;  // failures of the task that who says Hello had lost
  struct Running {
    std::string peer;
    wire::TaskKey key;
    int failures = 0, excuses = 0;  // of its task
  };
  std::vector<Running> running_before_;  // what each worker runs; of a tick
  // Of the coordinator's process under way.
  std::uint64_t process_ = 0;
  std::set<std::string> draining_;       // workers that it knows to be about to leave
  std::map<std::uint64_t, Lost> lost_;   // by Hello.process
  double now_s_ = 0, ticked_s_ = 0;      // of the last event; of what was no standstill
  std::set<std::string> there_, heard_;  // workers; those just heard of
  std::set<std::string> spared_;         // that must not be lost until then
  double spared_until_s_ = 0;
  std::map<std::string, std::set<std::uint64_t>> malformed_;  // workers that gave malformed answers, by job
};

// One line, for the trace.
std::string Describe(const coordinator::Event& event);
std::string Describe(const coordinator::Action& action);

}  // namespace cairn::simulation
