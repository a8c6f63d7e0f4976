#include "tests/simulation/shell_model.h"

#include <algorithm>

#include "tests/simulation/world.h"

namespace cairn::simulation {

using namespace coordinator;  // NOLINT: events and actions, all over this file

namespace {

Hash FromBinary(const std::string& binary) { return Hash::FromBinary(binary).value(); }

std::string GivenText(const std::string& peer, const wire::TaskKey& key) {
  return peer + " " + key.SerializeAsString();
}

}  // namespace

std::set<Hash> InputsOf(const wire::Assign& assign) {
  std::set<Hash> inputs;
  for (const proto::InputRef& input : assign.task().inputs()) inputs.insert(FromBinary(input.blob()));
  for (const auto& [name, hash] : assign.inputs()) inputs.insert(FromBinary(hash));
  for (const auto& [name, hash] : assign.state().blobs()) inputs.insert(FromBinary(hash));
  for (const std::string& partial : assign.partials()) inputs.insert(FromBinary(partial));
  return inputs;
}

void ShellModel::Start() {
  Restart();
  TickOn();
}

void ShellModel::TickOn() {
  if (core_ != nullptr && world_.schedule.now_s() >= stopped_until_s_) Handle(Tick{});
  if (core_ != nullptr && world_.schedule.now_s() >= stopped_until_s_) Carry(uploads_->Tick(Now()));
  world_.schedule.After(0.2, [this] { TickOn(); });
}

// Never runs backwards, as the real one's steady clock; where the machine's jumps back, it stands still.
double ShellModel::Now() {
  clock_s_ = std::max(clock_s_, world_.schedule.now_s() + clock_offset_s_);
  return clock_s_;
}

// In the order in which it came, also behind what waits for a process that is stopped.
void ShellModel::WhenAwake(std::function<void()> what) {
  if (core_ == nullptr) return;
  if (waiting_.empty() && world_.schedule.now_s() >= stopped_until_s_) return what();
  waiting_.push_back(std::move(what));
  if (waiting_.size() == 1) Wake();
}

void ShellModel::Wake() {
  const double wait_s = std::max(0.0, stopped_until_s_ - world_.schedule.now_s());
  world_.schedule.After(wait_s, [this, process = process_] {
    while (process == process_ && !waiting_.empty()) {
      if (world_.schedule.now_s() < stopped_until_s_) return Wake();
      const std::function<void()> what = waiting_.front();
      what();
      if (process == process_) waiting_.pop_front();
    }
  });
}

void ShellModel::Deliver(const Event& event, bool whole) {
  WhenAwake([this, event, whole] { Receive(event, whole); });
}

void ShellModel::Receive(const Event& event, bool whole) {
  if (!whole) return world_.Say("a message whose blob is not what its hash says is refused");
  // A job's number is never used again: a submission that was late would be another job.
  if (const auto* submit = std::get_if<SubmitJob>(&event);
      submit != nullptr && world_.users.Deleted(submit->id)) {
    return;
  } else if (submit != nullptr && core_->FindJob(submit->id) == nullptr) {
    SubmitJob numbered = *submit;
    numbered.job.set_name(std::to_string(++last_number_));
    return Handle(numbered);
  }
  Handle(event);
}

void ShellModel::Offer(const std::string& peer, const Hash& hash, std::uint64_t bytes) {
  WhenAwake([this, peer, hash, bytes] { Carry(uploads_->Offered(peer, "", hash, bytes, Now())); });
}

void ShellModel::Bring(const std::string& peer, wire::Piece piece) {
  WhenAwake([this, peer, piece = std::move(piece)]() mutable {
    Carry(uploads_->Came(peer, std::move(piece), Now()));
  });
}

// What is missing its client brings when its user submits again.
void ShellModel::Submit(const std::string& peer, const SubmitJob& event) {
  WhenAwake([this, peer, event] {
    if (world_.users.Deleted(event.id)) return;
    for (const auto& [name, hash] : event.job.input_blobs())
      if (!memory_.contains(FromBinary(hash))) return;
    SubmitJob taken = event;
    taken.blobs = uploads_->Take(peer);
    Receive(taken, true);
  });
}

void ShellModel::Handle(const Event& event) {
  if (!world_.checks.violation().empty()) return;
  if (world_.tracing() && !std::holds_alternative<Tick>(event)) world_.Say("> " + Describe(event));
  TakeIn(event);
  world_.checks.Before(*core_, event);
  const std::vector<Action> actions = core_->Handle(event, Now());
  world_.checks.After(*core_, event, actions, process_, clock_s_);
  for (const Action& action : actions) {
    if (world_.Chance(world_.faults.crash_at_action)) {
      world_.Count(kCoordinatorKilledAtAction);
      return Crash(world_.Chance(world_.faults.power_cut), world_.rng.Uniform(0.1, 8));
    }
    Apply(action);
  }
  CheckMemory();
}

void ShellModel::TakeIn(const Event& event) {
  if (const auto* done = std::get_if<TaskDone>(&event)) Keep(done->blobs);
  if (const auto* submit = std::get_if<SubmitJob>(&event)) Keep(submit->blobs);
}

void ShellModel::Keep(const std::vector<Hash>& blobs) {
  for (const Hash& blob : blobs) memory_.try_emplace(blob, Kept{false, store_.next_ticket()});
}

void ShellModel::Apply(const Action& action) {
  if (world_.tracing()) world_.Say("< " + Describe(action));
  std::visit([this](const auto& a) { Do(a); }, action);
}

void ShellModel::Do(const coordinator::Send& send) {
  if (send.message.has_assign()) {
    const wire::Assign& assign = send.message.assign();
    CheckAssign(InputsOf(assign));
    given_[GivenText(send.peer, assign.key())] = InputsOf(assign);
  }
  world_.network.ToWorker(send.peer, send.message);
}

bool ShellModel::WasGiven(const std::string& peer, const wire::TaskKey& key) const {
  return given_.contains(GivenText(peer, key));
}

void ShellModel::CheckAssign(const std::set<Hash>& inputs) {
  for (const Hash& input : inputs)
    if (!memory_.contains(input)) world_.checks.Fail("a task was dispatched whose input is not there");
}

// server_requests.cc
void ShellModel::Serve(const std::string& peer, const wire::Fetch& fetch) {
  WhenAwake([this, peer, fetch] {
    wire::Envelope answer;
    const Hash hash = FromBinary(fetch.hash());
    if (core_->MayRead(peer, hash) && memory_.contains(hash)) {
      answer.mutable_blob()->set_of(fetch.hash());
      if (fetch.has_part()) *answer.mutable_blob()->mutable_part() = fetch.part();
    } else {
      CheckMissing(peer, hash);
      answer.mutable_missing()->set_hash(fetch.hash());
      if (fetch.has_part()) *answer.mutable_missing()->mutable_part() = fetch.part();
    }
    world_.network.ToWorker(peer, answer);
  });
}

void ShellModel::CheckMissing(const std::string& peer, const Hash& hash) {
  const Worker* worker = core_->fleet().Find(peer);
  if (worker == nullptr) return;
  for (const auto& assigned : worker->assigned)
    if (const auto given = given_.find(GivenText(peer, assigned.key));
        given != given_.end() && given->second.contains(hash))
      world_.checks.Fail("a worker is not served what its task reads");
}

bool ShellModel::Serves(const wire::Assign& assign, const std::string& peer) {
  if (core_ == nullptr) return false;
  const std::set<Hash> inputs = InputsOf(assign);
  if (std::all_of(inputs.begin(), inputs.end(), [this](const Hash& blob) { return memory_.contains(blob); }))
    return true;
  // A worker that was deaf for a while may still be at an attempt of the same name from before the job was
  // retried, whose inputs a liar made.
  const auto given = given_.find(GivenText(peer, assign.key()));
  if (given == given_.end() || given->second != inputs) return false;
  for (const auto& [number, worker] : core_->fleet().workers())
    if (worker.peer == peer && worker.Find(assign.key()) != nullptr)
      world_.checks.Fail("an input of a task under way was dropped");
  return false;
}

void ShellModel::Do(const Persist& persist) {
  WriteWork work;
  work.persist = persist;
  for (const std::string& binary : persist.checkpoint.blobs()) {
    const auto it = memory_.find(FromBinary(binary));
    if (it == memory_.end()) return world_.checks.Fail("a checkpoint names a blob that is not there");
    if (!it->second.durable) work.blobs.push_back(it->first);
  }
  for (const Publish& publish : persist.publish)
    if (!memory_.contains(publish.result)) world_.checks.Fail("a result is published that is not there");
  store_.Add(std::move(work));
}

void ShellModel::Take(const WriteDone& done) {
  for (const Hash& blob : done.written) {
    const auto it = memory_.find(blob);
    if (it != memory_.end() && done.ticket >= it->second.ticket) it->second.durable = true;
  }
  if (done.upload > 0) {
    const Status status = done.problem.empty() ? Status::Ok() : Status(Code::kIo, done.problem);
    if (!done.closed) return Carry(uploads_->Wrote(done.upload, done.upload_bytes, status, Now()));
    if (status.ok()) memory_[done.blob] = {true, done.ticket};
    Carry(uploads_->Closed(done.upload, status, Now()));
    if (!status.ok()) RemoveUnknown(done.blob);
  } else if (done.forgotten && done.problem.empty())
    Handle(ForgetDone{done.job});
  else if (done.forgotten)
    Handle(ForgetFailed{done.job, done.problem});
  else if (done.problem.empty())
    Handle(PersistDone{done.job, done.number});
  else
    Handle(PersistFailed{done.job, done.number, done.problem});
}

void ShellModel::Do(const DropBlobs& drop) {
  WriteWork work;
  const std::set<Hash> writing = uploads_->Writing();
  for (const Hash& hash : drop.hashes)
    if (!uploads_->Keeps(hash) && memory_.erase(hash) > 0 && !writing.contains(hash))
      work.remove.push_back(hash);
  store_.Add(std::move(work));
}

void ShellModel::Do(const ForgetJob& forget) {
  WriteWork work;
  work.forget = forget.job;
  store_.Add(std::move(work));
}

void ShellModel::Do(const coordinator::Answer& answer) {
  world_.checks.SeeAnswer(*core_, answer, store_.Newest(answer.job));
}

// server_uploads.cc
void ShellModel::Carry(Uploads::Actions actions) {
  const std::uint64_t process = process_;
  for (const UploadAction& action : actions) {
    if (process != process_) return;
    std::visit([this](const auto& a) { Do(a); }, action);
  }
  if (uploads_->held_bytes() > kUploads.total_bytes || store_.QueuedBytes() > kUploads.total_bytes)
    world_.checks.Fail("more of uploads is in memory than may be");
  for (const std::string& peer : std::exchange(gone_, {})) Carry(uploads_->Lost(peer, Now()));
  CheckMemory();
}

void ShellModel::Write(const UploadAction& action) {
  WriteWork work;
  work.upload = action;
  store_.Add(std::move(work));
}

void ShellModel::Do(const OpenUpload& open) { Write(open); }
void ShellModel::Do(const WritePiece& piece) { Write(piece); }

void ShellModel::Do(const CloseUpload& close) {
  Write(close);
  if (!close.whole) RemoveUnknown(close.hash);
}

void ShellModel::Do(const TellCredit& tell) {
  if (!world_.uploaders.IsThere(tell.peer)) gone_.insert(tell.peer);
  world_.schedule.After(0.01, [this, tell] { world_.uploaders.Hear(tell.peer, tell.credit); });
}

void ShellModel::Do(const AnswerOffer& answer) {
  if (answer.refusal.empty() && !memory_.contains(answer.hash))
    world_.checks.Fail("an upload is acknowledged that is not there");
  world_.schedule.After(0.01, [this, answer] { world_.uploaders.Hear(answer); });
}

void ShellModel::Do(const ReleaseBlob& release) {
  if (core_->Holds(release.hash) || uploads_->Keeps(release.hash)) return;
  memory_.erase(release.hash);
  RemoveUnknown(release.hash);
}

void ShellModel::Do(const DropUploader& drop) {
  if (world_.uploaders.IsThere(drop.peer)) world_.Count(kUploaderDropped);
  world_.uploaders.Drop(drop.peer);
}

void ShellModel::RemoveUnknown(const Hash& hash) {
  if (memory_.contains(hash) || uploads_->Writing().contains(hash)) return;
  WriteWork work;
  work.remove = {hash};
  store_.Add(std::move(work));
}

void ShellModel::Crash(bool power_cut, double down_s) {
  if (core_ == nullptr) return;
  world_.Say(power_cut ? "the coordinator's machine dies" : "the coordinator dies");
  world_.Count(power_cut ? kPowerCut : kCoordinatorKilled);
  core_.reset();
  uploads_.reset();
  waiting_.clear();
  world_.uploaders.DropAll();
  memory_.clear();
  given_.clear();
  ++process_;
  store_.EndProcess(power_cut);
  world_.schedule.After(down_s, [this] { Restart(); });
}

void ShellModel::Restart() {
  world_.Say("the coordinator starts");
  const std::uint64_t process = ++process_;
  core_ = std::make_unique<Core>(world_.faults.core);
  uploads_ = std::make_unique<Uploads>(
      kUploads, [this](const std::string&, const Hash& hash) { return memory_.contains(hash); });
  stopped_until_s_ = clock_s_ = 0;
  clock_offset_s_ = world_.rng.Uniform(0, 1e5);  // a clock of its own
  store_.BeginProcess([this, process](const WriteDone& done) {
    // The loop looks at what the disk has done when it comes round.
    const double wait_s = std::max(0.001, stopped_until_s_ - world_.schedule.now_s());
    world_.schedule.After(wait_s, [this, process, done] {
      if (process == process_) Take(done);
    });
  });
  const std::vector<RestoreJob> restored = store_.Recover();
  last_number_ = store_.LastNumber();
  for (const RestoreJob& restore : restored) {
    const auto found = [this](const Hash& blob) {
      if (store_.Has(blob)) memory_[blob] = {true, 0};
    };
    for (const std::string& blob : restore.checkpoint.blobs()) found(FromBinary(blob));
    for (const Hash& blob : restore.previous_blobs) found(blob);
    Handle(restore);
    if (process != process_) return;  // it died over that
  }
  world_.checks.SeeStarted(*core_);
  // What a start counts on must be durable by then.
  const Faults& faults = world_.faults;
  if (faults.power_cut_at_start > 0 && world_.schedule.now_s() < faults.trouble_s &&
      world_.Chance(faults.power_cut_at_start))
    world_.schedule.After(world_.rng.Uniform(), [this, process] {
      if (process != process_) return;
      world_.Count(kPowerCutAtStart);
      Crash(true, world_.rng.Uniform(0.1, 2));
    });
}

// What the core counts is what is there.
void ShellModel::CheckMemory() {
  if (core_ == nullptr) return;
  const auto for_clients = std::ranges::count_if(
      memory_, [this](const auto& kept) { return !core_->Holds(kept.first) && uploads_->Keeps(kept.first); });
  const std::size_t needed = core_->held_blobs() + static_cast<std::size_t>(for_clients);
  if (memory_.size() != needed)
    world_.checks.Fail("memory holds " + std::to_string(memory_.size()) + " blobs, needed are " +
                       std::to_string(needed));
  world_.checks.SeeMemory(memory_.size());
}

}  // namespace cairn::simulation
