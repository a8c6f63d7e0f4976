#include "tests/simulation/shell_model.h"

#include <algorithm>

#include "tests/simulation/world.h"

namespace cairn::simulation {

using namespace coordinator;  // NOLINT: events and actions, all over this file

namespace {

Hash FromBinary(const std::string& binary) { return Hash::FromBinary(binary).value(); }

std::set<Hash> BlobsOf(const proto::Checkpoint& checkpoint) {
  std::set<Hash> blobs;
  for (const std::string& blob : checkpoint.blobs()) blobs.insert(FromBinary(blob));
  return blobs;
}

}  // namespace

void ShellModel::Start() {
  Restart();
  TickOn();
}

void ShellModel::TickOn() {
  Deliver(Tick{});
  world_.schedule.After(0.2, [this] { TickOn(); });
}

// A user tries again until the job is durable.
void ShellModel::Submit(const std::string& id, const proto::Job& job) {
  submitted_[id] = job;
  world_.checks.AddJob(id, job);
  if (core_ != nullptr && core_->FindJob(id) == nullptr) {
    SubmitJob event{id, job, {}};
    for (const auto& [name, hash] : job.input_blobs()) event.blobs.push_back(FromBinary(hash));
    Deliver(event);
  }
  if (!accepted_.contains(id)) world_.schedule.After(3, [this, id, job] { Submit(id, job); });
}

void ShellModel::Deliver(const Event& event) {
  if (core_ == nullptr || !world_.checks.violation().empty()) return;
  // Who comes first to an empty house decides for all, which no job here would survive.
  if (const auto* hello = std::get_if<WorkerHello>(&event))
    if (hello->hello.build().version() != "1" && core_->fleet().size() == 0) return;
  if (const auto* done = std::get_if<TaskDone>(&event))
    memory_.insert(done->blobs.begin(), done->blobs.end());
  if (const auto* submit = std::get_if<SubmitJob>(&event))
    memory_.insert(submit->blobs.begin(), submit->blobs.end());
  if (world_.tracing() && !std::holds_alternative<Tick>(event)) world_.Say("> " + Describe(event));
  const std::vector<Action> actions = core_->Handle(event, world_.schedule.now_s());
  for (const Action& action : actions) Apply(action);
  for (const auto& [id, job] : submitted_)
    if (const Job* now = core_->FindJob(id)) world_.checks.See(*now, incarnation_);
  CheckMemory();
}

void ShellModel::Apply(const Action& action) {
  if (world_.tracing()) world_.Say("< " + Describe(action));
  std::visit([this](const auto& a) { Do(a); }, action);
}

void ShellModel::Do(const coordinator::Send& send) {
  if (send.message.has_assign()) CheckAssign(send.message.assign());
  world_.ToWorker(send.peer, send.message);
}

void ShellModel::CheckAssign(const wire::Assign& assign) {
  const auto need = [&](const std::string& binary) {
    if (!memory_.contains(FromBinary(binary)))
      world_.checks.Fail("a task was handed out whose input is not there");
  };
  for (const proto::InputRef& input : assign.task().inputs()) need(input.blob());
  for (const auto& [name, hash] : assign.inputs()) need(hash);
  for (const auto& [name, hash] : assign.state().blobs()) need(hash);
  for (const std::string& partial : assign.partials()) need(partial);
}

bool ShellModel::Serves(const wire::TaskKey& key, const std::string& peer, const std::set<Hash>& blobs) {
  if (core_ == nullptr) return false;
  const bool all = std::includes(memory_.begin(), memory_.end(), blobs.begin(), blobs.end());
  if (all) return true;
  for (const auto& [number, worker] : core_->fleet().workers())
    if (worker.peer == peer && worker.Find(key) != nullptr)
      world_.checks.Fail("an input of a task under way was dropped");
  return false;
}

void ShellModel::Do(const Persist& persist) {
  world_.checks.SeePersist(persist, incarnation_, world_.schedule.now_s());
  for (const Hash& blob : BlobsOf(persist.checkpoint))
    if (!memory_.contains(blob)) world_.checks.Fail("a checkpoint names a blob that is not there");
  const std::uint64_t incarnation = incarnation_;
  const double takes_s = world_.rng.Uniform(0.0005, world_.faults.persist_s);
  world_.schedule.After(takes_s, [this, persist, incarnation] {
    if (incarnation != incarnation_ || core_ == nullptr) return;  // it died before this was durable
    if (world_.Chance(world_.faults.disk_full)) {
      ++world_.outcome.failed_saves;
      return Deliver(
          PersistFailed{persist.checkpoint.job_id(), persist.checkpoint.number(), "the disk is full"});
    }
    EndPersist(persist, true);
  });
}

void ShellModel::EndPersist(const Persist& persist, bool tell) {
  const proto::Checkpoint& checkpoint = persist.checkpoint;
  const std::set<Hash> blobs = BlobsOf(checkpoint);
  disk_.insert(blobs.begin(), blobs.end());
  for (const Publish& publish : persist.publish)
    world_.checks.SeeResult(checkpoint.job_id(), publish.stage, publish.result);
  Checkpoints& kept = checkpoints_[checkpoint.job_id()];
  kept[checkpoint.number()] = checkpoint;
  const std::size_t keep = checkpoint.state() == proto::JOB_DONE ? 1 : 2;
  while (kept.size() > keep) kept.erase(kept.begin());
  world_.checks.SeeDurable(checkpoint);
  accepted_.insert(checkpoint.job_id());
  if (tell) Deliver(PersistDone{checkpoint.job_id(), checkpoint.number()});
}

void ShellModel::Do(const DropBlobs& drop) {
  for (const Hash& hash : drop.hashes) {
    memory_.erase(hash);
    disk_.erase(hash);
  }
}

void ShellModel::Do(const Report& report) {
  if (report.level == Report::kAlarm) world_.checks.Fail("alarm: " + report.text);
}

void ShellModel::Crash(double down_s) {
  if (core_ == nullptr) return;
  world_.Say("the coordinator dies");
  ++world_.outcome.coordinator_crashes;
  core_.reset();
  memory_.clear();
  world_.schedule.After(down_s, [this] { Restart(); });
}

void ShellModel::Restart() {
  world_.Say("the coordinator starts");
  ++incarnation_;
  core_ = std::make_unique<Core>(world_.faults.core);
  std::map<std::uint64_t, std::string> by_order;
  for (const auto& [id, kept] : checkpoints_) by_order[kept.rbegin()->second.order()] = id;
  for (const auto& [order, id] : by_order) Restore(id, checkpoints_[id]);
}

void ShellModel::Restore(const std::string& id, Checkpoints& kept) {
  if (kept.size() == 2 && world_.Chance(world_.faults.checkpoint_damaged)) {
    world_.Say("the last checkpoint of " + id + " is damaged");
    ++world_.outcome.damaged;
    kept.erase(std::prev(kept.end()));
    world_.checks.SeeDamaged(kept.rbegin()->second);
  }
  RestoreJob restore{kept.rbegin()->second, {}};
  std::set<Hash> blobs = BlobsOf(restore.checkpoint);
  if (kept.size() == 2) {
    const std::set<Hash> previous = BlobsOf(kept.begin()->second);
    restore.previous_blobs.assign(previous.begin(), previous.end());
    blobs.insert(previous.begin(), previous.end());
  }
  if (!std::includes(disk_.begin(), disk_.end(), blobs.begin(), blobs.end()))
    world_.checks.Fail("a blob of a kept checkpoint of " + id + " is not on disk");
  if (restore.checkpoint.state() != proto::JOB_DONE) memory_.insert(blobs.begin(), blobs.end());
  Deliver(restore);
}

void ShellModel::CheckMemory() {
  if (memory_.size() != core_->held_blobs())
    world_.checks.Fail("memory holds " + std::to_string(memory_.size()) + " blobs, needed are " +
                       std::to_string(core_->held_blobs()));
  std::size_t bound = 0;
  for (const auto& [id, job] : submitted_) bound += world_.checks.MostBlobs(id);
  if (memory_.size() > bound)
    world_.checks.Fail(std::to_string(memory_.size()) + " blobs in memory, more than " +
                       std::to_string(bound));
}

void ShellModel::ResumeIfStopped(const std::string& id) {
  const Job* job = core_ == nullptr ? nullptr : core_->FindJob(id);
  if (job == nullptr || job->Running() || job->state == proto::JOB_DONE || job->input_error) return;
  if (job->reason.empty()) world_.checks.Fail(id + " waits without a reason");
  Deliver(ResumeJob{id});
}

bool ShellModel::AllEnded(const std::vector<std::string>& ids) const {
  return core_ != nullptr && std::all_of(ids.begin(), ids.end(), [this](const std::string& id) {
           const Job* job = core_->FindJob(id);
           return job != nullptr && (job->state == proto::JOB_DONE || job->input_error) &&
                  !core_->HasUnsaved();
         });
}

void ShellModel::CheckEnd(const std::vector<std::string>& ids) {
  bool any_bad = false;
  for (const std::string& id : ids) {
    world_.checks.SeeEnd(*core_->FindJob(id));
    any_bad |= core_->FindJob(id)->input_error;
  }
  if (!any_bad && !memory_.empty()) world_.checks.Fail("all jobs are done, but blobs are still held");
}

std::string ShellModel::Summary() const {
  if (core_ == nullptr) return "the coordinator is down";
  std::string text;
  for (const wire::JobInfo& info : core_->Jobs()) text += info.ShortDebugString() + "; ";
  return text + std::to_string(core_->fleet().size()) + " workers";
}

}  // namespace cairn::simulation
