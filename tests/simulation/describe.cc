// The trace's lines.
#include "tests/simulation/checks.h"

namespace cairn::simulation {
namespace {

using namespace coordinator;  // NOLINT: events and actions, all over this file

std::string Text(const wire::TaskKey& key) {
  return wire::TaskKey::Kind_Name(key.kind()) + " " + key.job() + " stage " + std::to_string(key.stage()) +
         " round " + std::to_string(key.round()) + " task " + std::to_string(key.task()) + " attempt " +
         std::to_string(key.attempt());
}

struct Words {
  std::string operator()(const WorkerHello& e) const { return e.peer + " Hello"; }
  std::string operator()(const WorkerHeartbeat& e) const {
    std::string text = e.peer + " Heartbeat";
    for (int i = 0; i < e.heartbeat.tasks_size(); ++i)
      text += " [" + Text(e.heartbeat.tasks(i)) + ": " +
              (i < e.heartbeat.ticks_size() ? std::to_string(e.heartbeat.ticks(i)) : "no") + " ticks]";
    return text;
  }
  std::string operator()(const WorkerLeave& e) const { return e.peer + " Leave"; }
  std::string operator()(const WorkerLost& e) const { return e.peer + (e.ended ? " is dead" : " is gone"); }
  std::string operator()(const DrainWorker& e) const { return e.peer + " is to leave"; }
  std::string operator()(const TaskDone& e) const { return e.peer + " Done " + Text(e.done.key()); }
  std::string operator()(const TaskFailed& e) const {
    return e.peer + " Failed " + Text(e.failed.key()) + ": " + e.failed.message();
  }
  std::string operator()(const SubmitJob& e) const { return "submit " + e.id; }
  std::string operator()(const PauseJob& e) const { return "pause " + e.id; }
  std::string operator()(const ResumeJob& e) const { return "resume " + e.id; }
  std::string operator()(const CancelJob& e) const { return "cancel " + e.id; }
  std::string operator()(const RetryJob& e) const { return "retry " + e.id; }
  std::string operator()(const DeleteJob& e) const { return "delete " + e.id; }
  std::string operator()(const PrioritizeJob& e) const {
    return "priority of " + e.id + ": " + std::to_string(e.priority);
  }
  std::string operator()(const Served& e) const { return "served for " + std::to_string(e.seconds) + " s"; }
  std::string operator()(const RestoreJob& e) const { return "restore " + e.checkpoint.job_id(); }
  std::string operator()(const PersistDone& e) const {
    return e.job + " checkpoint " + std::to_string(e.number) + " durable";
  }
  std::string operator()(const PersistFailed& e) const {
    return e.job + " checkpoint " + std::to_string(e.number) + " failed: " + e.reason;
  }
  std::string operator()(const ForgetDone& e) const { return e.job + " is forgotten"; }
  std::string operator()(const ForgetFailed& e) const { return e.job + " is not forgotten: " + e.reason; }
  std::string operator()(const SaveNow&) const { return "save now"; }
  std::string operator()(const Tick&) const { return "tick"; }

  std::string operator()(const Send& a) const {
    const wire::Envelope& m = a.message;
    if (m.has_assign()) return a.peer + " Assign " + Text(m.assign().key());
    if (m.has_cancel()) return a.peer + " Cancel " + Text(m.cancel().key());
    if (m.has_refuse()) return a.peer + " Refuse: " + m.refuse().reason();
    if (m.has_drain()) return a.peer + " Drain";
    return a.peer + (m.has_welcome() ? " Welcome" : m.has_unknown_worker() ? " UnknownWorker" : " ?");
  }
  std::string operator()(const Persist& a) const {
    return "persist " + a.checkpoint.job_id() + " number " + std::to_string(a.checkpoint.number()) +
           " stage " + std::to_string(a.checkpoint.stage()) + " round " +
           std::to_string(a.checkpoint.round()) + ", " + std::to_string(a.publish.size()) + " results";
  }
  std::string operator()(const DropBlobs& a) const {
    return "drop " + std::to_string(a.hashes.size()) + " blobs";
  }
  std::string operator()(const ForgetJob& a) const { return "forget " + a.job; }
  std::string operator()(const coordinator::Answer& a) const {
    return "answer " + a.asker + " about " + a.job + ": " + (a.refusal.empty() ? "ok" : a.refusal);
  }
  std::string operator()(const JobChanged& a) const { return a.job + " changed"; }
  std::string operator()(const Report& a) const {
    return "report: " + (a.job.empty() ? "" : a.job + ": ") + a.text;
  }
  std::string operator()(const Refused& a) const { return "refused " + a.peer + ": " + a.refusal.reason; }
};

}  // namespace

std::string Describe(const Event& event) { return std::visit(Words{}, event); }
std::string Describe(const Action& action) { return std::visit(Words{}, action); }

}  // namespace cairn::simulation
